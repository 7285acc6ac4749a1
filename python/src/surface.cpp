#include <raymap/surface.h>

#include <optional>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

std::shared_ptr<Surface> make(const MeshHandle& mesh, const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  std::shared_ptr<Surface> made;
  call.run([&] { made = std::make_shared<Surface>(mesh.view, options.surface, call.on(options.machine)); });
  return made;
}

std::shared_ptr<FieldHandle> generate(const Surface& self, const Grid& grid, const AllOptions& options,
                                      nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<FieldHandle>();
  call.run([&] {
    Generated made = self.generate(grid, options.field, call.on(options.machine));
    result->field = std::move(made.field);
    result->stats = std::move(made.stats);
  });
  return result;
}

std::shared_ptr<FieldHandle> generateSparse(const Surface& self, const Grid& grid, const AllOptions& options,
                                            nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<FieldHandle>();
  call.run([&] { result->field = self.generateBand(grid, options.band, call.on(options.machine)); });
  result->stats = self.stats();
  return result;
}

std::shared_ptr<FieldHandle> generateRegion(const Surface& self, const Triple& origin, double spacing,
                                            const std::tuple<int, int, int>& dims,
                                            const std::tuple<int, int, int>& low,
                                            const std::tuple<int, int, int>& size, const AllOptions& options,
                                            nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<FieldHandle>();
  const Grid lattice{toWhole(dims), toVector(origin), spacing};
  const Region region{toWhole(low), toWhole(size)};
  call.run([&] {
    result->field = self.generateRegion(lattice, region, options.region, call.on(options.machine));
  });
  return result;
}

std::optional<double> farDistance(const Surface& self, const Triple& origin, double spacing,
                                  const std::tuple<int, int, int>& dims, const std::tuple<int, int, int>& low,
                                  const std::tuple<int, int, int>& size, const AllOptions& options) {
  const nb::gil_scoped_release released;
  return self.farDistance({toWhole(dims), toVector(origin), spacing}, {toWhole(low), toWhole(size)},
                          options.region);
}

nb::dict distanceTo(const Surface& self, const Surface& other, const PoseArray& pose,
                    const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  std::vector<SurfacePair> found(1);
  const PairOptions how{toPoses(pose).at(0), options.query.maxDistance};
  call.run([&] { found[0] = self.distanceTo(other, how, call.on(options.machine)); });
  return pairsToDict(found);
}

nb::dict hausdorff(const Surface& self, const Surface& other, const PoseArray& pose, double tolerance,
                   bool bothWays, const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  std::vector<SurfacePair> found(1);
  const HausdorffOptions how{toPoses(pose).at(0), tolerance, bothWays};
  call.run([&] { found[0] = self.hausdorff(other, how, call.on(options.machine)); });
  return pairsToDict(found);
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
nb::dict query(const Surface& self, const PointArray<Real>& points, const std::set<std::string>& arrays,
               const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  QueryResult result;
  const PointsView view(points.data(), points.shape(0));
  const QueryOptions asked{.distance = arrays.contains("distance"),
                           .closest = arrays.contains("closest"),
                           .triangle = arrays.contains("triangle"),
                           .barycentric = arrays.contains("barycentric"),
                           .direction = arrays.contains("direction"),
                           .winding = arrays.contains("winding"),
                           .confidence = arrays.contains("confidence"),
                           .maxDistance = options.query.maxDistance};
  call.run([&] { self.query(view, asked, result, call.on(options.machine)); }, view.count);
  return toDict(std::move(result), asked, points.shape(0));
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

}  // namespace

void bindSurface(nb::module_& module) {
  module.def("is_compact_better", &isCompactBetter, "grid"_a, "triangles"_a);
  module.def(
      "region_bytes",
      [](const std::tuple<int, int, int>& size, const AllOptions& options) {
        return regionBytes(toWhole(size), options.region, options.machine);
      },
      "size"_a, "options"_a);
  nb::class_<Surface>(module, "Surface")
      .def(nb::new_(&make), "mesh"_a, "options"_a, "progress"_a.none())
      .def(
          "fit_grid",
          [](const Surface& self, const AllOptions& options) { return fitGrid(self.mesh(), options.grid); },
          "options"_a)
      .def("generate", &generate, "grid"_a, "options"_a, "progress"_a.none())
      .def("generate_sparse", &generateSparse, "grid"_a, "options"_a, "progress"_a.none())
      .def("generate_region", &generateRegion, "origin"_a, "spacing"_a, "dims"_a, "low"_a, "size"_a,
           "options"_a, "progress"_a.none())
      .def("far_distance", &farDistance, "origin"_a, "spacing"_a, "dims"_a, "low"_a, "size"_a, "options"_a)
      .def("query", &query<float>, "points"_a.noconvert(), "arrays"_a, "options"_a, "progress"_a.none())
      .def("query", &query<double>, "points"_a.noconvert(), "arrays"_a, "options"_a, "progress"_a.none())
      .def("distance_to", &distanceTo, "other"_a, "pose"_a.noconvert(), "options"_a, "progress"_a.none())
      .def("hausdorff", &hausdorff, "other"_a, "pose"_a.noconvert(), "tolerance"_a, "both_ways"_a,
           "options"_a, "progress"_a.none())
      .def("stats", [](const Surface& self) { return toPython(self.stats()); })
      .def("vertices", &surfaceVertices)
      .def("faces", &surfaceFaces)
      .def_prop_ro("bytes", &Surface::bytes)
      .def_prop_ro("origin", [](const Surface& self) { return toTriple(self.mesh().origin); });
}

}  // namespace raymap::python
