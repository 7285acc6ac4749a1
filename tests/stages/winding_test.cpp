#include "cpu/sign/winding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

constexpr SignMode kModes[] = {SignMode::Rays, SignMode::Ray, SignMode::Paths, SignMode::Evolution,
                               SignMode::Harmonic};

Grid unitGrid(glm::ivec3 dims) {
  return {.dims = dims, .origin = glm::dvec3(0.0), .spacing = 1.0};
}

/// Checks that every mode gives the exact whole number on a closed mesh, at every sample off the surface.
void expectExact(const Mesh& mesh, const Grid& grid, size_t stride = 1) {
  for (const SignMode mode : kModes) {
    const WindingResult result = windingOf(mesh, grid, mode);
    EXPECT_EQ(result.doubtfulShare, 0.0);
    EXPECT_EQ(countWrongSigns(mesh, grid, result.winding, stride), 0u) << "mode " << int(mode);
  }
}

TEST(Winding, BoxesOnSamplesAndLatticeLines) {
  expectExact(shapes::box({2, 3, 4}, {9, 8, 7}), unitGrid({12, 11, 13}));
  expectExact(shapes::box({2.5, 3, 4.5}, {9, 8.5, 7}), unitGrid({12, 11, 13}));
  expectExact(shapes::box({0, 0, 0}, {11, 10, 12}), unitGrid({12, 11, 13}));
}

TEST(Winding, VoxelMeshes) {
  expectExact(shapes::voxels({{1, 1, 1}, {2, 1, 1}, {2, 2, 1}, {3, 3, 1}, {3, 3, 2}, {1, 3, 3}}, 2),
              unitGrid({10, 10, 10}));
  expectExact(shapes::voxels({{1, 1, 1}, {2, 2, 2}, {3, 1, 2}}, 3), unitGrid({14, 12, 13}));
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
      ASSERT_NEAR(before[s], -after[s], 1e-4) << "mode " << int(mode);
  }
}

