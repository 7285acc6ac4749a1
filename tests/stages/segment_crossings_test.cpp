#include "cpu/points/segment_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cpu/points/face_crossings.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap::cpu {
namespace {

constexpr float kSlack = 1e-5f;

/// A mesh in cell units, and its tree.
struct Scene {
  explicit Scene(Mesh given) : mesh(std::move(given)), grid(fitGrid(mesh, {.resolution = 40})) {
    cells = cellMesh(mesh, grid);
    tree.build(cells);
  }

  int32_t exactly(const glm::vec3& from, const glm::vec3& to) const {
    std::vector<uint32_t> faces(cells.triangles.size());
    for (uint32_t f = 0; f < faces.size(); ++f) faces[f] = f;
    return countFaceCrossings(PackedMesh(cells.vertices, cells.triangles, {}), {}, faces, from, to);
  }

  Mesh mesh;
  Grid grid;
  CellMesh cells;  // refers to the mesh
  SurfaceTree tree;
};

std::vector<glm::vec3> randomPoints(const Grid& grid, size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<glm::vec3> points(count);
  for (glm::vec3& p : points) p = glm::vec3(unit(random), unit(random), unit(random)) * glm::vec3(grid.dims);
  return points;
}

TEST(SegmentCrossings, AreThoseOfDoublePrecision) {
  for (const Mesh& mesh : {shapes::soup(500, 1), shapes::torus(1.0, 0.3, 30, 15), shapes::sphere(1.0, 0)}) {
    const Scene scene(mesh);
    const std::vector<glm::vec3> ends = randomPoints(scene.grid, 400, 1);
    size_t unsure = 0, crossed = 0;
    for (const glm::vec3& from : randomPoints(scene.grid, 5, 2)) {
      std::vector<int32_t> changes(ends.size());
      countCrossings(scene.tree, from, ends, kSlack, changes);
      for (size_t i = 0; i < ends.size(); ++i) {
        unsure += changes[i] == kUnsure;
        crossed += changes[i] != 0;
        if (changes[i] != kUnsure) {
          ASSERT_EQ(changes[i], scene.exactly(from, ends[i])) << i;
        }
      }
    }
    EXPECT_LT(unsure, 100u);
    EXPECT_GT(crossed, 100u);
  }
}

TEST(SegmentCrossings, AreUnsureWhereRoundingDecides) {
  const Scene scene(makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}));
  const auto changeOf = [&](const glm::dvec3& from, const glm::dvec3& to) {
    const auto cell = [&](const glm::dvec3& p) {
      return glm::vec3((p - scene.grid.origin) / scene.grid.spacing);
    };
    const glm::vec3 end = cell(to);
    int32_t change = 0;
    countCrossings(scene.tree, cell(from), {&end, 1}, kSlack, {&change, 1});
    return change;
  };
  EXPECT_EQ(changeOf({1, 1, 1}, {1, 1, -1}), 1);
  EXPECT_EQ(changeOf({1, 1, -1}, {1, 1, 1}), -1);
  EXPECT_EQ(changeOf({1, 1, 1}, {1, 1, 0}), kUnsure);
  EXPECT_EQ(changeOf({1, 1, 1e-6}, {1, 1, -1}), kUnsure);
  EXPECT_EQ(changeOf({1, 0, 1}, {1, 0, -1}), kUnsure);
  EXPECT_EQ(changeOf({2.000001, 2, 1}, {2.000001, 2, -1}), kUnsure);
  EXPECT_EQ(changeOf({1, -0.01, 1}, {1, -0.01, -1}), 0);
  EXPECT_EQ(changeOf({1, 1, 1}, {1, 1, 0.001}), 0);
}

TEST(SegmentCrossings, FindAllTrianglesAlong) {
  const Scene scene(shapes::torus(1.0, 0.3, 30, 15));
  const auto count = static_cast<uint32_t>(scene.cells.triangles.size());
  const std::vector<glm::vec3> points = randomPoints(scene.grid, 40, 4);
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    std::vector<uint32_t> found;
    findTrianglesAlong(scene.tree, points[i], points[i + 1], kSlack, found);
    EXPECT_LT(found.size(), count / 2);
    for (uint32_t& t : found) {
      ASSERT_LT(t, count);
      t = scene.tree.triangleId(t);
    }
    const PackedMesh mesh(scene.cells.vertices, scene.cells.triangles, {});
    for (uint32_t f = 0; f < count; ++f) {
      if (countFaceCrossings(mesh, {}, {&f, 1}, points[i], points[i + 1]) != 0) {
        ASSERT_NE(std::ranges::find(found, f), found.end()) << f;
      }
    }
  }
}

TEST(SegmentCrossings, FindTheSameTrianglesAlongManySegments) {
  const Scene scene(shapes::torus(1.0, 0.3, 60, 30));
  std::vector<glm::vec3> from, to;
  for (size_t v = 0; v < scene.cells.vertices.size(); v += 100)
    for (int i = 0; i < 90; ++i) {  // More than share a search, and some far from the one before.
      from.push_back(scene.cells.vertices[v] + glm::vec3(0.05f * float(i), 0.03f * float(i % 7), 0.3f));
      to.push_back(from.back() + glm::vec3(0.5f, -1.0f, -1.5f));
    }
  TrianglesAlong found;
  findTrianglesAlong(scene.tree, from, to, kSlack, found);
  ASSERT_EQ(found.begins.size(), from.size() + 1);
  size_t all = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    std::vector<uint32_t> expected, each(found[i].begin(), found[i].end());
    findTrianglesAlong(scene.tree, from[i], to[i], kSlack, expected);
    std::ranges::sort(expected);
    std::ranges::sort(each);
    ASSERT_EQ(each, expected) << i;
    all += each.size();
  }
  EXPECT_GT(all, 100u);
}

}  // namespace
}  // namespace raymap::cpu
