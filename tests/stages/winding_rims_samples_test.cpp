#include "cpu/sign/winding_rims_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "broken_meshes.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {
namespace {

/// Two triangles, a sphere with holes, and a box without its top, whose edges lie on lattice lines of
/// `boxGrid`.
Mesh sheet() {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {1, 0.1, 0.2}, {0.2, 1, 0.1}, {0.9, 0.8, 0.5}};
  return makeMesh(corners, {{0, 1, 2}, {2, 1, 3}});
}

Mesh openBox() {
  Mesh box = shapes::box({4, 4, 4}, {28, 20, 24});
  std::erase_if(box.triangles, [&](const glm::uvec3& t) {
    return box.position(t.x).z > 23 && box.position(t.y).z > 23 && box.position(t.z).z > 23;
  });
  return box;
}

constexpr Grid boxGrid() {
  return {.dims = {33, 25, 29}, .origin = glm::dvec3(0.0), .spacing = 1.0};
}

struct Numbers {
  RimLattices lattices;
  Buffer<float> winding;
};

Numbers numbersOf(const Mesh& mesh, const Grid& grid) {
  Numbers result{.lattices = findRimLattices(mesh, grid)};
  result.winding.resizeUninitialized(grid.sampleCount());
  Progress progress;
  HarmonicScratch scratch;
  computeFromRims(rayMapOf(mesh, grid), result.lattices, progress, 0.0, scratch, result.winding);
  return result;
}

double exactNumber(const Mesh& mesh, const Grid& grid, size_t sample) {
  return reference::windingNumber(mesh, samplePosition(grid, sample));
}

TEST(WindingRimsSamples, AreExactWhereTheyAreComputed) {
  for (const Mesh& mesh : {sheet(), withHoles(shapes::sphere(1.0, 3), 3, 0.08, 1)}) {
    const Grid grid = fitGrid(mesh, {.resolution = 60});
    const Numbers numbers = numbersOf(mesh, grid);
    ASSERT_TRUE(numbers.lattices.haveAll());
    for (const uint32_t s : numbers.lattices.computed[0]) {
      if (reference::distance(mesh, samplePosition(grid, s)) < 1e-6) continue;
      ASSERT_NEAR(numbers.winding[s], exactNumber(mesh, grid, s), 4e-6);
    }
  }
}

TEST(WindingRimsSamples, KeepToTheBoundWhereTheyAreInterpolated) {
  for (const Mesh& mesh : {sheet(), withHoles(shapes::sphere(1.0, 3), 3, 0.08, 1)}) {
    const Grid grid = fitGrid(mesh, {.resolution = 60});
    const Numbers numbers = numbersOf(mesh, grid);
    double largest = 0.0;
    for (size_t s = 0; s < numbers.winding.size(); s += 7) {
      const double distance = reference::distance(mesh, samplePosition(grid, s)) / grid.spacing;
      if (distance < 1e-4) continue;
      const double error = std::abs(numbers.winding[s] - exactNumber(mesh, grid, s));
      ASSERT_LT(error, double(numberError(kFromRims, float(distance)))) << "sample " << s << ", " << distance;
      largest = std::max(largest, error);
    }
    EXPECT_GT(largest, 1e-3);
  }
}

TEST(WindingRimsSamples, AreRightWhereRaysMeetRims) {
  const Mesh mesh = openBox();
  const Numbers numbers = numbersOf(mesh, boxGrid());
  ASSERT_TRUE(numbers.lattices.haveAll());
  for (const uint32_t s : numbers.lattices.computed[0]) {
    if (reference::distance(mesh, samplePosition(boxGrid(), s)) < 1e-6) continue;
    ASSERT_NEAR(numbers.winding[s], exactNumber(mesh, boxGrid(), s), 4e-6) << s;
  }
}

TEST(WindingRimsSamples, OnRimsAreThoseOfNeighbours) {
  const Mesh mesh = openBox();
  const Numbers numbers = numbersOf(mesh, boxGrid());
  size_t onRims = 0;
  for (const uint32_t s : numbers.lattices.computed[0]) {
    const glm::dvec3 p = samplePosition(boxGrid(), s);
    double nearest = INFINITY;
    for (const RimLine& rim : numbers.lattices.rims)
      nearest = std::min(nearest, reference::segmentDistance(p, rim.from, rim.to));
    if (nearest > 0.0) continue;
    ++onRims;
    // Around a rim, the number passes through all values between those beside the wall: 1 - 1/4 and -1/4.
    ASSERT_GT(numbers.winding[s], -0.26f) << s;
    ASSERT_LT(numbers.winding[s], 0.76f) << s;
  }
  EXPECT_GT(onRims, 50u);
}

TEST(WindingRimsSamples, DecideSignsNearTheThreshold) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 3), 4, 0.12, 5);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  const RayMap map = rayMapOf(mesh, grid);
  Buffer<float> winding(grid.sampleCount());
  std::fill(winding.begin(), winding.end(), 0.45f);
  std::vector<uint32_t> samples(winding.size() - 1);
  std::iota(samples.begin(), samples.end(), 1u);
  Progress progress;
  settleByRims(map, findRimLattices(mesh, grid), samples, progress, winding);
  EXPECT_EQ(winding[0], 0.45f);
  EXPECT_EQ(countWrongSigns(mesh, grid, winding), 0u);
}

