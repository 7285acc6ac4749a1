// Regions of lattices against queries of the surface, which other tests compare with brute force.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <thread>

#include "any_threads.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr RegionOptions kAll{.triangle = true, .winding = true, .confidence = true};

/// Expects what queries give at the samples of the region.
void expectQueried(const Surface& surface, const Grid& lattice, const Region& region,
                   const RegionOptions& options) {
  const Field field = surface.generateRegion(lattice, region, options);
  ASSERT_EQ(field.grid.dims, region.size);
  EXPECT_EQ(field.grid.origin, lattice.position(glm::dvec3(region.low)));
  EXPECT_EQ(field.grid.spacing, lattice.spacing);
  EXPECT_EQ(field.clampDistance, options.band * lattice.spacing);
  EXPECT_EQ(field.triangle.size(), options.triangle ? field.distance.size() : 0);
  EXPECT_EQ(field.winding.size(), options.winding ? field.distance.size() : 0);
  EXPECT_EQ(field.confidence.size(), options.confidence ? field.distance.size() : 0);
  std::vector<glm::dvec3> points;
  for (int z = 0; z < region.size.z; ++z)
    for (int y = 0; y < region.size.y; ++y)
      for (int x = 0; x < region.size.x; ++x)
        points.push_back(lattice.position(glm::dvec3(region.low + glm::ivec3(x, y, z))));
  const QueryResult all = surface.query(points, {.triangle = true, .winding = true, .confidence = true});
  const double clamp = options.band > 0.0 ? field.clampDistance : INFINITY;
  for (size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "sample " << i);
    const auto expected = float(std::clamp(all.distance[i], -clamp, clamp));
    ASSERT_EQ(field.distance[i], expected);
    if (options.triangle) {
      ASSERT_EQ(field.triangle[i], std::abs(expected) < float(clamp) ? all.triangle[i] : kNoTriangle);
    }
    if (options.winding) {
      ASSERT_EQ(field.winding[i], all.winding[i]);
    }
    if (options.confidence) {
      ASSERT_EQ(field.confidence[i], all.confidence[i]);
    }
  }
}

Mesh openTorus() {
  return withHoles(shapes::torus(1.0, 0.3, 40, 20), 3, 0.2, 7);
}

/// A box without one side. In the opening, far from any face, the sign changes.
Mesh openBox() {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.resize(mesh.triangles.size() - 2);
  return mesh;
}

TEST(Region, HasWhatAQueryGives) {
  const Mesh meshes[] = {shapes::torus(1.0, 0.3, 40, 20), openTorus(), openBox(), shapes::soup(60, 3)};
  for (const Mesh& mesh : meshes) {
    const Surface surface(mesh);
    const Grid lattice = fitGrid(mesh, {.resolution = 45, .padding = 0.3});
    const Region whole{{0, 0, 0}, lattice.dims}, part{{3, 7, 5}, {37, 19, 1}};
    expectQueried(surface, lattice, whole, {.triangle = true});
    expectQueried(surface, lattice, whole, {.band = 2.5, .triangle = true});
    expectQueried(surface, lattice, part, {.band = 0.75});
    expectQueried(surface, lattice, part, kAll);
    expectQueried(surface, lattice, part, {.band = 3.0, .winding = true, .confidence = true});
  }
}

TEST(Region, DoesNotDependOnTheCut) {
  const Surface surface(openTorus());
  // A spacing of which positions are rounded.
  const Grid lattice{.dims = {50, 47, 23}, .origin = {-1.3, -1.2, -0.5}, .spacing = 0.0537};
  for (const double band : {0.0, 2.0}) {
    const RegionOptions options{.band = band, .triangle = true, .winding = band == 0.0};
    const Field whole = surface.generateRegion(lattice, {{0, 0, 0}, lattice.dims}, options);
    for (const glm::ivec3& side : {glm::ivec3(50, 47, 1), glm::ivec3(1, 47, 23), glm::ivec3(8, 8, 8),
                                   glm::ivec3(17, 5, 11), glm::ivec3(31, 47, 20)})
      for (int z = 0; z < lattice.dims.z; z += side.z)
        for (int y = 0; y < lattice.dims.y; y += side.y)
          for (int x = 0; x < lattice.dims.x; x += side.x) {
            const glm::ivec3 low(x, y, z), size = glm::min(side, lattice.dims - low);
            const Field cut = surface.generateRegion(lattice, {low, size}, options);
            for (size_t i = 0; i < cut.distance.size(); ++i) {
              const glm::ivec3 within(int(i) % size.x, int(i) / size.x % size.y, int(i) / size.x / size.y);
              const size_t k = lattice.index(low + within);
              ASSERT_EQ(cut.distance[i], whole.distance[k]);
              ASSERT_EQ(cut.triangle[i], whole.triangle[k]);
              ASSERT_TRUE(!options.winding || cut.winding[i] == whole.winding[k]);
            }
          }
  }
}