TEST(Winding, SameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::soup(500, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  for (const SignMode mode : kModes)
    for (const Sampling sampling : {Sampling::Spread, Sampling::Paper}) {
      const FieldOptions options{.sign = mode, .orientation = Orientation::Keep, .sampling = sampling};
      Buffer<float> first;
      withThreads(1, [&] { first = windingOf(mesh, grid, options).winding; });
      for (const int threads : {2, 8}) {
        Buffer<float> other;
        withThreads(threads, [&] { other = windingOf(mesh, grid, options).winding; });
        EXPECT_EQ(0, std::memcmp(first.data(), other.data(), first.size() * sizeof(float)))
            << "mode " << int(mode) << ", sampling " << int(sampling);
      }
    }
}

// One thread: with several, a report may overtake another.
TEST(Winding, ReportsHowFarItIs) {
  const Mesh mesh = shapes::soup(300, 5);
  const Grid grid = fitGrid(mesh, {.resolution = 64});
  for (const SignMode mode : kModes) {
    std::vector<double> shares;
    MachineOptions machine{.device = "cpu", .threads = 1};
    machine.progress = [&](std::string_view stage, double done) {
      if (stage == "winding") shares.push_back(done);
      return true;
    };
    windingOf(mesh, grid, {.sign = mode, .orientation = Orientation::Keep}, machine);
    ASSERT_GT(shares.size(), 20u) << "mode " << int(mode);
    EXPECT_EQ(shares.front(), 0.0);
    EXPECT_GT(shares.back(), 0.95) << "mode " << int(mode);
    EXPECT_LE(shares.back(), 1.0) << "mode " << int(mode);
    for (size_t r = 1; r < shares.size(); ++r) {
      EXPECT_GE(shares[r], shares[r - 1]) << "mode " << int(mode);
      EXPECT_LT(shares[r] - shares[r - 1], 0.2) << "mode " << int(mode);
    }
  }
}

struct Deviation {
  double wrongSigns = 0.0;  ///< As a share of the samples.
  double meanError = 0.0;
};

Deviation deviationOf(const Mesh& mesh, const Grid& grid, SignMode mode) {
  const Buffer<float> winding = windingOf(mesh, grid, mode).winding;
  Deviation sum;
  for (size_t s = 0; s < winding.size(); ++s) {
    const size_t nx = size_t(grid.dims.x), ny = size_t(grid.dims.y);
    const glm::dvec3 at(double(s % nx), double(s / nx % ny), double(s / nx / ny));
    const double exact = reference::windingNumber(mesh, grid.position(at));
    sum.wrongSigns += (std::abs(exact) > 0.5) != (std::abs(winding[s]) > 0.5);
    sum.meanError += std::abs(exact - winding[s]);
  }
  return {sum.wrongSigns / double(winding.size()), sum.meanError / double(winding.size())};
}

TEST(Winding, NearTheGeneralizedNumberOnASphereWithAHole) {
  const glm::dvec3 hole = glm::normalize(glm::dvec3(0.4, -0.3, 0.8));
  Mesh mesh = shapes::sphere(1.0, 3);
  std::erase_if(mesh.triangles,
                [&](const glm::uvec3& t) { return glm::dot(mesh.position(t.x), hole) > 0.9; });
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  const Deviation rays = deviationOf(mesh, grid, SignMode::Rays);
  const Deviation harmonic = deviationOf(mesh, grid, SignMode::Harmonic);
  EXPECT_LT(rays.wrongSigns, 0.01);
  EXPECT_LT(deviationOf(mesh, grid, SignMode::Paths).wrongSigns, 0.01);
  EXPECT_LT(deviationOf(mesh, grid, SignMode::Evolution).wrongSigns, 0.01);
  EXPECT_LT(harmonic.wrongSigns, 0.001);
  EXPECT_LT(harmonic.meanError, 0.005);
  EXPECT_LT(harmonic.meanError, 0.25 * rays.meanError);
}

TEST(Winding, NearTheGeneralizedNumberWithAFifthOfTheFacesMissing) {
  Mesh mesh = shapes::sphere(1.0, 3);
  std::mt19937 random(11);
  std::erase_if(mesh.triangles, [&](const glm::uvec3&) { return random() % 5 == 0; });
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  EXPECT_LT(deviationOf(mesh, grid, SignMode::Rays).wrongSigns, 0.04);
  EXPECT_LT(deviationOf(mesh, grid, SignMode::Paths).wrongSigns, 0.02);
  EXPECT_LT(deviationOf(mesh, grid, SignMode::Evolution).wrongSigns, 0.02);
  const Deviation harmonic = deviationOf(mesh, grid, SignMode::Harmonic);
  EXPECT_LT(harmonic.wrongSigns, 0.004);
  EXPECT_LT(harmonic.meanError, 0.03);
}

TEST(Winding, TheOrderOfTrianglesDoesNotMatter) {
  const Mesh mesh = shapes::soup(300, 9);
  Mesh reversed = mesh;
  std::reverse(reversed.triangles.begin(), reversed.triangles.end());
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  for (const SignMode mode : kModes) {
    const Buffer<float> a = windingOf(mesh, grid, mode).winding, b = windingOf(reversed, grid, mode).winding;
    EXPECT_EQ(0, std::memcmp(a.data(), b.data(), a.size() * sizeof(float))) << "mode " << int(mode);
  }
}

TEST(Winding, AnOffsetOfZeroAddsNothingToTheRays) {
  const Mesh mesh = shapes::soup(100, 9);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  FieldOptions options;
  options.offsets = {{0, 0, 0}};
  options.sign = SignMode::Rays;
  const Buffer<float> rays = windingOf(mesh, grid, options).winding;
  for (const SignMode mode : {SignMode::Paths, SignMode::Evolution}) {
    options.sign = mode;
    const Buffer<float> same = windingOf(mesh, grid, options).winding;
    for (size_t s = 0; s < rays.size(); ++s) ASSERT_NEAR(rays[s], same[s], 1e-4f);
  }
}

TEST(Winding, OffsetsBeyondTheGridEndAtZero) {
  // Every path from far outside is a ray: Eq. 6 counts the crossings in between.
  const Mesh mesh = shapes::soup(40, 2);
  const Grid grid = fitGrid(mesh, {.resolution = 12});
  const RayMap map = rayMapOf(mesh, grid);
  FieldOptions options;
  options.sign = SignMode::Paths;
  options.passes = 1;
  options.offsets = {{1000000000, 0, 0}};
  const Buffer<float> winding = windingOf(mesh, grid, options).winding;
  options.sign = SignMode::Rays;
  const Buffer<float> rays = windingOf(mesh, grid, options).winding;
  for (int i = 0; i < grid.dims.x; ++i) {
    const glm::ivec3 s(i, 5, 6);
    const double expected = (6.0 * rays[grid.index(s)] + 36.0 * map.ray(0, s)) / 42.0;
    EXPECT_NEAR(winding[grid.index(s)], expected, 1e-4);
  }
}

TEST(Winding, ThinGrids) {
  const Mesh closed = shapes::sphere(3.0, 3, {4, 4, 4});
  const Mesh open = shapes::soup(200, 4);
  for (const glm::ivec3 dims :
       {glm::ivec3(1, 1, 1), glm::ivec3(1, 9, 9), glm::ivec3(9, 1, 2), glm::ivec3(2, 2, 9)}) {
    const Grid grid{.dims = dims, .origin = glm::dvec3(4, 4, 4) - 0.5 * glm::dvec3(dims - 1), .spacing = 1.0};
    expectExact(closed, grid);
    const Grid inSoup{.dims = dims, .origin = glm::dvec3(0.05), .spacing = 0.1};
    for (const SignMode mode : kModes)
      for (const float w : windingOf(open, inSoup, mode).winding) ASSERT_LT(std::abs(w), 100.0f);
  }
}

}  // namespace
}  // namespace raymap
