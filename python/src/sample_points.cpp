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
nb::tuple choosePoints(const Surface& surface, const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  PointSamples samples;
  call.run([&] { samples = samplePoints(surface, options.samples, call.on(options.machine)); });
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
  module.def(
      "sample_point_counts", [](const AllOptions& options) { return samplePointCounts(options.samples); },
      "options"_a);
  module.def("sample_points", &choosePoints, "surface"_a, "options"_a, "progress"_a.none());
  module.def("sample_rows", &rows, "points"_a, "distance"_a, "inside"_a);
  module.def("save_samples", &save, "path"_a, "points"_a, "distance"_a, "gradient"_a, "centre"_a, "scale"_a,
             "format"_a = "");
}

}  // namespace raymap::python
