#include <cmath>

#include "cpu/backend.h"
#include "method/pipeline.h"
#include "testing/shapes.h"
#include "vulkan/self_test/checks.h"

namespace raymap::vulkan {

namespace {

struct Made {
  Field field;
  Stats stats;
};

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

/// Expects distances within 1e-6 of the diagonal, and equal signs wherever |w| is more than 1e-4 from the
/// threshold. Distances to a patch depend on where the winding number crosses the threshold, so less exactly.
void requireSameDistances(const Field& ours, const Field& theirs, const Mesh& mesh,
                          const FieldOptions& options) {
  const double allowed =
      options.closeHoles ? 0.01 * ours.grid.spacing : 1e-6 * glm::length(bounds(mesh).size());
  requireAll("distances", ours.distance, theirs.distance,
             [&](float a, float b) { return std::abs(std::abs(a) - std::abs(b)) <= allowed; });
  for (size_t s = 0; s < theirs.distance.size(); ++s)
    if (std::signbit(ours.distance[s]) != std::signbit(theirs.distance[s]))
      require(std::abs(std::abs(theirs.winding[s]) - options.threshold) < 1e-4,
              "sign of sample " + textOf(s) + " is wrong; its winding number is " + textOf(ours.winding[s]) +
                  ", not " + textOf(theirs.winding[s]));
}

void requireSameField(const Made& ours, const Made& theirs, const Mesh& mesh, const FieldOptions& options) {
  requireEqual("turned faces", ours.stats.turnedFaces, theirs.stats.turnedFaces);
  requireEqual("left out faces", ours.stats.leftOutFaces, theirs.stats.leftOutFaces);
  requireEqual("triangles of the patch", std::vector{ours.stats.patchTriangles},
               std::vector{theirs.stats.patchTriangles});
  requireNear("misfit", std::vector{ours.stats.misfit}, std::vector{theirs.stats.misfit}, 1e-4);
  requireSameDistances(ours.field, theirs.field, mesh, options);
  if (options.sign != SignMode::None) {
    // The dipoles take their looks in another order of nodes than the CPU's.
    const bool hasDipoles = options.sign == SignMode::Harmonic;
    requireNear("winding numbers", ours.field.winding, theirs.field.winding, hasDipoles ? 0.06 : 1e-5);
    requireNear("confidences", ours.field.confidence, theirs.field.confidence, hasDipoles ? 0.06 : 1e-5);
  }
}

void compareFields(Subject& subject, const std::string& name, const Mesh& mesh,
                   const GridOptions& gridOptions, const FieldOptions& asked) {
  const FieldOptions options = withEverything(asked);
  const Grid grid = fitGrid(mesh, gridOptions);
  cpu::Backend cpu;
  inCase(name, [&] {
    requireSameField(make(subject.backend, mesh, grid, options), make(cpu, mesh, grid, options), mesh,
                     options);
  });
}

struct NamedMesh {
  const char* name;
  Mesh mesh;
};

Mesh holedSphere() {
  Mesh mesh = shapes::sphere(1.0, 3);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.6; });
  return mesh;
}

Mesh withEveryOther(Mesh mesh, size_t every, const auto& change) {
  const size_t count = mesh.triangles.size();
  for (size_t t = 0; t < count; t += every) change(mesh.triangles, t);
  return mesh;
}

Mesh flipped(const Mesh& mesh, size_t every) {
  return withEveryOther(mesh, every,
                        [](auto& triangles, size_t t) { std::swap(triangles[t].y, triangles[t].z); });
}

Mesh doubled(const Mesh& mesh) {
  return withEveryOther(mesh, 1, [](auto& triangles, size_t t) {
    const glm::uvec3 face = triangles[t];
    triangles.emplace_back(face.z, face.y, face.x);
  });
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

std::vector<NamedMesh> meshes() {
  return {{"sphere", shapes::sphere(1.0, 3)},
          {"torus", shapes::torus(1.0, 0.3, 40, 20)},
          {"soup", shapes::soup(150, 3)},
          {"open sphere", holedSphere()},
          {"doubled faces", doubled(holedSphere())},
          {"degenerate faces", withDegenerate(holedSphere())},
          {"crowded cells", shapes::joined(shapes::sphere(0.01, 3, {0.4, 0.5, 0.5}), shapes::soup(3, 1))}};
}

void checkDefault(Subject& subject) {
  for (const auto& [name, mesh] : meshes()) compareFields(subject, name, mesh, {.resolution = 20}, {});
  const GridOptions box{.resolution = 16, .box = Box{glm::dvec3(-1.5), glm::dvec3(1.5)}};
  compareFields(subject, "large triangle", underALargeTriangle(), box, {});
  compareFields(subject, "band", holedSphere(), {.resolution = 20}, {.band = 3.0});
}

void checkQuick(Subject& subject) {
  const FieldOptions quick{.distance = DistanceMode::Cell, .sign = SignMode::Rays};
  for (const auto& [name, mesh] : meshes()) compareFields(subject, name, mesh, {.resolution = 24}, quick);
  const GridOptions box{.resolution = 16, .box = Box{glm::dvec3(-1.5), glm::dvec3(1.5)}};
  compareFields(subject, "large triangle", underALargeTriangle(), box, quick);
}

void checkModes(Subject& subject) {
  const Mesh mesh = holedSphere();
  const GridOptions whole{.resolution = 16};
  const GridOptions cut{.resolution = 16, .box = Box{{-0.2, -1.5, -0.1}, {1.0, 0.4, 0.9}}};
  for (const GridOptions& grid : {whole, cut}) {
    compareFields(subject, "neighbours, ray", mesh, grid,
                  {.distance = DistanceMode::Neighbours, .sign = SignMode::Ray});
    compareFields(subject, "raster, paths", mesh, grid,
                  {.distance = DistanceMode::Raster, .sign = SignMode::Paths});
    compareFields(subject, "cell, evolution", mesh, grid,
                  {.distance = DistanceMode::Cell, .sign = SignMode::Evolution, .sampling = Sampling::Paper});
  }
}

void checkTurns(Subject& subject) {
  compareFields(subject, "every third face", flipped(holedSphere(), 3), {.resolution = 20}, {});
  compareFields(subject, "repair", flipped(holedSphere(), 7), {.resolution = 20},
                {.sign = SignMode::Paths, .orientation = Orientation::Repair});
}

void checkHoles(Subject& subject) {
  Mesh ring = shapes::torus(1.0, 0.4, 40, 20);
  ring.triangles.erase(ring.triangles.begin() + 40, ring.triangles.begin() + 160);
  compareFields(subject, "torn torus", ring, {.resolution = 24}, {.closeHoles = true});
  compareFields(subject, "torn torus, cell", ring, {.resolution = 24},
                {.distance = DistanceMode::Cell, .sign = SignMode::Paths, .closeHoles = true});
}

}  // namespace

std::span<const Check> checksOfFields() {
  static constexpr Check kChecks[] = {{"default fields", checkDefault},
                                      {"quick fields", checkQuick},
                                      {"fields of other modes", checkModes},
                                      {"fields of turned faces", checkTurns},
                                      {"fields with closed holes", checkHoles}};
  return kChecks;
}

}  // namespace raymap::vulkan
