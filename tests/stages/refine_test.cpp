#include "cpu/cells/refine.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <algorithm>
#include <numbers>

#include "cells.h"
#include "reference.h"

namespace raymap {

using namespace cpu;
namespace {

constexpr double kRounding = 2e-5;

struct Result {
  std::vector<CellLevel> levels;
  Buffer<float> distance;
  Buffer<uint32_t> triangle;
};

Result refine(const CellMesh& mesh, int reach) {
  Progress progress;
  Result result{.levels = nearestCells(mesh), .distance = {}, .triangle = {}};
  refineDistance(mesh, result.levels, reach, progress, result.distance, &result.triangle);
  return result;
}

double triangleDistance(const CellMesh& mesh, uint32_t t, const glm::dvec3& p) {
  return reference::triangleDistance(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
}

/// Returns the distance by its definition: to the triangles of the nearest cell and of all cells within
/// `reach` of it.
double definedDistance(const CellMesh& mesh, const CellLevel& level, size_t sample, int reach) {
  const CellLattice& cells = level.grid.cells;
  const glm::ivec3 nearest = cells.cell(level.nearestCell[sample]);
  double closest = INFINITY;
  for (size_t c = 0; c < cells.count(); ++c) {
    const glm::ivec3 apart = glm::abs(cells.cell(c) - nearest);
    if (std::max({apart.x, apart.y, apart.z}) > reach) continue;
    for (const uint32_t t : level.grid.list(c))
      closest = std::min(closest, triangleDistance(mesh, t, cells.centre(cells.cell(sample))));
  }
  return closest;
}

/// Returns the largest possible error, in samples, where the mesh lies in the box. Let d be the true distance
/// and c the cell of the closest point: at most sqrt(3)/2 from its centre. So the transform finds a cell q
/// with |p - q|^2 + f(q) <= (d + sqrt(3)/2)^2 + 3/4, and q holds a triangle at most |p - q| + sqrt(f(q))
/// away, which is largest where sqrt(f(q)) is: d + sqrt(3)/2 + sqrt(3)/2. On cells `size` times larger the
/// sample lies up to sqrt(3)/2 cells from the centre that the transform searched from, which counts twice.
double errorBound(const std::vector<CellLevel>& levels) {
  return levels.size() == 1 ? std::numbers::sqrt3 : 2.0 * std::numbers::sqrt3 * levels[1].grid.cells.size;
}

void expectAsDefined(const OwnCellMesh& mesh) {
  for (const int reach : {0, 1}) {
    const Result result = refine(mesh, reach);
    for (size_t s = 0; s < result.distance.size(); ++s) {
      const double expected = definedDistance(mesh, result.levels[0], s, reach);
      ASSERT_NEAR(result.distance[s], expected, kRounding) << "sample " << s << " reach " << reach;
      const glm::dvec3 p(CellLattice{mesh.dims}.cell(s));
      ASSERT_NEAR(triangleDistance(mesh, result.triangle[s], p), expected, kRounding) << s;
    }
  }
}

void expectWithinBounds(const OwnCellMesh& mesh) {
  const Mesh truth = mesh.asMesh();
  const Result cell = refine(mesh, 0), neighbours = refine(mesh, 1);
  double cellSum = 0.0, neighbourSum = 0.0;
  for (size_t s = 0; s < cell.distance.size(); s += 7) {
    const double expected = reference::distance(truth, glm::dvec3(CellLattice{mesh.dims}.cell(s)));
    const double cellError = cell.distance[s] - expected;
    const double neighbourError = neighbours.distance[s] - expected;
    ASSERT_GE(neighbourError, -kRounding * (1.0 + expected)) << "closer than any triangle";
    ASSERT_LE(neighbourError, cellError + kRounding * (1.0 + expected)) << s;
    ASSERT_LE(cellError, errorBound(cell.levels) + kRounding) << s;
    cellSum += cellError;
    neighbourSum += neighbourError;
  }
  EXPECT_LE(neighbourSum, cellSum);
}

TEST(Refine, IsTheDistanceToTheTrianglesOfTheNearestCell) {
  expectAsDefined(onGrid(shapes::sphere(1.0, 3), {.resolution = 14}));
  expectAsDefined(onGrid(shapes::soup(60, 5), {.resolution = 12}));
  expectAsDefined(onGrid(shapes::box({0, 0, 0}, {3, 1, 2}), {.resolution = 13}));
}

TEST(Refine, SearchesCrowdedCellsInTheirTree) {
  const Mesh tiny = shapes::joined(shapes::sphere(0.06, 3, {0.4, 0.5, 0.5}), shapes::soup(3, 1));
  expectAsDefined(onGrid(tiny, {.resolution = 10}));
}

TEST(Refine, ErrsByNoMoreThanTheTheorySays) {
  expectWithinBounds(onGrid(shapes::sphere(1.0, 4), {.resolution = 32}));
  expectWithinBounds(onGrid(shapes::torus(1.0, 0.3, 60, 30), {.resolution = 40}));
  expectWithinBounds(onGrid(shapes::soup(100, 2), {.resolution = 24}));
}

TEST(Refine, SeesTheMeshOutsideTheBox) {
  const Mesh torus = shapes::torus(1.0, 0.3, 60, 30), sphere = shapes::sphere(1.0, 3);
  const Box cutting{glm::dvec3(-0.4, -0.5, -0.3), glm::dvec3(0.9, 0.3, 0.5)};
  expectWithinBounds(onGrid(torus, {.resolution = 24, .box = cutting}));
  for (const Box& box :
       {Box{glm::dvec3(1.5, 0.0, 0.0), glm::dvec3(2.5, 1.0, 1.0)},
        Box{glm::dvec3(90.0, 0.0, 0.0), glm::dvec3(91.0, 1.0, 1.0)}, Box{glm::dvec3(-0.1), glm::dvec3(0.1)}})
    expectWithinBounds(onGrid(sphere, {.resolution = 16, .box = box}));
}

TEST(Refine, GivesTiesToTheLowestTriangle) {
  Mesh twice = shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(1.0, 2));
  const Result result = refine(onGrid(twice, {.resolution = 16}), 1);
  for (const uint32_t t : result.triangle) ASSERT_LT(t, twice.triangles.size() / 2);
}

TEST(Refine, StopsWhenCancelled) {
  const OwnCellMesh mesh = onGrid(shapes::sphere(1.0, 2), {.resolution = 16});
  const std::vector<CellLevel> levels = nearestCells(mesh);
  Progress progress([](std::string_view, double) { return false; });
  Buffer<float> distance;
  Buffer<uint32_t> triangle;
  EXPECT_THROW(refineDistance(mesh, levels, 1, progress, distance, &triangle), Error);
}

}  // namespace
}  // namespace raymap