TEST(Region, DoesNotDependOnTheThreads) {
  const Surface surface(openTorus());
  const Grid lattice = fitGrid(surface.mesh(), {.resolution = 90});
  const Region region{{5, 0, 3}, lattice.dims - glm::ivec3(9, 1, 4)};
  const Field one = surface.generateRegion(lattice, region, kAll, {.threads = 1}),
              many = surface.generateRegion(lattice, region, kAll, {.threads = 3});
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(*a.data())) == 0;
  };
  EXPECT_TRUE(same(one.distance, many.distance));
  EXPECT_TRUE(same(one.triangle, many.triangle));
  EXPECT_TRUE(same(one.winding, many.winding));
  EXPECT_TRUE(same(one.confidence, many.confidence));
}

/// Expects that all samples of a box have the distance, if there is one. Returns it.
std::optional<double> expectFar(const Surface& surface, const Grid& lattice, const Region& region,
                                double band) {
  const RegionOptions options{.band = band};
  const std::optional<double> far = surface.farDistance(lattice, region, options);
  if (far) {
    EXPECT_EQ(std::abs(*far), band * lattice.spacing);
    for (const float d : surface.generateRegion(lattice, region, options).distance) EXPECT_EQ(d, float(*far));
  }
  return far;
}

TEST(Region, OneDistanceHoldsForAllOfAFarBox) {
  for (const Mesh& mesh : {shapes::sphere(1.0, 3), openTorus(), openBox(), shapes::soup(60, 3)}) {
    const Surface surface(mesh), unsignedOne(mesh, {.sign = SignMode::None});
    const Grid lattice = fitGrid(mesh, {.resolution = 48, .padding = 1.0});
    size_t far = 0;
    for (const int side : {4, 7}) {
      for (int z = 0; z < lattice.dims.z; z += side)
        for (int y = 0; y < lattice.dims.y; y += side)
          for (int x = 0; x < lattice.dims.x; x += side) {
            const glm::ivec3 low(x, y, z);
            const Region region{low, glm::min(glm::ivec3(side), lattice.dims - low)};
            if (expectFar(surface, lattice, region, 1.5)) ++far;
            const std::optional<double> apart = expectFar(unsignedOne, lattice, region, 1.5);
            EXPECT_TRUE(!apart || *apart > 0.0);
          }
    }
    EXPECT_GT(far, 500u);
  }
}

TEST(Region, KnowsOnWhichSideAFarBoxLies) {
  const Surface surface(shapes::sphere(1.0, 3));
  const Grid lattice{.dims = {1000, 1000, 1000}, .origin = {-2.0, -2.0, -2.0}, .spacing = 0.004};
  const auto at = [&](int low, int size, double band) {
    return surface.farDistance(lattice, {glm::ivec3(low), glm::ivec3(size)}, {.band = band});
  };
  EXPECT_EQ(at(0, 128, 3.0), 3.0 * lattice.spacing);
  EXPECT_EQ(at(450, 100, 2.0), -2.0 * lattice.spacing);
  EXPECT_EQ(at(500, 1, 2.0), -2.0 * lattice.spacing);
  EXPECT_FALSE(at(450, 100, 150.0));
  EXPECT_FALSE(at(0, 1000, 3.0));
  EXPECT_FALSE(at(640, 16, 3.0));  // The surface.
  EXPECT_FALSE(at(0, 128, 0.0));
  EXPECT_EQ(codeOf([&] { at(990, 20, 3.0); }), ErrorCode::Usage);
}

// Lattices of more than 2^31, 2^32 and 2^64 samples.
TEST(Region, LiesOnHugeLattices) {
  const glm::dvec3 centre(1e7, -1e7, 3.0);
  const Surface surface(shapes::sphere(1.0, 3, centre));
  for (const int side : {1300, 1700, 1 << 24}) {
    const double spacing = 0.0625;
    const Grid lattice{
        .dims = glm::ivec3(side), .origin = centre - spacing * glm::dvec3(side - 60), .spacing = spacing};
    expectQueried(surface, lattice, {{side - 100, side - 80, side - 60}, {99, 70, 2}}, {.triangle = true});
    expectQueried(surface, lattice, {{side - 100, side - 80, side - 60}, {99, 70, 2}}, {.band = 2.0});
    expectQueried(surface, lattice, {{side - 1, side - 50, side - 90}, {1, 50, 90}}, kAll);
  }
}

