#include "repair/solid/solid_band.h"

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "broken_meshes.h"
#include "mesh/model.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kWidth = 4.0;

cpu::PreparedSurface prepare(const Model& mesh) {
  Progress quiet;
  Stats stats;
  return cpu::prepareSurface(mesh, {}, {}, quiet, stats);
}

ClosedBand closedBand(cpu::PreparedSurface& surface, const Grid& grid, bool closesHoles = true) {
  Progress quiet;
  return makeClosedBand(surface, grid, {.outside = kWidth, .inside = kWidth}, closesHoles, SIZE_MAX, quiet);
}

template <class Visit>
void forEachSample(const Grid& grid, Visit&& visit) {
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i) visit(glm::ivec3(i, j, k));
}

TEST(SolidBand, ClosesHolesAsADenseFieldDoes) {
  const Mesh mesh = withHoles(shapes::torus(1.0, 0.35, 40, 20), 3, 0.2, 7);
  const Model model(mesh);
  const Grid grid = fitGrid(mesh, {.resolution = 72});
  cpu::PreparedSurface surface = prepare(model);
  const ClosedBand closed = closedBand(surface, grid);
  const Generated made = generate(mesh, grid, {.band = kWidth, .closeHoles = true}, {.device = "cpu"});
  const Field& dense = made.field;
  const Stats& stats = made.stats;
  ASSERT_GT(stats.patchTriangles, 100u);
  EXPECT_NEAR(double(closed.patchTriangles), double(stats.patchTriangles),
              0.02 * double(stats.patchTriangles));
  EXPECT_NEAR(closed.patchArea, stats.patchArea, 0.01 * stats.patchArea);
  validate(closed.field);
  size_t apart = 0;
  forEachSample(grid, [&](const glm::ivec3& s) {
    const float expected = dense.distance[grid.index(s)], found = closed.field.distanceAt(s);
    if (std::abs(expected - found) > 0.01 * grid.spacing) ++apart;
    if (std::abs(expected) > 0.1 * grid.spacing) {
      EXPECT_EQ(expected < 0.0f, found < 0.0f);
    }
  });
  // Beside the patch, whose points come from numbers of another precision.
  EXPECT_LT(apart, grid.sampleCount() / 2000);
}

TEST(SolidBand, ClosesAHoleInTheMiddleOfTiles) {
  // The lower part of a box that is much deeper than the band. The hole closes over its middle.
  Mesh mesh = shapes::box(glm::dvec3(-1.0, -1.0, -0.5), glm::dvec3(1.0, 1.0, 0.5));
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return mesh.vertices[t.x].z > 0.0f && mesh.vertices[t.y].z > 0.0f && mesh.vertices[t.z].z > 0.0f;
  });
  const Model model(mesh);
  const Grid grid = fitGrid(mesh, {.resolution = 90});
  cpu::PreparedSurface surface = prepare(model);
  const Field open = closedBand(surface, grid, false).field;
  const ClosedBand closed = closedBand(surface, grid);
  const Field dense = generate(mesh, grid, {.band = kWidth, .closeHoles = true}, {.device = "cpu"}).field;
  validate(closed.field);
  EXPECT_GT(closed.field.narrow->leaves.size(), open.narrow->leaves.size());
  size_t apart = 0, near = 0;
  forEachSample(grid, [&](const glm::ivec3& s) {
    const float expected = dense.distance[grid.index(s)], found = closed.field.distanceAt(s);
    if (std::abs(expected) < std::abs(open.distanceAt(s)) - float(grid.spacing)) ++near;
    // Dense fields end the patch beside the rim, not at it.
    if (std::abs(open.distanceAt(s)) > 3.0 * grid.spacing && std::abs(expected - found) > 0.01 * grid.spacing)
      ++apart;
    if (std::abs(expected) > 0.1 * grid.spacing) {
      EXPECT_EQ(expected < 0.0f, found < 0.0f) << s.x << " " << s.y << " " << s.z;
    }
  });
  EXPECT_GT(near, 10000u);
  EXPECT_LT(apart, grid.sampleCount() / 2000);
}

