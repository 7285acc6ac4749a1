#include <cmath>

#include "cpu/cells/raster_distance.h"
#include "cpu/cells/refine.h"
#include "cpu/cells/triangle.h"
#include "vulkan/device/dispatch_limits.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"
#include "vulkan/stages/cell_mesh.h"

namespace raymap::vulkan {

namespace {

constexpr double kAllowed =
    1e-6;  // Share of the grid's diagonal, and of the distance, whose floats are as coarse.

double allowedIn(const CellMesh& mesh) {
  return kAllowed * glm::length(glm::dvec3(mesh.dims));
}

/// Checks the closest triangles, which may differ where they are equally far away but for rounding.
void requireClosest(const CellMesh& mesh, const CellResult& result) {
  std::vector<float> distances;
  for (size_t s = 0; s < result.triangle.size(); ++s) {
    const uint32_t t = result.triangle[s];
    require(t < mesh.triangles.size(), "the closest triangle of sample " + textOf(s) + " is " + textOf(t));
    distances.push_back(std::sqrt(cpu::triangleSquaredDistance(
        glm::vec3(CellLattice{mesh.dims}.cell(s)), mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2))));
  }
  requireNear("distance of the closest triangle", result.distance, distances, allowedIn(mesh), kAllowed);
}

void requireSame(const std::string& name, const cpu::VoxelGrid& ours, const cpu::VoxelGrid& theirs) {
  requireEqual(name + "starts of the lists", ours.starts, theirs.starts);
  requireEqual(name + "lists", ours.triangles, theirs.triangles);
}

/// Meshes with small and large triangles, crowded cells, triangles outside the grid and larger than it, and
/// degenerate ones.
std::vector<OwnCellMesh> cellMeshes() {
  std::vector<OwnCellMesh> meshes;
  meshes.push_back(cellSoup(400, {13, 9, 11}, 1));
  meshes.push_back(onGrid(shapes::torus(1.0, 0.3, 40, 20), {.resolution = 20}));
  meshes.push_back(onGrid(shapes::joined(shapes::sphere(0.01, 3, {0.4, 0.5, 0.5}), shapes::soup(3, 1)),
                          {.resolution = 12}));
  meshes.push_back(onGrid(shapes::torus(1.0, 0.3, 40, 20),
                          {.resolution = 14, .box = Box{{-0.4, -0.5, -0.3}, {0.9, 0.3, 0.5}}}));
  meshes.push_back(cellSoup(60, {10, 10, 10}, 8));
  for (size_t t = 0; t < 60; ++t) {  // Points, segments, and triangles far larger than the grid.
    glm::vec3* v = meshes.back().vertices.data() + 3 * t;
    if (t % 3 == 0) v[1] = v[0];
    if (t % 6 == 0) v[2] = v[0];
    if (t % 20 == 1) v[2] *= 1e4f;
  }
  return meshes;
}

void compareCellMesh(Subject& subject, int count, double far) {
  Mesh mesh = shapes::soup(count, 5);
  mesh.origin += far;
  const Grid grid{.dims = {50, 50, 50}, .origin = glm::dvec3(far - 0.123), .spacing = 0.0173};
  const glm::dvec3 shift = mesh.origin - grid.origin;
  std::vector<float> expected;
  for (const glm::vec3& v : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis)
      expected.push_back(static_cast<float>((shift[axis] + double(v[axis])) * (1.0 / grid.spacing)));
  MeshUpload upload(subject.probe.device());
  upload.fill(mesh);
  CellMeshStage cells(subject.probe.device());
  cells.reserve(upload.source().vertexCount, upload.source().triangleCount);
  subject.probe.run([&](Commands& commands) { cells.record(commands, upload.source(), grid, 0.0); });
  inCase(textOf(count) + " triangles, origin " + textOf(far), [&] {
    requireEqual("coordinates", subject.probe.download<float>(cells.vertexBuffer()), expected);
    requireEqual("triangles", subject.probe.download<glm::uvec3>(cells.triangleBuffer()), mesh.triangles);
  });
}

}  // namespace

void checkCellMesh(Subject& subject) {
  for (const double far : {0.0, 12345.678, 1e9}) compareCellMesh(subject, 600, far);
}

void checkVoxelGrid(Subject& subject) {
  for (const OwnCellMesh& mesh : cellMeshes())
    for (const CellLattice& cells : coverMesh(mesh)) compareVoxelGrid(subject.cells, mesh, cells);
}

