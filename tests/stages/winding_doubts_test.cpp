#include "cpu/sign/winding_doubts.h"

#include <gtest/gtest.h>
#include <raymap/grid.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "broken_meshes.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {
namespace {

/// Crossings of one edge along each axis: that from sample (1, 1, 1) to the next, three times.
Crossings threeTimesAlong(int axis) {
  Crossings crossings;
  clearCrossings({3, 3, 3}, crossings);
  AxisCrossings& lines = crossings[size_t(axis)];
  lines.entries.resizeUninitialized(1);
  lines.entries[0] = {.index = 1, .signedCount = 3, .unsignedCount = 3};
  for (size_t line = 5; line < lines.starts.size(); ++line) lines.starts[line] = 1;  // After line 1 + 3 * 1.
  return crossings;
}

std::vector<uint32_t> doubtsOf(const Crossings& crossings, float at, float next, int axis, float gap,
                               float distance) {
  Buffer<float> winding(27), distances(27);
  std::ranges::fill(winding, 0.5f + gap);
  std::ranges::fill(distances, distance);
  winding[13] = at;
  winding[13 + std::array{1, 3, 9}[size_t(axis)]] = next;
  return findDoubts({3, 3, 3}, crossings, winding, distances, kFromFit, 0.5);
}

TEST(WindingDoubts, GrowWithTheLargestChangeAlongACrossedEdge) {
  for (int axis = 0; axis < 3; ++axis) {
    const Crossings crossings = threeTimesAlong(axis);
    // The field falls by 1 where 3 faces are crossed: it changes by 2. So 0.04 is six times as large.
    EXPECT_EQ(doubtsOf(crossings, 8.0f, 7.0f, axis, 0.239f, 20.0f).size(), 25u);
    EXPECT_EQ(doubtsOf(crossings, 8.0f, 7.0f, axis, 0.241f, 20.0f).size(), 0u);
    // It rises by 1.
    EXPECT_EQ(doubtsOf(crossings, 7.0f, 8.0f, axis, 0.479f, 20.0f).size(), 25u);
    EXPECT_EQ(doubtsOf(crossings, 7.0f, 8.0f, axis, 0.481f, 20.0f).size(), 0u);
    // The field follows the crossings, but for a third: not less than the bound itself.
    EXPECT_EQ(doubtsOf(crossings, 10.0f, 7.1f, axis, 0.039f, 20.0f).size(), 25u);
    EXPECT_EQ(doubtsOf(crossings, 10.0f, 7.1f, axis, 0.041f, 20.0f).size(), 0u);
    // Changes along edges that are not crossed do not count.
    EXPECT_EQ(doubtsOf(crossings, 9.0f, 6.0f, axis, 0.041f, 20.0f).size(), 0u);
  }
}

TEST(WindingDoubts, GrowNearTheSurface) {
  Crossings none;
  clearCrossings({3, 3, 3}, none);
  const auto of = [&](float gap, float distance) {
    return doubtsOf(none, 9.0f, 9.0f, 0, gap, distance).size();
  };
  EXPECT_EQ(of(0.299f, 0.5f), 25u);
  EXPECT_EQ(of(0.301f, 0.5f), 0u);
  EXPECT_EQ(of(0.099f, 3.0f), 25u);
  EXPECT_EQ(of(0.101f, 3.0f), 0u);
}

/// Numbers of the mesh on a grid of this resolution whose default sign is not the exact one.
size_t countOtherSigns(const Mesh& mesh, int resolution) {
  const Grid grid = fitGrid(mesh, {.resolution = resolution});
  const Buffer<float> ours = windingOf(mesh, grid, SignMode::Harmonic).winding,
                      exact = windingOf(mesh, grid, SignMode::Exact).winding;
  size_t other = 0;
  for (size_t s = 0; s < ours.size(); ++s)
    other += (std::abs(ours[s]) > 0.5f) != (std::abs(exact[s]) > 0.5f) ? 1 : 0;
  return other;
}

TEST(WindingDoubts, LeaveNoWrongSignWhereAnEdgeCountsOften) {
  // A box, and 60 faces on one of its edges.
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(0.0, 6.28), along(0.0, 1.0);
  for (int i = 0; i < 60; ++i) {
    const double a = angle(random);
    const std::vector<glm::dvec3> corners{
        {1, 0, 1}, {1, 1, 1}, {1 + 0.7 * std::cos(a), along(random), 1 + 0.7 * std::sin(a)}};
    mesh = shapes::joined(mesh, makeMesh(corners, {{0, 1, 2}}));
  }
  for (const int resolution : {16, 24, 33}) EXPECT_EQ(countOtherSigns(mesh, resolution), 0u) << resolution;
}

TEST(WindingDoubts, LeaveNoWrongSignInSoups) {
  for (const int triangles : {300, 1600}) EXPECT_EQ(countOtherSigns(shapes::soup(triangles, 5), 24), 0u);
}

TEST(WindingDoubts, LeaveNoWrongSignBetweenManyLayers) {
  EXPECT_EQ(countOtherSigns(nearlyEqualShells(40, 2), 20), 0u);
}

TEST(WindingDoubts, LeaveNoWrongSignWhereFacesAreMissingOrTurned) {
  const Mesh torus = shapes::torus(1.0, 0.4, 60, 30);
  for (const Mesh& mesh : {withMissingFaces(torus, 0.5, 7), withFlippedFaces(torus, 0.2, 7)})
    EXPECT_EQ(countOtherSigns(mesh, 32), 0u);
}

}  // namespace
}  // namespace raymap