// Most of this region is farther than the band. To query all of it would take minutes.
TEST(Region, SkipsWhatLiesBeyondTheBand) {
  const Surface surface(shapes::box({0, 0, 0}, {1, 1, 1}));
  const Grid lattice{.dims = glm::ivec3(1 << 20), .origin = glm::dvec3(-0.5), .spacing = 0.0005};
  const Region region{{0, 1500, 1700}, {4096, 512, 16}};
  const Field field = surface.generateRegion(lattice, region, {.band = 3.0, .triangle = true});
  size_t inside = 0, active = 0;
  for (size_t i = 0; i < field.distance.size(); ++i) {
    inside += field.distance[i] < 0.0f;
    active += std::abs(field.distance[i]) < float(field.clampDistance);
    ASSERT_EQ(field.triangle[i] == kNoTriangle, std::abs(field.distance[i]) >= float(field.clampDistance));
  }
  EXPECT_EQ(inside, 1999u * 512u * 16u);
  EXPECT_GT(active, 0u);
}

TEST(Region, HasNoInsideWithoutASign) {
  const Surface surface(shapes::sphere(1.0, 3), {.sign = SignMode::None});
  const Grid lattice = fitGrid(surface.mesh(), {.resolution = 40});
  const Region region{{0, 0, 10}, {40, 40, 11}};
  for (const double band : {0.0, 2.0}) {
    const Field field = surface.generateRegion(lattice, region, {.band = band});
    EXPECT_GE(*std::ranges::min_element(field.distance), 0.0f);
  }
  EXPECT_EQ(codeOf([&] { surface.generateRegion(lattice, region, {.winding = true}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { surface.generateRegion(lattice, region, {.confidence = true}); }), ErrorCode::Usage);
}

TEST(Region, RefusesWhatMakesNoSense) {
  const Surface surface(shapes::sphere(1.0, 3));
  const Grid lattice = fitGrid(surface.mesh(), {.resolution = 40});
  const auto code = [&](const Grid& grid, const Region& region, const RegionOptions& options = {},
                        const MachineOptions& machine = {}) {
    return codeOf([&] { surface.generateRegion(grid, region, options, machine); });
  };
  const Region all{{0, 0, 0}, {40, 40, 40}};
  EXPECT_EQ(code(lattice, {{0, 0, 0}, {40, 41, 40}}), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, {{0, 0, 40}, {1, 1, 1}}), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, {{0, -1, 0}, {1, 1, 1}}), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, {{0, 0, 0}, {0, 1, 1}}), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, {glm::ivec3(INT_MAX), glm::ivec3(INT_MAX)}), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, all, {.band = -1.0}), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, all, {.band = NAN}), ErrorCode::Usage);
  EXPECT_EQ(code({lattice.dims, lattice.origin, 0.0}, all), ErrorCode::Usage);
  EXPECT_EQ(code({glm::ivec3((1 << 24) + 1), lattice.origin, 1.0}, all), ErrorCode::Usage);
  EXPECT_EQ(code(lattice, all, {}, {.progress = [](std::string_view, double) { return false; }}),
            ErrorCode::Cancelled);

  const size_t needed = surface.regionBytes(all.size);
  EXPECT_GE(needed, surface.bytes() + sizeof(float) * 64000);
  EXPECT_EQ(code(lattice, all, {}, {.memoryLimit = needed - 1}), ErrorCode::Memory);
  EXPECT_EQ(surface.generateRegion(lattice, all, {}, {.memoryLimit = needed}).distance.size(), 64000u);
  EXPECT_EQ(surface.regionBytes(all.size, {.winding = true}, {.threads = 1}),
            surface.regionBytes(all.size, {}, {.threads = 1}) + sizeof(float) * 64000);
  if (std::thread::hardware_concurrency() > 1) {  // Each thread needs memory of its own.
    EXPECT_GE(surface.regionBytes(glm::ivec3(100), {}, {.threads = 2}),
              surface.regionBytes(glm::ivec3(100), {}, {.threads = 1}) + sizeof(float) * 64000);
  }
  const Grid huge{glm::ivec3(1 << 24), lattice.origin, 1.0};  // 2^72 samples.
  EXPECT_EQ(code(huge, {{0, 0, 0}, huge.dims}), ErrorCode::Memory);
  EXPECT_EQ(code(huge, {{0, 0, 0}, {1 << 24, 1 << 24, 1}}), ErrorCode::Memory);
}

}  // namespace
}  // namespace raymap