void checkTransform(Subject& subject) {
  unsigned seed = 0;
  for (const glm::ivec3 dims :
       {glm::ivec3(14, 9, 11), glm::ivec3(33, 40, 25), glm::ivec3(1, 33, 20), glm::ivec3(3, 2, 700)})
    for (const double share : {0.0, 0.004, 0.1, 1.0}) {
      ++seed;
      compareTransform(subject.cells, dims, randomCells(dims, share, seed, seed % 2 == 0));
    }
  for (const glm::ivec3 dims : {glm::ivec3(3000, 3, 1), glm::ivec3(2, 3000, 1), glm::ivec3(3, 1, 3000)})
    compareTransform(subject.cells, dims, randomCells(dims, 0.1, 5));
  // Values so small that they vanish when added to a squared distance.
  const glm::ivec3 dims(40, 6, 50);
  Buffer<float> small = randomCells(dims, 0.01, 3, true);
  std::mt19937 random(4);
  for (float& value : small)
    if (value == 0.0f) value = 1e-20f * static_cast<float>(random() % 1000);
  compareTransform(subject.cells, dims, small);
}

void checkRefine(Subject& subject) {
  for (const OwnCellMesh& mesh : cellMeshes())
    for (const int reach : {0, 1}) compareRefine(subject.cells, mesh, reach);
}

void checkLargeInputs(Subject& subject) {
  compareCellMesh(subject, kMostInvocations / 3 + 1000, 0.0);  // The vertices take two dimensions of groups.
  // All samples are crowded, which takes two dispatches.
  compareRefine(subject.cells,
                onGrid(shapes::sphere(0.001, 2, glm::dvec3(0.51)),
                       {.resolution = 33, .box = Box{glm::dvec3(0.0), glm::dvec3(1.0)}}),
                0);
}

void checkRasterDistance(Subject& subject) {
  for (const OwnCellMesh& mesh : cellMeshes()) compareRasterDistance(subject.cells, mesh);
}

void compareVoxelGrid(CellProbe& probe, const CellMesh& mesh, const CellLattice& cells) {
  Progress progress;
  cpu::VoxelGrid expected;
  buildVoxelGrid(mesh, cells, SIZE_MAX, progress, expected);
  inCase(nameOf(mesh), [&] {
    requireSame("", probe.voxelGrid(mesh, cells), expected);
    requireSame("the second time, ", probe.voxelGrid(mesh, cells), expected);
  });
}

void compareTransform(CellProbe& probe, const glm::ivec3& dims, const Buffer<float>& squared) {
  Progress progress;
  Buffer<float> expected = squared.clone();
  Buffer<uint32_t> nearest;
  cpu::transformDistance(dims, progress, expected, nearest);
  inCase(textOf(dims, " x ") + " cells", [&] {
    for (const char* when : {"", " the second time"}) {
      const cpu::CellLevel result = probe.transform(dims, squared);
      requireEqual(std::string("nearest cells") + when, result.nearestCell, nearest);
      requireEqual(std::string("squared distances") + when, result.squared, expected);
    }
  });
}

void compareRefine(CellProbe& probe, const CellMesh& mesh, int reach) {
  Progress progress;
  const std::vector<cpu::CellLevel> levels = nearestCells(mesh);
  Buffer<float> expected;
  refineDistance(mesh, levels, reach, progress, expected, nullptr);
  const CellResult result = probe.refine(mesh, reach);
  inCase(nameOf(mesh), [&] {
    for (size_t l = 0; l < levels.size(); ++l) {
      const std::string name = "level " + textOf(l) + ", ";
      requireSame(name, result.levels.at(l).grid, levels[l].grid);
      requireEqual(name + "squared distances", result.levels[l].squared, levels[l].squared);
      requireEqual(name + "nearest cells", result.levels[l].nearestCell, levels[l].nearestCell);
    }
    requireNear("distances", result.distance, expected, allowedIn(mesh), kAllowed);
    requireClosest(mesh, result);
  });
}

void compareRasterDistance(CellProbe& probe, const CellMesh& mesh) {
  Progress progress;
  Buffer<float> expected;
  CellResult result = probe.rasterDistance(mesh);
  inCase(nameOf(mesh), [&] {
    for (cpu::CellLevel& level : result.levels) {
      cpu::rasterizeDistance(mesh, level.grid.cells, progress, expected);
      requireEqual("squared distances", level.squared, expected);
      cpu::transformDistance(level.grid.cells.dims, progress, level.squared, level.nearestCell);
    }
    sampleRasterDistance(mesh.dims, result.levels, progress, expected);
    requireNear("distances", result.distance, expected, allowedIn(mesh), kAllowed);
  });
}

}  // namespace raymap::vulkan
