#include <raymap/scene.h>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

using WorldPoints = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

glm::dmat4 toPose(const PoseArray& rows) {
  return toPoses(rows).at(0);
}

nb::ndarray<nb::numpy, double> posesOf(const Scene& self) {
  std::vector<double> numbers;
  for (const glm::dmat4& pose : self.poses())
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) numbers.push_back(pose[column][row]);
  return toArray<double>(std::move(numbers), {self.size(), 4, 4});
}

/// Returns the arrays that the options ask for, by name.
nb::dict toDict(SceneResult result, const SceneOptions& options, size_t count, size_t bodies) {
  nb::dict dict;
  if (options.distance) dict["distance"] = toArray<double>(std::move(result.distance), {count});
  if (options.body) dict["body"] = toArray<uint32_t>(std::move(result.body), {count});
  if (options.closest) dict["closest"] = toArray<double>(std::move(result.closest), {count, 3});
  if (options.gradient) dict["gradient"] = toArray<double>(std::move(result.gradient), {count, 3});
  if (options.distances) dict["distances"] = toArray<double>(std::move(result.distances), {count, bodies});
  if (options.triangle) dict["triangle"] = toArray<uint32_t>(std::move(result.triangle), {count});
  return dict;
}

SceneOptions sceneOptions(const std::set<std::string>& arrays, const std::vector<uint32_t>& without,
                          const AllOptions& options) {
  return {.distance = arrays.contains("distance"),
          .body = arrays.contains("body"),
          .closest = arrays.contains("closest"),
          .gradient = arrays.contains("gradient"),
          .distances = arrays.contains("distances"),
          .triangle = arrays.contains("triangle"),
          .maxDistance = options.scene.maxDistance,
          .without = without};
}

nb::dict queryScene(const Scene& self, const WorldPoints& points, const std::set<std::string>& arrays,
                    const std::vector<uint32_t>& without, const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  SceneResult result;
  const SceneOptions asked = sceneOptions(arrays, without, options);
  const PointsView view(points.data(), points.shape(0));
  call.run([&] { result = self.query(view, asked, call.on(options.machine)); }, view.count);
  return toDict(std::move(result), asked, points.shape(0), self.size());
}

nb::dict queryConfigurations(const Scene& self, const WorldPoints& points, const PoseArray& rows,
                             size_t count, bool hasOwnPoints, const std::set<std::string>& arrays,
                             const std::vector<uint32_t>& without, const AllOptions& options,
                             nb::object progress) {
  Call call(std::move(progress));
  SceneResult result;
  const SceneOptions asked = sceneOptions(arrays, without, options);
  const PointsView view(points.data(), points.shape(0));
  const std::vector<glm::dmat4> poses = toPoses(rows);
  const size_t total = hasOwnPoints ? view.count : count * view.count;
  call.run(
      [&] {
        result = self.query(view, {poses, count, hasOwnPoints}, asked, call.on(options.machine));
      },
      total);
  return toDict(std::move(result), asked, total, self.size());
}

nb::dict distancesBetween(const Scene& self, const std::vector<std::pair<uint32_t, uint32_t>>& pairs,
                          const PoseArray& rows, size_t count, const AllOptions& options,
                          nb::object progress) {
  Call call(std::move(progress));
  std::vector<glm::uvec2> asked;
  for (const auto& [first, second] : pairs) asked.emplace_back(first, second);
  const std::vector<glm::dmat4> poses = toPoses(rows);
  std::vector<SurfacePair> found;
  call.run([&] {
    found = self.distancesBetween(asked, {poses, count}, options.scene.maxDistance, call.on(options.machine));
  });
  return pairsToDict(found);
}

Bounds boundsOf(const Scene& self) {
  const auto [low, high] = corners(self.bounds());
  return {toTriple(low), toTriple(high)};
}

Grid fitSceneGrid(const Scene& self, const AllOptions& options) {
  return fitGrid(self.bounds(), options.grid);
}

