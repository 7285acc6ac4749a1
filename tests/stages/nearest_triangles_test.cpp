#include "cpu/points/nearest_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reference.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap::cpu {
namespace {

/// Points in cells, along the curve, with what `SortedPoints` refers to.
struct Curve {
  explicit Curve(std::vector<glm::vec3> given) {
    glm::vec3 high(-INFINITY);
    sorted.low = glm::vec3(INFINITY);
    for (const glm::vec3& p : given) {
      sorted.low = glm::min(sorted.low, p);
      high = glm::max(high, p);
    }
    const glm::vec3 size = high - sorted.low;
    sorted.side = 1.0001f * std::max({size.x, size.y, size.z});
    std::vector<std::pair<uint64_t, size_t>> keys;
    for (size_t i = 0; i < given.size(); ++i) {
      const glm::uvec3 place((given[i] - sorted.low) * (float(1 << kCurveBits) / sorted.side));
      uint64_t code = 0;
      for (int bit = 0; bit < kCurveBits; ++bit)
        for (int axis = 0; axis < 3; ++axis) code |= uint64_t(place[axis] >> bit & 1) << (3 * bit + axis);
      keys.emplace_back(code, i);
    }
    std::ranges::sort(keys);
    for (const auto& [code, i] : keys) {
      codes.push_back(code);
      points.push_back(given[i]);
    }
    sorted.points = points;
    sorted.codes = codes;
  }

  std::vector<glm::vec3> points;
  std::vector<uint64_t> codes;
  SortedPoints sorted;
};

std::vector<glm::vec3> randomPoints(const glm::ivec3& dims, size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> unit(-0.2f, 1.2f);
  std::vector<glm::vec3> points(count);
  for (glm::vec3& p : points) p = glm::vec3(unit(random), unit(random), unit(random)) * glm::vec3(dims);
  return points;
}

double distanceTo(const CellMesh& mesh, size_t t, const glm::vec3& p) {
  return reference::triangleDistance(p, mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
}

TEST(NearestTriangles, AreThoseOfBruteForce) {
  for (const Mesh& mesh : {shapes::soup(300, 2), shapes::torus(1.0, 0.3, 20, 10), shapes::sphere(1.0, 0)}) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    const CellMesh cells = cellMesh(mesh, grid);
    SurfaceTree tree;
    tree.build(cells);
    const Curve curve(randomPoints(cells.dims, 3000));
    std::vector<NearestTriangle> nearest(curve.points.size());
    findNearestTriangles(tree, curve.sorted, INFINITY, nearest);
    for (size_t i = 0; i < nearest.size(); ++i) {
      double exact = INFINITY;
      for (size_t t = 0; t < cells.triangles.size(); ++t)
        exact = std::min(exact, distanceTo(cells, t, curve.points[i]));
      ASSERT_NEAR(std::sqrt(nearest[i].squared), exact, 1e-5) << i;
      ASSERT_NEAR(distanceTo(cells, tree.triangleId(nearest[i].triangle), curve.points[i]), exact, 1e-5) << i;
    }
  }
}

TEST(NearestTriangles, TakeTheLowestOfEqualOnes) {
  // Twice the same faces: in the tree they lie side by side.
  const Mesh sphere = shapes::sphere(1.0, 3), mesh = shapes::joined(sphere, sphere);
  const CellMesh cells = cellMesh(mesh, fitGrid(mesh, {.resolution = 40}));
  SurfaceTree tree;
  tree.build(cells);
  const Curve curve(randomPoints(cells.dims, 2000));
  std::vector<NearestTriangle> all(curve.points.size());
  findNearestTriangles(tree, curve.sorted, INFINITY, all);
  for (size_t i = 0; i < all.size(); ++i) {
    const SortedPoints alone{curve.sorted.points.subspan(i, 1), curve.sorted.codes.subspan(i, 1),
                             curve.sorted.low, curve.sorted.side};
    NearestTriangle one{};
    findNearestTriangles(tree, alone, INFINITY, {&one, 1});
    ASSERT_EQ(one.triangle, all[i].triangle);
    ASSERT_EQ(one.squared, all[i].squared);
  }
}

TEST(NearestTriangles, AreTheSameForSparsePoints) {
  const Mesh sphere = shapes::sphere(1.0, 3);
  for (const Mesh& mesh : {shapes::joined(sphere, sphere), shapes::soup(300, 2),
                           shapes::box({0, 0, 0}, {1, 1, 1}), shapes::soup(1, 3)}) {
    const CellMesh cells = cellMesh(mesh, fitGrid(mesh, {.resolution = 40}));
    SurfaceTree tree;
    tree.build(cells);
    const Curve curve(randomPoints(cells.dims, 2000));
    SortedPoints sparse = curve.sorted;
    sparse.areSparse = true;
    std::vector<NearestTriangle> all(curve.points.size()), apart(curve.points.size()),
        close(curve.points.size());
    findNearestTriangles(tree, curve.sorted, INFINITY, all);
    findNearestTriangles(tree, sparse, INFINITY, apart);
    findNearestTriangles(tree, sparse, 2.5f, close);
    size_t none = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(apart[i].triangle, all[i].triangle);
      ASSERT_EQ(apart[i].squared, all[i].squared);
      const bool isFar = std::sqrt(all[i].squared) > 2.5f + 1e-3f;
      none += close[i].triangle == kNoTriangle ? 1 : 0;
      ASSERT_EQ(close[i].triangle, isFar ? kNoTriangle : all[i].triangle);
    }
    EXPECT_GT(none, 100u);
    EXPECT_LT(none, 2000u);
  }
}

TEST(NearestTriangles, AreSparseByTheNumberOfTriangles) {
  const Mesh mesh = shapes::sphere(1.0, 4);  // 5120 triangles
  SurfaceTree tree;
  tree.build(cellMesh(mesh, fitGrid(mesh, {.resolution = 40})));
  EXPECT_TRUE(areSparse(1, tree));
  EXPECT_TRUE(areSparse(600, tree));
  EXPECT_FALSE(areSparse(610, tree));
}

TEST(NearestTriangles, MayEndBeyondTheLargestDistance) {
  const Mesh mesh = shapes::sphere(1.0, 4);
  const CellMesh cells = cellMesh(mesh, fitGrid(mesh, {.resolution = 40}));
  SurfaceTree tree;
  tree.build(cells);
  const Curve curve(randomPoints(cells.dims, 5000));
  std::vector<NearestTriangle> all(curve.points.size()), close(curve.points.size());
  findNearestTriangles(tree, curve.sorted, INFINITY, all);
  findNearestTriangles(tree, curve.sorted, 3.0f, close);
  size_t none = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (close[i].triangle == kNoTriangle) {
      ++none;
      ASSERT_GT(std::sqrt(all[i].squared), 3.0f);
    } else {
      ASSERT_EQ(close[i].triangle, all[i].triangle);
    }
  }
  EXPECT_GT(none, 500u);
}

}  // namespace
}  // namespace raymap::cpu