TEST(SolidBand, LeavesTheSurfaceAsItWas) {
  const Mesh mesh = withHoles(shapes::torus(1.0, 0.35, 40, 20), 3, 0.2, 7);
  const Model model(mesh);
  const Grid grid = fitGrid(mesh, {.resolution = 48});
  cpu::PreparedSurface surface = prepare(model);
  const ClosedBand open = closedBand(surface, grid, false);
  const ClosedBand closed = closedBand(surface, grid);
  EXPECT_EQ(open.patchTriangles, 0u);
  EXPECT_EQ(surface.mesh.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(surface.tree.triangleCount(), mesh.triangles.size());
  EXPECT_TRUE(std::ranges::equal(closedBand(surface, grid, false).field.distance, open.field.distance));
  EXPECT_FALSE(std::ranges::equal(closed.field.distance, open.field.distance));
  EXPECT_TRUE(std::ranges::equal(closedBand(surface, grid).field.distance, closed.field.distance));
}

TEST(SolidBand, OfAClosedMeshIsThatOfItsSurface) {
  const Mesh mesh = shapes::torus(1.0, 0.35, 40, 20);
  const Model model(mesh);
  const Grid grid = fitGrid(mesh, {.resolution = 48});
  cpu::PreparedSurface surface = prepare(model);
  const ClosedBand closed = closedBand(surface, grid);
  const Field expected = Surface(mesh).generateBand(grid, {.outside = kWidth, .inside = kWidth});
  EXPECT_EQ(closed.patchTriangles, 0u);
  EXPECT_TRUE(std::ranges::equal(closed.field.distance, expected.distance));
  EXPECT_TRUE(std::ranges::equal(closed.field.narrow->leaves, expected.narrow->leaves));
}

TEST(SolidBand, UniteGivesTheLeastDistances) {
  // A sheet that sticks out of a box on both sides, and passes its middle, where there are tiles.
  const Mesh box = shapes::box(glm::dvec3(-1.0), glm::dvec3(1.0));
  const Mesh sheet = makeMesh(
      std::vector<glm::dvec3>{{-1.7, -0.2, 0.13}, {1.7, -0.2, 0.13}, {1.7, 0.3, 0.13}, {-1.7, 0.3, 0.13}},
      {{0, 1, 2}, {0, 2, 3}});
  const Grid grid = fitGrid(Box{glm::dvec3(-2.0), glm::dvec3(2.0)}, {.resolution = 80});
  const Model model(box);
  cpu::PreparedSurface surface = prepare(model);
  Field solid = closedBand(surface, grid).field;
  ASSERT_FALSE(solid.narrow->tiles.empty());
  const Field before = closedBand(surface, grid).field;
  Progress quiet;
  const double radius = 1.5 * grid.spacing, width = 3.0 * grid.spacing;
  const Field plates = makePlateBand(sheet, grid, radius, width, SIZE_MAX, quiet);
  unite(solid, plates);
  validate(solid);
  EXPECT_GT(solid.narrow->leaves.size(), before.narrow->leaves.size());
  forEachSample(grid, [&](const glm::ivec3& s) {
    const glm::dvec3 p = grid.position(glm::dvec3(s));
    const glm::dvec3 nearest(std::clamp(p.x, -1.7, 1.7), std::clamp(p.y, -0.2, 0.3), 0.13);
    const double plate = glm::distance(p, nearest) - radius;
    const double own = before.distanceAt(s), expected = plate < width ? std::min(own, plate) : own;
    if (solid.narrow->find(s)) {
      EXPECT_NEAR(solid.distanceAt(s), expected, 1e-5);
    }
    EXPECT_EQ(solid.distanceAt(s) < 0.0f, expected < 0.0) << s.x << " " << s.y << " " << s.z;
  });
}

/// A rod along the diagonal of a cube.
Mesh obliqueRod(double length, double radius) {
  constexpr int kSides = 12;
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0, 1.0, 1.0)),
                   u = glm::normalize(glm::dvec3(1.0, -1.0, 0.0)), v = glm::cross(axis, u);
  std::vector<glm::dvec3> points;
  std::vector<glm::uvec3> faces;
  for (const double along : {0.0, length})
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kSides;
      points.push_back(along * axis + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  for (uint32_t k = 0; k < kSides; ++k) {
    const uint32_t next = (k + 1) % kSides;
    faces.insert(faces.end(), {{k, next, kSides + next}, {k, kSides + next, kSides + k}});
    if (k > 1) faces.insert(faces.end(), {{0, k, k - 1}, {kSides, kSides + k - 1, kSides + k}});
  }
  return makeMesh(points, faces);
}