TEST(WindingRimsSamples, AnswerTiesAlike) {
  // The winding number of all samples in the plane of the missing side is 1/2.
  const Mesh mesh = openBox();
  const Numbers numbers = numbersOf(mesh, boxGrid());
  size_t ties = 0;
  for (const uint32_t s : numbers.lattices.computed[0])
    if (std::abs(exactNumber(mesh, boxGrid(), s) - 0.5) < 1e-9) {
      EXPECT_EQ(numbers.winding[s], 0.5f) << s;
      ++ties;
    }
  EXPECT_GT(ties, 20u);
}

/// A closed surface and as many triangles by themselves, at a resolution at which fitting is faster.
RimLattices latticesWith(int triangles) {
  const Mesh mesh = shapes::joined(shapes::sphere(1.0, 5), shapes::soup(triangles, 3));
  return findRimLattices(mesh, fitGrid(mesh, {.resolution = 16}));
}

TEST(RimLattices, AreLeftOutWhereTheFitIsFaster) {
  EXPECT_TRUE(findRimLattices(sheet(), fitGrid(sheet(), {.resolution = 64})).haveAll());
  struct Case {
    int triangles;
    uint32_t looks;
  };
  for (const auto& [triangles, looks] :
       {Case{512, 0}, Case{513, kLooks - 1}, Case{1365, kLooks - 1}, Case{1366, kLooks}}) {
    const RimLattices lattices = latticesWith(triangles);
    EXPECT_FALSE(lattices.haveAll());
    EXPECT_EQ(lattices.source(), kFromFit);
    EXPECT_EQ(lattices.rims.size(), size_t(3 * triangles));
    EXPECT_EQ(lattices.looks, looks) << triangles;
  }
}

TEST(RimLattices, AreLeftOutWhereTheyAreTooMany) {
  const Mesh line = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const PackedMesh mesh(line);
  const Grid grid = fitGrid(line, {.resolution = 8});
  for (const uint32_t times : {1u << 18, (1u << 18) + 1}) {
    const std::vector<RimEdge> edges{{.from = 0, .to = 1, .times = times}};
    const RimLattices lattices = findRimLattices(mesh, edges, grid, SignMode::Harmonic);
    EXPECT_EQ(lattices.rims.size(), times == 1u << 18 ? times : 0u);
    EXPECT_EQ(lattices.looks, kLooks);
    EXPECT_EQ(findRimLattices(mesh, edges, grid, SignMode::Exact).rims.size(), times);
  }
}

TEST(RimLattices, AreLeftOutWhereTrianglesAreFewer) {
  const Mesh soup = shapes::soup(100, 3);
  const RimLattices lattices = findRimLattices(soup, fitGrid(soup, {.resolution = 16}));
  EXPECT_EQ(lattices.rims.size(), 300u);
  EXPECT_FALSE(lattices.haveAll());
  EXPECT_EQ(lattices.looks, kLooks);
}

TEST(RimLattices, NeedTheWholeMeshInTheGrid) {
  const Mesh mesh = openBox();
  Grid grid = boxGrid();
  grid.origin.x += 20.0;
  const RimLattices lattices = findRimLattices(mesh, grid);
  EXPECT_FALSE(lattices.haveAll());
  EXPECT_EQ(lattices.looks, 0u);
  EXPECT_EQ(lattices.source(), kFromFit);
}

TEST(RimLattices, HaveEachSampleNearARim) {
  const Mesh mesh = sheet();
  const Grid grid = fitGrid(mesh, {.resolution = 50});
  const RimLattices lattices = findRimLattices(mesh, grid);
  ASSERT_EQ(lattices.computed.size(), 4u);
  for (uint32_t level = 0; level < 3; ++level) {
    const glm::ivec3 dims = rimDims(grid.dims, level);
    const std::vector<uint32_t>& listed = lattices.computed[level];
    EXPECT_TRUE(std::ranges::is_sorted(listed));
    const float size = float(1 << level);
    for (uint32_t place = 0; place < uint32_t(dims.x * dims.y * dims.z); ++place) {
      const uint32_t row = place / uint32_t(dims.x);
      const glm::vec3 p(place % uint32_t(dims.x), row % uint32_t(dims.y), row / uint32_t(dims.y));
      double nearest = INFINITY;
      for (const RimLine& rim : lattices.rims)
        nearest = std::min(nearest, reference::segmentDistance(p, rim.from / size, rim.to / size));
      const bool isListed = std::ranges::binary_search(listed, place);
      EXPECT_TRUE(isListed || nearest > 0.99) << level << ", " << place;
      EXPECT_FALSE(isListed && nearest > 4.0) << level << ", " << place;
    }
  }
  const glm::ivec3 coarsest = rimDims(grid.dims, 3);
  EXPECT_EQ(lattices.computed[3].size(), size_t(coarsest.x) * coarsest.y * coarsest.z);
}

}  // namespace
}  // namespace raymap
