#include "cpu/winding.h"

#include <gtest/gtest.h>

#include <cstring>

#include "cpu/parallel.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {
namespace {

constexpr SignMode kModes[] = {SignMode::Rays, SignMode::Paths, SignMode::Evolution, SignMode::Harmonic};

Grid unitGrid(glm::ivec3 dims) {
  return {.dims = dims, .origin = glm::dvec3(0.0), .spacing = 1.0};
}

/// On a closed mesh every mode gives the whole number, at every sample off the surface.
void expectExact(const Mesh& mesh, const Grid& grid, size_t stride = 1) {
  for (const SignMode mode : kModes) {
    const WindingResult result = windingOf(mesh, grid, mode);
    EXPECT_EQ(result.summary.doubtfulShare, 0.0);
    EXPECT_EQ(countWrongSigns(mesh, grid, result.winding, stride), 0u) << "mode " << int(mode);
  }
}

/// The boundary of a set of unit cells, grown by `cell`: all vertices on samples, all faces through samples.
Mesh voxelMesh(const std::vector<glm::ivec3>& cells, int cell) {
  Mesh mesh;
  const auto filled = [&](glm::ivec3 c) { return std::find(cells.begin(), cells.end(), c) != cells.end(); };
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (const glm::ivec3& c : cells)
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        glm::ivec3 n(0), a(0), b(0);
        n[axis] = side ? 1 : -1;
        a[(axis + 1) % 3] = 1;
        b[(axis + 2) % 3] = 1;
        if (filled(c + n)) continue;
        if (!side) std::swap(a, b);
        glm::ivec3 corner = c;
        corner[axis] += side;
        const auto first = uint32_t(p.size());
        for (const glm::ivec3& q : {corner, corner + a, corner + a + b, corner + b})
          p.push_back(glm::dvec3(q * cell));
        t.insert(t.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
      }
  return makeMesh(p, std::move(t));
}

TEST(Winding, BoxesOnSamplesAndLatticeLines) {
  expectExact(shapes::box({2, 3, 4}, {9, 8, 7}), unitGrid({12, 11, 13}));
  expectExact(shapes::box({2.5, 3, 4.5}, {9, 8.5, 7}), unitGrid({12, 11, 13}));
  expectExact(shapes::box({0, 0, 0}, {11, 10, 12}), unitGrid({12, 11, 13}));
}

TEST(Winding, VoxelMeshes) {
  expectExact(voxelMesh({{1, 1, 1}, {2, 1, 1}, {2, 2, 1}, {3, 3, 1}, {3, 3, 2}, {1, 3, 3}}, 2),
              unitGrid({10, 10, 10}));
  expectExact(voxelMesh({{1, 1, 1}, {2, 2, 2}, {3, 1, 2}}, 3), unitGrid({14, 12, 13}));
}

TEST(Winding, RoundShapes) {
  const Mesh sphere = shapes::sphere(1.0, 3), torus = shapes::torus(1.0, 0.4, 40, 20);
  expectExact(sphere, fitGrid(sphere, {.resolution = 20}));
  expectExact(torus, fitGrid(torus, {.resolution = 24}));
  expectExact(sphere, {.dims = {30, 17, 9}, .origin = {-1.4, -0.8, -0.7}, .spacing = 0.1});
}

TEST(Winding, NestedOverlappingTouching) {
  const Mesh ball = shapes::sphere(4.0, 2, {6, 6, 6});
  expectExact(shapes::joined(ball, shapes::sphere(2.0, 2, {6, 6, 6})), unitGrid({12, 13, 14}));
  expectExact(shapes::joined(ball, shapes::sphere(4.0, 2, {9, 6, 6})), unitGrid({16, 13, 14}));
  expectExact(shapes::joined(shapes::box({1, 1, 1}, {4, 4, 4}), shapes::box({4, 1, 1}, {7, 4, 4})),
              unitGrid({9, 7, 7}));
}

TEST(Winding, BoxesThatCutTheMesh) {
  expectExact(shapes::sphere(5.0, 3, {3, 4, 5}), unitGrid({7, 6, 9}));
  expectExact(shapes::sphere(50.0, 3, {20, 4, 5}), unitGrid({5, 6, 7}));
}

TEST(Winding, FlippedOrientationNegates) {
  Mesh mesh = shapes::soup(200, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  for (const SignMode mode : kModes) {
    const Buffer<float> before = windingOf(mesh, grid, mode).winding;
    Mesh flipped = mesh;
    for (glm::uvec3& t : flipped.triangles) std::swap(t.y, t.z);
    const Buffer<float> after = windingOf(flipped, grid, mode).winding;
    for (size_t s = 0; s < before.size(); ++s)
      ASSERT_NEAR(before[s], -after[s], 1e-5) << "mode " << int(mode);
  }
}

TEST(Winding, SameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::soup(500, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  for (const SignMode mode : kModes) {
    Buffer<float> first;
    withThreads(1, [&] { first = windingOf(mesh, grid, mode).winding; });
    for (const int threads : {2, 8}) {
      Buffer<float> other;
      withThreads(threads, [&] { other = windingOf(mesh, grid, mode).winding; });
      EXPECT_EQ(0, std::memcmp(first.data(), other.data(), first.size() * sizeof(float)))
          << "mode " << int(mode);
    }
  }
}

}  // namespace
}  // namespace raymap
