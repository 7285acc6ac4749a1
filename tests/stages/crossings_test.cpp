#include "cpu/sign/crossings.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

Grid unitGrid(int nx, int ny, int nz) {
  return {.dims = {nx, ny, nz}, .origin = glm::dvec3(0.0), .spacing = 1.0};
}

std::span<const Crossing> lineOf(const AxisCrossings& axis, size_t line) {
  return {axis.entries.data() + axis.starts[line], size_t(axis.starts[line + 1] - axis.starts[line])};
}

/// Checks that every line enters as often as it leaves.
void expectNoLeak(const Crossings& crossings) {
  for (int axis = 0; axis < 3; ++axis)
    for (size_t line = 0; line + 1 < crossings[axis].starts.size(); ++line) {
      int sum = 0;
      for (const Crossing& c : lineOf(crossings[axis], line)) sum += c.signedCount;
      ASSERT_EQ(sum, 0) << "axis " << axis << " line " << line;
    }
}

TEST(Crossings, ChangeToThoseOfOtherFaces) {
  const Mesh before = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(before, {.resolution = 20});
  Mesh after = before;
  const auto reverse = [](const glm::uvec3& face) { return glm::uvec3(face.x, face.z, face.y); };
  ChangedFaces changed;
  for (size_t f = 0; f < 600; ++f) {
    if (f % 2 == 0)
      changed.reversed.push_back(reverse(before.triangles[f]));
    else
      changed.removed.push_back(before.triangles[f]);
  }
  for (size_t f = 600; f < 700; ++f) changed.added.push_back(reverse(before.triangles[f]));
  after.triangles.erase(after.triangles.begin(), after.triangles.begin() + 600);
  for (const auto* faces : {&changed.reversed, &changed.added})
    after.triangles.insert(after.triangles.end(), faces->begin(), faces->end());
  Crossings crossings = crossingsOf(before, grid);
  const Crossings expected = crossingsOf(after, grid);
  Progress progress;
  changeCrossings(cellMesh(after, grid), changed, progress, crossings);
  for (size_t axis = 0; axis < 3; ++axis) {
    ASSERT_TRUE(std::ranges::equal(crossings[axis].starts, expected[axis].starts)) << axis;
    for (size_t e = 0; e < expected[axis].entries.size(); ++e) {
      const Crossing &found = crossings[axis].entries[e], &wanted = expected[axis].entries[e];
      ASSERT_EQ(found.index, wanted.index) << axis << " " << e;
      ASSERT_EQ(found.signedCount, wanted.signedCount) << axis << " " << e;
      ASSERT_EQ(found.unsignedCount, wanted.unsignedCount) << axis << " " << e;
    }
  }
}

TEST(Crossings, CountsOneFaceOnceWithItsDirection) {
  // A triangle facing +z, between samples 2 and 3 of the lines along z.
  const Mesh mesh =
      makeMesh(std::vector<glm::dvec3>{{0.5, 0.5, 2.4}, {4.5, 0.5, 2.4}, {0.5, 4.5, 2.4}}, {{0, 1, 2}});
  const Crossings crossings = crossingsOf(mesh, unitGrid(6, 6, 6));
  EXPECT_TRUE(crossings[0].entries.empty());
  EXPECT_TRUE(crossings[1].entries.empty());
  const auto line = lineOf(crossings[2], 1 * 6 + 1);
  ASSERT_EQ(line.size(), 1u);
  EXPECT_EQ(line[0].index, 2);
  EXPECT_EQ(line[0].signedCount, 1);
  EXPECT_EQ(line[0].unsignedCount, 1);
  EXPECT_TRUE(lineOf(crossings[2], 4 * 6 + 4).empty());
}

TEST(Crossings, AddsUpWhatLiesBetweenTheSameSamples) {
  const Mesh sheet = makeMesh(
      std::vector<glm::dvec3>{
          {-9, -9, 2.4}, {19, -9, 2.4}, {-9, 19, 2.4}, {-9, -9, 2.6}, {-9, 19, 2.6}, {19, -9, 2.6}},
      {{0, 1, 2}, {3, 4, 5}, {3, 4, 5}});
  const auto crossings = crossingsOf(sheet, unitGrid(4, 4, 4));
  const auto line = lineOf(crossings[2], 0);
  ASSERT_EQ(line.size(), 1u);
  EXPECT_EQ(line[0].signedCount, 1 - 2);
  EXPECT_EQ(line[0].unsignedCount, 3);
}

TEST(Crossings, KeepsWhatTheGridDoesNotCover) {
  const auto crossings = crossingsOf(shapes::box({-50, -50, -50}, {50, 50, 50}), unitGrid(5, 4, 3));
  const auto line = lineOf(crossings[0], 0);
  ASSERT_EQ(line.size(), 2u);
  EXPECT_EQ(line[0].index, -1);
  EXPECT_EQ(line[0].signedCount, -1);
  EXPECT_EQ(line[1].index, 4);
  EXPECT_EQ(line[1].signedCount, 1);
}