std::shared_ptr<FieldHandle> generateUnion(const Scene& self, const Grid& grid, bool isSparse,
                                           const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  const auto result = std::make_shared<FieldHandle>();
  call.run([&] {
    const MachineOptions machine = call.on(options.machine);
    result->field = isSparse ? self.generateBand(grid, options.band, machine)
                             : self.generate(grid, options.field.band, machine);
  });
  result->stats.device = "cpu";
  return result;
}

}  // namespace

std::vector<glm::dmat4> toPoses(const PoseArray& rows) {
  std::vector<glm::dmat4> poses(rows.shape(0));
  for (size_t i = 0; i < poses.size(); ++i)
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column)
        poses[i][column][row] = rows.data()[16 * i + 4 * size_t(row) + size_t(column)];
  return poses;
}

nb::dict pairsToDict(const std::vector<SurfacePair>& pairs) {
  std::vector<double> distance, bound, point, otherPoint;
  std::vector<uint32_t> triangle, otherTriangle;
  for (const SurfacePair& pair : pairs) {
    distance.push_back(pair.distance);
    bound.push_back(pair.bound);
    triangle.push_back(pair.triangle);
    otherTriangle.push_back(pair.otherTriangle);
    for (int a = 0; a < 3; ++a) point.push_back(pair.point[a]), otherPoint.push_back(pair.otherPoint[a]);
  }
  nb::dict dict;
  const size_t count = pairs.size();
  dict["distance"] = toArray<double>(std::move(distance), {count});
  dict["bound"] = toArray<double>(std::move(bound), {count});
  dict["point"] = toArray<double>(std::move(point), {count, 3});
  dict["other_point"] = toArray<double>(std::move(otherPoint), {count, 3});
  dict["triangle"] = toArray<uint32_t>(std::move(triangle), {count});
  dict["other_triangle"] = toArray<uint32_t>(std::move(otherTriangle), {count});
  return dict;
}

void bindScene(nb::module_& module) {
  nb::class_<Scene>(module, "Scene")
      .def(nb::init<>())
      .def(
          "add",
          [](Scene& self, std::string name, std::shared_ptr<Surface> surface, const PoseArray& pose) {
            self.add(std::move(name), std::shared_ptr<const Surface>(std::move(surface)), toPose(pose));
          },
          "name"_a, "body"_a, "pose"_a)
      // The scene shares the field and keeps its handle.
      .def(
          "add",
          [](Scene& self, std::string name, const std::shared_ptr<FieldHandle>& handle,
             const PoseArray& pose) {
            self.add(std::move(name), std::shared_ptr<const Field>(handle, &handle->field), toPose(pose));
          },
          "name"_a, "body"_a, "pose"_a)
      .def(
          "remove", [](Scene& self, std::string_view name) { self.remove(name); }, "name"_a)
      .def(
          "set_pose",
          [](Scene& self, std::string_view name, const PoseArray& pose) { self.setPose(name, toPose(pose)); },
          "name"_a, "pose"_a)
      .def(
          "set_poses", [](Scene& self, const PoseArray& poses) { self.setPoses(toPoses(poses)); }, "poses"_a)
      .def("poses", &posesOf)
      .def_prop_ro("names", &Scene::names)
      .def(
          "number", [](const Scene& self, std::string_view name) { return self.number(name); }, "name"_a)
      .def("bounds", &boundsOf)
      .def("fit_grid", &fitSceneGrid, "options"_a)
      .def("generate", &generateUnion, "grid"_a, "sparse"_a, "options"_a, "progress"_a.none())
      .def("distances_between", &distancesBetween, "pairs"_a, "poses"_a.noconvert(), "count"_a, "options"_a,
           "progress"_a.none())
      .def("query", &queryScene, "points"_a.noconvert(), "arrays"_a, "without"_a, "options"_a,
           "progress"_a.none())
      .def("query_many", &queryConfigurations, "points"_a.noconvert(), "poses"_a.noconvert(), "count"_a,
           "has_own_points"_a, "arrays"_a, "without"_a, "options"_a, "progress"_a.none());
}

}  // namespace raymap::python
