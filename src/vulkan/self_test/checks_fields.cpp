#include <cmath>

#include "cpu/backend.h"
#include "method/pipeline.h"
#include "testing/broken_meshes.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"

namespace raymap::vulkan {

namespace {

FieldOptions withEverything(FieldOptions options) {
  options.winding = options.confidence = true;
  options.triangle = options.distance != DistanceMode::Raster;
  return options;
}

template <class Backend>
Made make(Backend& backend, const Mesh& mesh, const Grid& grid, const FieldOptions& options) {
  const Model model(mesh);
  Made made;
  Progress progress;
  backend.setJob({model, grid, options, progress, made.field});
  runPipeline(backend);
  if constexpr (requires { backend.readResults(); }) backend.readResults();
  describeMesh(backend, grid, made.stats);
  return made;
}

void requireSameStats(const Stats& ours, const Stats& theirs) {
  requireEqual("turned faces", ours.turnedFaces, theirs.turnedFaces);
  requireEqual("left out faces", ours.leftOutFaces, theirs.leftOutFaces);
  requireEqual("inverted parts", ours.invertedParts, theirs.invertedParts);
  const auto numbersOf = [](const Stats& stats) {
    return std::vector{double(stats.patchTriangles), stats.doubtfulShare, double(stats.orientationFits),
                       stats.misfitGiven, stats.misfit};
  };
  requireNear("triangles of the patch, doubts and misfits", numbersOf(ours), numbersOf(theirs), 1e-4);
  requireNear("area of the patch", std::vector{ours.patchArea}, std::vector{theirs.patchArea}, 0.0, 1e-4);
}

Mesh withDegenerate(Mesh mesh) {
  mesh.triangles.insert(mesh.triangles.begin(), {{0, 0, 0}, {0, 1, 1}, {2, 3, 2}});
  return mesh;
}

/// Returns a small sphere below a triangle that reaches far beyond every grid about the sphere.
Mesh underALargeTriangle() {
  const std::vector<glm::dvec3> corners{{-500, -400, 1.25}, {600, -400, 1.25}, {0, 700, 1.25}};
  return shapes::joined(shapes::sphere(1.0, 2), makeMesh(corners, {{0, 1, 2}}));
}

std::vector<std::pair<const char*, Mesh>> meshes() {
  return {{"sphere", shapes::sphere(1.0, 3)},
          {"torus", shapes::torus(1.0, 0.3, 40, 20)},
          {"soup", shapes::soup(150, 3)},
          {"open sphere", holedSphere()},
          {"doubled faces", withDoubledFaces(holedSphere(), 1.0, 1)},
          {"degenerate faces", withDegenerate(holedSphere())},
          {"crowded cells", shapes::joined(shapes::sphere(0.01, 3, {0.4, 0.5, 0.5}), shapes::soup(3, 1))}};
}

void compareAll(Subject& subject, int resolution, const FieldOptions& options) {
  for (const auto& [name, mesh] : meshes())
    compareFields(subject.backend, name, mesh, {.resolution = resolution}, options);
  const GridOptions box{.resolution = 16, .box = Box{glm::dvec3(-1.5), glm::dvec3(1.5)}};
  compareFields(subject.backend, "large triangle", underALargeTriangle(), box, options);
}

}  // namespace

void checkDefault(Subject& subject) {
  compareAll(subject, 20, {});
  compareFields(subject.backend, "band", holedSphere(), {.resolution = 20}, {.band = 3.0});
}

void checkQuick(Subject& subject) {
  compareAll(subject, 24, {.distance = DistanceMode::Cell, .sign = SignMode::Rays});
}

void checkModes(Subject& subject) {
  const Mesh mesh = holedSphere();
  const GridOptions whole{.resolution = 16};
  const GridOptions cut{.resolution = 16, .box = Box{{-0.2, -1.5, -0.1}, {1.0, 0.4, 0.9}}};
  for (const GridOptions& grid : {whole, cut}) {
    compareFields(subject.backend, "neighbours, ray", mesh, grid,
                  {.distance = DistanceMode::Neighbours, .sign = SignMode::Ray});
    compareFields(subject.backend, "raster, paths", mesh, grid,
                  {.distance = DistanceMode::Raster, .sign = SignMode::Paths});
    compareFields(subject.backend, "cell, evolution", mesh, grid,
                  {.distance = DistanceMode::Cell, .sign = SignMode::Evolution, .sampling = Sampling::Paper});
  }
}

void checkTurns(Subject& subject) {
  compareFields(subject.backend, "a third of the faces", withFlippedFaces(holedSphere(), 1.0 / 3.0, 1),
                {.resolution = 20}, {});
  compareFields(subject.backend, "repair", withFlippedFaces(holedSphere(), 1.0 / 7.0, 1), {.resolution = 20},
                {.sign = SignMode::Paths, .orientation = Orientation::Repair});
}

void checkHoles(Subject& subject) {
  Mesh ring = shapes::torus(1.0, 0.4, 40, 20);
  ring.triangles.erase(ring.triangles.begin() + 40, ring.triangles.begin() + 160);
  compareFields(subject.backend, "torn torus", ring, {.resolution = 24}, {.closeHoles = true});
  compareFields(subject.backend, "torn torus, cell", ring, {.resolution = 24},
                {.distance = DistanceMode::Cell, .sign = SignMode::Paths, .closeHoles = true});
}

Made makeField(Backend& backend, const Mesh& mesh, const Grid& grid, const FieldOptions& options) {
  return make(backend, mesh, grid, options);
}

void requireSameDistances(const Field& ours, const Field& theirs, const Mesh& mesh,
                          const FieldOptions& options) {
  const double allowed =
      options.closeHoles ? 0.01 * ours.grid.spacing : 1e-6 * glm::length(bounds(mesh).size());
  requireAll("distances", ours.distance, theirs.distance,
             [&](float a, float b) { return std::abs(std::abs(a) - std::abs(b)) <= allowed; });
  size_t unlike = 0;
  for (size_t s = 0; s < theirs.distance.size(); ++s)
    if (std::signbit(ours.distance[s]) != std::signbit(theirs.distance[s])) {
      require(std::abs(std::abs(theirs.winding[s]) - options.threshold) < 1e-4,
              "sign of sample " + textOf(s) + " is wrong; its winding number is " + textOf(ours.winding[s]) +
                  ", not " + textOf(theirs.winding[s]));
      ++unlike;
    }
  require(unlike <= 2 + theirs.distance.size() / 10000, textOf(unlike) + " signs differ");
}

Stats compareFields(Backend& backend, const std::string& name, const Mesh& mesh, const GridOptions& on,
                    const FieldOptions& asked) {
  const FieldOptions options = withEverything(asked);
  const Grid grid = fitGrid(mesh, on);
  cpu::Backend cpu;
  const Made ours = make(backend, mesh, grid, options), theirs = make(cpu, mesh, grid, options);
  inCase(name, [&] {
    requireSameStats(ours.stats, theirs.stats);
    requireSameDistances(ours.field, theirs.field, mesh, options);
    size_t unlike = 0;
    for (size_t s = 0; s < theirs.field.triangle.size(); ++s)
      unlike += (ours.field.triangle[s] == kNoTriangle) != (theirs.field.triangle[s] == kNoTriangle) ? 1 : 0;
    require(1000 * unlike <= theirs.field.triangle.size(), "other samples have a closest triangle");
    if (options.sign == SignMode::None) return;
    // The dipoles take their looks in another order of nodes than the CPU's. Rays are whole numbers.
    const bool hasRays = options.sign == SignMode::Rays || options.sign == SignMode::Ray;
    const double allowed = options.sign == SignMode::Harmonic ? 0.06 : 1e-5;
    requireNear("winding numbers", ours.field.winding, theirs.field.winding, hasRays ? 0.0 : allowed);
    requireNear("confidences", ours.field.confidence, theirs.field.confidence, allowed);
  });
  return theirs.stats;
}

}  // namespace raymap::vulkan