TEST(Crossings, AreClosedOnLatticeLinesSamplesAndEdges) {
  // Faces pass through samples, edges and diagonals lie along lattice lines, vertices on samples.
  expectNoLeak(crossingsOf(shapes::box({1, 2, 3}, {6, 5, 7}), unitGrid(9, 9, 9)));
  expectNoLeak(crossingsOf(shapes::box({0, 0, 0}, {8, 8, 8}), unitGrid(9, 9, 9)));
  expectNoLeak(crossingsOf(shapes::sphere(4.0, 3, {4, 4, 4}), unitGrid(9, 9, 9)));
  std::vector<glm::dvec3> p{{4, 4, 8}, {4, 4, 0}, {8, 4, 4}, {4, 8, 4}, {0, 4, 4}, {4, 0, 4}};
  expectNoLeak(crossingsOf(
      makeMesh(p, {{0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 2}, {1, 3, 2}, {1, 4, 3}, {1, 5, 4}, {1, 2, 5}}),
      unitGrid(9, 9, 9)));
}

TEST(Crossings, HugeTrianglesUseWideIntegersAndStillAgree) {
  // Extents of a few cells, of more than 2^10 and of more than 2^20 cells: three arithmetic ranges.
  for (const double size : {3.3, 3000.7, 5e6, 3e9}) {
    const glm::dvec3 low(-0.37 * size, -0.41 * size, -0.53 * size);
    expectNoLeak(crossingsOf(shapes::box(low, low + glm::dvec3(size)), unitGrid(7, 6, 5)));
    expectNoLeak(crossingsOf(shapes::sphere(size, 2, {1, 2, 3}), unitGrid(7, 6, 5)));
  }
}

TEST(Crossings, ManyScalesAgreeWithEachOther) {
  for (const double scale : {1.0, 4.0, 1024.0}) {
    const auto near = crossingsOf(shapes::box({0.5, 0.5, 0.5}, {4.5, 4.5, 4.5}), unitGrid(6, 6, 6));
    Mesh far = shapes::box({0.5, 0.5, 0.5}, {4.5, 4.5, 4.5});
    // A single far triangle beside the grid makes all arithmetic wide and changes nothing else.
    far = shapes::joined(
        far, makeMesh(std::vector<glm::dvec3>{{900 * scale, 7, 7}, {901 * scale, 7, 8}, {901 * scale, 9, 7}},
                      {{0, 1, 2}}));
    const auto wide = crossingsOf(far, unitGrid(6, 6, 6));
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(near[axis].entries.size(), wide[axis].entries.size());
      for (size_t e = 0; e < near[axis].entries.size(); ++e)
        EXPECT_EQ(near[axis].entries[e].index, wide[axis].entries[e].index);
    }
  }
}

TEST(Crossings, DegenerateTrianglesCrossNothing) {
  const Mesh mesh = makeMesh(std::vector<glm::dvec3>{{1, 1, 1}, {3, 3, 3}, {5, 5, 5}, {1, 1, 1}, {2, 5, 3}},
                             {{0, 1, 2}, {0, 3, 4}, {4, 4, 4}});
  const auto crossings = crossingsOf(mesh, unitGrid(7, 7, 7));
  for (const auto& axis : crossings) EXPECT_TRUE(axis.entries.empty());
}

TEST(Crossings, RefusesVerticesTooFarAway) {
  const Mesh mesh = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {1e30, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  try {
    crossingsOf(mesh, unitGrid(4, 4, 4));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    EXPECT_NE(std::string(error.what()).find("triangle 0"), std::string::npos) << error.what();
  }
}

TEST(Crossings, MergesMoreCrossingsThanFitIntoOneRound) {
  // 200 sheets over 256 x 256 lines: 13 million crossings, at most 17 distinct ones per line.
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (uint32_t sheet = 0; sheet < 200; ++sheet) {
    const double z = 0.25 + 0.0799 * sheet;
    for (const glm::dvec3& corner :
         {glm::dvec3(-600, -600, z), glm::dvec3(1200, -600, z), glm::dvec3(-600, 1200, z)})
      p.push_back(corner);
    t.emplace_back(3 * sheet, 3 * sheet + 1, 3 * sheet + 2);
  }
  const auto crossings = crossingsOf(makeMesh(p, std::move(t)), unitGrid(256, 256, 16));
  EXPECT_TRUE(crossings[0].entries.empty());
  for (size_t line = 0; line < 256 * 256; ++line) {
    int sum = 0;
    for (const Crossing& c : lineOf(crossings[2], line)) sum += c.signedCount;
    ASSERT_EQ(sum, 200);
    ASSERT_EQ(lineOf(crossings[2], line).size(), 16u);
  }
}

TEST(Crossings, SameForAnyNumberOfThreadsAndOrder) {
  const Mesh mesh = shapes::soup(20000, 7);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  Mesh reversed = mesh;
  std::reverse(reversed.triangles.begin(), reversed.triangles.end());
  Crossings first;
  withThreads(1, [&] { first = crossingsOf(mesh, grid); });
  for (const int threads : {1, 2, 8}) {
    Crossings other;
    withThreads(threads, [&] { other = crossingsOf(threads == 1 ? reversed : mesh, grid); });
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(first[axis].entries.size(), other[axis].entries.size());
      EXPECT_EQ(0, std::memcmp(first[axis].starts.data(), other[axis].starts.data(),
                               first[axis].starts.size() * sizeof(uint64_t)));
      EXPECT_EQ(0, std::memcmp(first[axis].entries.data(), other[axis].entries.data(),
                               first[axis].entries.size() * sizeof(Crossing)));
    }
  }
}

}  // namespace
}  // namespace raymap
