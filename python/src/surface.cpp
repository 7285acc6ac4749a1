#include <raymap/names.h>
#include <raymap/surface.h>

#include <optional>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

std::shared_ptr<Surface> make(const MeshHandle& mesh, SurfaceOptions options, std::string_view orientation,
                              const MachineOptions& machine, nb::object progress) {
  Call call(std::move(progress));
  options.orientation = fromName<Orientation>(orientation);
  std::shared_ptr<Surface> made;
  call.run([&] { made = std::make_shared<Surface>(mesh.view, options, call.on(machine)); });
  return made;
}

std::shared_ptr<FieldHandle> generate(const Surface& self, const Grid& grid, const FieldOptions& options,
                                      const MachineOptions& machine, nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<FieldHandle>();
  call.run([&] {
    Generated made = self.generate(grid, options, call.on(machine));
    result->field = std::move(made.field);
    result->stats = std::move(made.stats);
  });
  return result;
}

std::shared_ptr<SparseHandle> generateSparse(const Surface& self, const Grid& grid,
                                             const BandOptions& options, const MachineOptions& machine,
                                             nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<SparseHandle>();
  call.run([&] { result->field = self.generateBand(grid, options, call.on(machine)); });
  return result;
}

std::shared_ptr<FieldHandle> generateRegion(const Surface& self, const Triple& origin, double spacing,
                                            const std::tuple<int, int, int>& dims,
                                            const std::tuple<int, int, int>& low,
                                            const std::tuple<int, int, int>& size,
                                            const RegionOptions& options, const MachineOptions& machine,
                                            nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<FieldHandle>();
  const Grid lattice{toWhole(dims), toVector(origin), spacing};
  const Region region{toWhole(low), toWhole(size)};
  call.run([&] { result->field = self.generateRegion(lattice, region, options, call.on(machine)); });
  return result;
}

std::optional<double> farDistance(const Surface& self, const Triple& origin, double spacing,
                                  const std::tuple<int, int, int>& dims, const std::tuple<int, int, int>& low,
                                  const std::tuple<int, int, int>& size, const RegionOptions& options) {
  const nb::gil_scoped_release released;
  return self.farDistance({toWhole(dims), toVector(origin), spacing}, {toWhole(low), toWhole(size)}, options);
}

/// Returns the arrays that the options ask for, by name.
nb::dict toDict(QueryResult result, const QueryOptions& options, size_t count) {
  nb::dict dict;
  if (options.distance) dict["distance"] = toArray<double>(std::move(result.distance), {count});
  if (options.closest) dict["closest"] = toArray<double>(std::move(result.closest), {count, 3});
  if (options.triangle) dict["triangle"] = toArray<uint32_t>(std::move(result.triangle), {count});
  if (options.barycentric) dict["barycentric"] = toArray<double>(std::move(result.barycentric), {count, 3});
  if (options.direction) dict["direction"] = toArray<double>(std::move(result.direction), {count, 3});
  if (options.winding) dict["winding"] = toArray<float>(std::move(result.winding), {count});
  if (options.confidence) dict["confidence"] = toArray<float>(std::move(result.confidence), {count});
  return dict;
}

template <class Real>
using PointArray = nb::ndarray<const Real, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

template <class Real>
nb::dict query(const Surface& self, const PointArray<Real>& points, const QueryOptions& options,
               const MachineOptions& machine, nb::object progress) {
  Call call(std::move(progress));
  QueryResult result;
  const PointsView view(points.data(), points.shape(0));
  call.run([&] { self.query(view, options, result, call.on(machine)); }, view.count);
  return toDict(std::move(result), options, points.shape(0));
}

nb::ndarray<nb::numpy, const float> surfaceVertices(nb::handle_t<Surface> self) {
  const MeshView mesh = nb::cast<const Surface&>(self).mesh();
  const size_t shape[] = {mesh.vertexCount, 3};
  return {static_cast<const float*>(mesh.vertices), 2, shape, self};
}

nb::ndarray<nb::numpy, const uint32_t> surfaceFaces(nb::handle_t<Surface> self) {
  const MeshView mesh = nb::cast<const Surface&>(self).mesh();
  const size_t shape[] = {mesh.triangleCount, 3};
  return {static_cast<const uint32_t*>(mesh.triangles), 2, shape, self};
}

void bindOptions(nb::module_& module) {
  nb::class_<SurfaceOptions>(module, "SurfaceOptions")
      .def(nb::init<>())
      .def_prop_rw(
          "sign", [](const SurfaceOptions& self) { return self.sign != SignMode::None; },
          [](SurfaceOptions& self, bool sign) { self.sign = sign ? SignMode::Harmonic : SignMode::None; })
      .def_rw("threshold", &SurfaceOptions::threshold)
      .def_rw("compact", &SurfaceOptions::compact);
  module.def("is_compact_better", &isCompactBetter, "grid"_a, "triangles"_a);
  nb::class_<QueryOptions>(module, "QueryOptions")
      .def(nb::init<>())
      .def_rw("distance", &QueryOptions::distance)
      .def_rw("closest", &QueryOptions::closest)
      .def_rw("triangle", &QueryOptions::triangle)
      .def_rw("barycentric", &QueryOptions::barycentric)
      .def_rw("direction", &QueryOptions::direction)
      .def_rw("winding", &QueryOptions::winding)
      .def_rw("confidence", &QueryOptions::confidence)
      .def_rw("max_distance", &QueryOptions::maxDistance);
  nb::class_<RegionOptions>(module, "RegionOptions")
      .def(nb::init<>())
      .def_rw("band", &RegionOptions::band)
      .def_rw("triangle", &RegionOptions::triangle)
      .def_rw("winding", &RegionOptions::winding)
      .def_rw("confidence", &RegionOptions::confidence);
}

}  // namespace

void bindSurface(nb::module_& module) {
  bindOptions(module);
  nb::class_<Surface>(module, "Surface")
      .def(nb::new_(&make), "mesh"_a, "options"_a, "orientation"_a, "machine"_a, "progress"_a.none())
      .def(
          "fit_grid",
          [](const Surface& self, int resolution, double voxelSize,
             const std::optional<std::tuple<int, int, int>>& dims, const std::optional<Bounds>& bounds,
             double padding, double thickness, bool align) {
            return fit(self.mesh(), resolution, voxelSize, dims, bounds, padding, thickness, align);
          },
          "resolution"_a, "voxel_size"_a, "dims"_a.none(), "bounds"_a.none(), "padding"_a, "thickness"_a,
          "align"_a)
      .def("generate", &generate, "grid"_a, "options"_a, "machine"_a, "progress"_a.none())
      .def("generate_sparse", &generateSparse, "grid"_a, "options"_a, "machine"_a, "progress"_a.none())
      .def("generate_region", &generateRegion, "origin"_a, "spacing"_a, "dims"_a, "low"_a, "size"_a,
           "options"_a, "machine"_a, "progress"_a.none())
      .def("far_distance", &farDistance, "origin"_a, "spacing"_a, "dims"_a, "low"_a, "size"_a, "options"_a)
      .def("query", &query<float>, "points"_a.noconvert(), "options"_a, "machine"_a, "progress"_a.none())
      .def("query", &query<double>, "points"_a.noconvert(), "options"_a, "machine"_a, "progress"_a.none())
      .def("stats", [](const Surface& self) { return toPython(self.stats()); })
      .def("vertices", &surfaceVertices)
      .def("faces", &surfaceFaces)
      .def_prop_ro("bytes", &Surface::bytes)
      .def_prop_ro("origin", [](const Surface& self) { return toTriple(self.mesh().origin); });
}

}  // namespace raymap::python
