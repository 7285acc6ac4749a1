#include <raymap/io.h>
#include <raymap/sample_points.h>

#include <algorithm>
#include <filesystem>

#include "call.h"

namespace raymap::python {

namespace {

using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Vectors = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/// Returns points, distances, gradients, the centre and the scale.
nb::tuple choosePoints(const Surface& surface, const SamplePointsOptions& options,
                       const MachineOptions& machine, nb::object progress) {
  Call call(std::move(progress));
  PointSamples samples;
  call.run([&] { samples = samplePoints(surface, options, call.on(machine)); });
  const size_t count = samples.points.size();
  return nb::make_tuple(toArray<double>(std::move(samples.points), {count, 3}),
                        toArray<double>(std::move(samples.distance), {count}),
                        toArray<double>(std::move(samples.gradient), {count, 3}), toTriple(samples.centre),
                        samples.scale);
}

template <class T, class Array>
Buffer<T> copied(const Array& array) {
  Buffer<T> copy(array.shape(0));
  std::copy_n(array.data(), array.size(), reinterpret_cast<double*>(copy.data()));
  return copy;
}

nb::object rows(const Vectors& points, const Numbers& distance, bool areInside) {
  const auto toRows = [](auto found) {
    using Number = std::remove_reference_t<decltype(found[0].x)>;
    const size_t count = found.size();
    return nb::cast(toArray<Number>(std::move(found), {count, 4}));
  };
  const PointSamples samples{.points = copied<glm::dvec3>(points), .distance = copied<double>(distance)};
  return std::visit(toRows, sampleRows(samples, areInside));
}

void save(const std::filesystem::path& path, const Vectors& points, const Numbers& distance,
          const Vectors& gradient, const Triple& centre, double scale, std::string_view format) {
  const PointSamples samples{.points = copied<glm::dvec3>(points),
                             .distance = copied<double>(distance),
                             .gradient = copied<glm::dvec3>(gradient),
                             .centre = toVector(centre),
                             .scale = scale};
  const nb::gil_scoped_release release;
  writePointSamples(path, samples, format);
}

}  // namespace

void bindSamplePoints(nb::module_& module) {
  nb::class_<SamplePointsOptions>(module, "SamplePointsOptions")
      .def(nb::init<>())
      .def_rw("count", &SamplePointsOptions::count)
      .def_rw("surface", &SamplePointsOptions::surfaceShare)
      .def_rw("near", &SamplePointsOptions::nearShare)
      .def_rw("sigmas", &SamplePointsOptions::sigmas)
      .def_rw("seed", &SamplePointsOptions::seed)
      .def_rw("normalize", &SamplePointsOptions::normalize)
      .def_rw("unit", &SamplePointsOptions::unit)
      .def_rw("in_cube", &SamplePointsOptions::inCube)
      .def_rw("reach", &SamplePointsOptions::reach);
  module.def("sample_point_counts", &samplePointCounts, "options"_a);
  module.def("sample_points", &choosePoints, "surface"_a, "options"_a, "machine"_a, "progress"_a.none());
  module.def("sample_rows", &rows, "points"_a, "distance"_a, "inside"_a);
  module.def("save_samples", &save, "path"_a, "points"_a, "distance"_a, "gradient"_a, "centre"_a, "scale"_a,
             "format"_a = "");
}

}  // namespace raymap::python