TEST(SolidBand, KeepsARodThatNoDenseGridHolds) {
  constexpr double kLength = 4000.0, kRadius = 1.0;
  const Mesh rod = obliqueRod(kLength, kRadius);
  const RepairGrid grid = fitRepairGrid(rod);
  ASSERT_TRUE(grid.keepsThinnest());
  EXPECT_GT(grid.sampleCount(), size_t{1} << 32);
  EXPECT_NEAR(grid.surfaceCubes, 6.21 * kLength / (grid.spacing * grid.spacing), 0.02 * grid.surfaceCubes);
  const Repaired made = repair(rod, grid, {}, {.remesh = true});
  EXPECT_TRUE(made.report.after.watertight);
  EXPECT_EQ(made.report.crossingAfter.pairs, 0u);
  EXPECT_EQ(made.report.solids, 1u);
  const double volume = 3.0 * kRadius * kRadius * kLength;  // A section of twelve sides has an area of 3.
  EXPECT_NEAR(made.report.after.signedVolume, volume, 0.1 * volume);  // Two samples across.
  EXPECT_LT(made.report.meshFromResult.max, grid.spacing);
  EXPECT_EQ(made.report.lostShare, 0.0);
}

TEST(SolidBand, OfAGridIsBoundedByTheCubesAtTheSurface) {
  const Mesh rod = obliqueRod(4000.0, 1.0);
  EXPECT_TRUE(fitRepairGrid(rod, {}, {.shell = 2.0}).keepsThinnest());
  EXPECT_EQ(fitRepairGrid(rod, {}, {.shell = 1.5}).spacing, 0.75);
  EXPECT_EQ(fitRepairGrid(rod, {}, {.shell = 1.5, .drainHole = 1.4}).spacing, 0.7);
  const Mesh plate = shapes::box(glm::dvec3(0.0), glm::dvec3(400.0, 400.0, 1.0));
  EXPECT_EQ(fitRepairGrid(plate, {}, {.shell = 3.0}).spacing, 1.5);  // The walls, if the rest takes too many.
  EXPECT_FALSE(fitRepairGrid(plate, {}, {.shell = 3.0}).keepsThinnest());
  // It has two surfaces, and samples in its walls.
  EXPECT_FALSE(fitRepairGrid(rod, {}, {.shell = 4000.0}).keepsThinnest());
  EXPECT_FALSE(fitRepairGrid(rod, {}, {}, {.device = "vulkan"}).keepsThinnest());
  EXPECT_FALSE(fitRepairGrid(rod, {}, {}, {.memoryLimit = size_t{1} << 23}).keepsThinnest());
  // A wide plate as thin as the rod has too many cubes.
  EXPECT_FALSE(fitRepairGrid(shapes::box(glm::dvec3(0.0), glm::dvec3(4000.0, 4000.0, 2.0))).keepsThinnest());
}

}  // namespace
}  // namespace raymap
