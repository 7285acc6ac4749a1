// Narrow bands against queries of the surface, which other tests compare with brute force.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "any_threads.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

std::vector<glm::dvec3> positionsOf(const Grid& grid) {
  std::vector<glm::dvec3> points;
  for (int z = 0; z < grid.dims.z; ++z)
    for (int y = 0; y < grid.dims.y; ++y)
      for (int x = 0; x < grid.dims.x; ++x) points.push_back(grid.position(glm::dvec3(x, y, z)));
  return points;
}

glm::ivec3 sampleOf(const Grid& grid, size_t index) {
  const auto i = int(index);
  return {i % grid.dims.x, i / grid.dims.x % grid.dims.y, i / grid.dims.x / grid.dims.y};
}

/// Expects what a query gave at every sample of the lattice.
void expectQueried(const Surface& surface, const Grid& grid, const QueryResult& all,
                   const BandOptions& options) {
  const Field band = surface.generateBand(grid, options);
  EXPECT_EQ(band.narrow->outside, options.outside * grid.spacing);
  EXPECT_EQ(band.narrow->inside, options.inside * grid.spacing);
  size_t active = 0;
  for (size_t i = 0; i < all.distance.size(); ++i) {
    const auto expected = float(std::clamp(all.distance[i], -band.narrow->inside, band.narrow->outside));
    ASSERT_EQ(band.distanceAt(sampleOf(grid, i)), expected) << i;
    const std::optional<size_t> place = band.narrow->find(sampleOf(grid, i));
    active += band.narrow->isActive(expected);
    if (!place) {
      ASSERT_FALSE(band.narrow->isActive(expected)) << i;
      continue;
    }
    if (options.triangle) {
      ASSERT_EQ(band.triangle[*place], band.narrow->isActive(expected) ? all.triangle[i] : kNoTriangle) << i;
    }
    if (options.winding) {
      ASSERT_EQ(band.winding[*place], all.winding[i]) << i;
    }
    if (options.confidence) {
      ASSERT_EQ(band.confidence[*place], all.confidence[i]) << i;
    }
  }
  EXPECT_EQ(band.activeCount(), active);
  EXPECT_GT(active, 0u);
}

/// Does so for each kind of band.
void expectQueried(const Mesh& mesh, const Grid& grid, std::initializer_list<BandOptions> bands) {
  const Surface surface(mesh);
  const QueryResult all =
      surface.query(positionsOf(grid), {.triangle = true, .winding = true, .confidence = true});
  for (const BandOptions& band : bands) expectQueried(surface, grid, all, band);
}

TEST(NarrowBand, HasWhatAQueryGives) {
  const Mesh closed = shapes::torus(1.0, 0.3, 40, 20), open = withHoles(shapes::sphere(1.0, 3), 4, 0.3, 5),
             soup = shapes::soup(200, 3);
  for (const Mesh& mesh : {closed, open, soup})
    for (const int resolution : {21, 33})
      expectQueried(mesh, fitGrid(mesh, {.resolution = resolution}),
                    {{},
                     {.outside = 1.5, .inside = 4.25, .triangle = true},
                     {.inside = kEverywhere, .winding = true, .confidence = true}});
  const Box part{{-0.5, -0.4, 0.2}, {0.9, 0.8, 1.1}};  // The mesh reaches beyond it.
  expectQueried(open, fitGrid(open, {.resolution = 30, .box = part}), {{.triangle = true}});
}

TEST(NarrowBand, HasLeavesAndTilesInOrder) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const Grid grid = fitGrid(mesh, {.resolution = 200});
  const Field band = Surface(mesh).generateBand(grid);
  EXPECT_GT(band.narrow->tiles.size(), 0u);
  size_t inside = 0;
  for (const NarrowBand::Tile& tile : band.narrow->tiles) {
    EXPECT_EQ(tile.low % tile.side, glm::ivec3(0));
    for (const glm::ivec3& at : {tile.low, tile.low + tile.side - 1}) {
      EXPECT_EQ(band.distanceAt(at), -float(band.narrow->inside));
      EXPECT_FALSE(band.narrow->find(at));
    }
    inside += size_t(tile.side) * size_t(tile.side) * size_t(tile.side);
  }
  for (const float value : band.distance) inside += value < 0.0f;
  EXPECT_NEAR(double(inside), std::pow(1.0 / grid.spacing, 3), 0.03 * double(inside));
  // Each leaf is needed: some sample is in the band.
  for (size_t leaf = 0; leaf < band.narrow->leaves.size(); ++leaf) {
    const float* values = band.distance.data() + leaf * NarrowBand::kLeafSamples;
    EXPECT_TRUE(std::any_of(values, values + NarrowBand::kLeafSamples,
                            [&](float value) { return band.narrow->isActive(value); }));
    EXPECT_EQ(band.narrow->find(band.narrow->leaves[leaf]), leaf * NarrowBand::kLeafSamples);
  }
  EXPECT_EQ(band.distanceAt({-1, 0, 0}), float(band.narrow->outside));
  EXPECT_EQ(band.distanceAt({100, 100, 100000}), float(band.narrow->outside));
}

// The spacing is a power of two, so that positions are exact.
TEST(NarrowBand, DoesNotDependOnTheCut) {
  const Mesh mesh = withHoles(shapes::torus(1.0, 0.3, 40, 20), 3, 0.2, 7);
  const Grid whole{
      .dims = {90, 90, 30}, .origin = glm::dvec3(-1.40625, -1.40625, -0.46875), .spacing = 0.03125};
  const Surface surface(mesh);
  const Field all = surface.generateBand(whole);
  for (const glm::ivec3& shift : {glm::ivec3(1, 2, 3), glm::ivec3(8, 0, 16), glm::ivec3(37, 50, 5)}) {
    const Grid part{
        .dims = {41, 33, 9}, .origin = whole.position(glm::dvec3(shift)), .spacing = whole.spacing};
    const Field cut = surface.generateBand(part);
    for (size_t i = 0; i < part.sampleCount(); ++i)
      ASSERT_EQ(cut.distanceAt(sampleOf(part, i)), all.distanceAt(sampleOf(part, i) + shift)) << i;
  }
}

TEST(NarrowBand, DoesNotDependOnTheThreads) {
  const Mesh mesh = withHoles(shapes::sphere(1.0, 4), 4, 0.3, 5);
  const Grid grid = fitGrid(mesh, {.resolution = 100});
  const Surface surface(mesh);
  const BandOptions options{.triangle = true, .winding = true, .confidence = true};
  const Field one = surface.generateBand(grid, options, {.threads = 1}),
              many = surface.generateBand(grid, options, {.threads = 3});
  EXPECT_TRUE(sameBits(one.narrow->leaves, many.narrow->leaves));
  EXPECT_TRUE(sameBits(one.distance, many.distance));
  EXPECT_TRUE(sameBits(one.triangle, many.triangle));
  EXPECT_TRUE(sameBits(one.winding, many.winding));
  EXPECT_TRUE(sameBits(one.confidence, many.confidence));
  EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(one.narrow->tiles)),
                                 std::as_bytes(std::span(many.narrow->tiles))));
}

// 2^60 samples: more than 32 bits, or a float, can number.
TEST(NarrowBand, HasHugeLattices) {
  const Mesh mesh = shapes::sphere(1.0, 3, {1e7, -1e7, 0});
  const double spacing = 0.0625;
  const Grid grid{.dims = glm::ivec3(1 << 20),
                  .origin = glm::dvec3(1e7, -1e7, 0) - spacing * glm::dvec3((1 << 20) - 40),
                  .spacing = spacing};
  const Field band = Surface(mesh).generateBand(grid);
  size_t active = 0;
  for (size_t i = 0; i < band.distance.size(); i += 7) {
    if (!band.narrow->isActive(band.distance[i])) continue;
    const glm::ivec3 within = {i % 8, i / 8 % 8, i / 64 % 8};
    const glm::dvec3 p =
        grid.position(glm::dvec3(band.narrow->leaves[i / NarrowBand::kLeafSamples] + within));
    ASSERT_NEAR(std::abs(band.distance[i]), reference::distance(mesh, p), 2e-6);
    ASSERT_EQ(band.distance[i]<0.0f, std::abs(reference::windingNumber(mesh, p))> 0.5);
    ++active;
  }
  EXPECT_GT(active, 500u);
}

TEST(NarrowBand, HasNoInsideWithoutASign) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  const Surface surface(mesh, {.sign = SignMode::None});
  const Field band = surface.generateBand(grid);
  EXPECT_TRUE(band.narrow->tiles.empty());
  for (const float value : band.distance) ASSERT_GE(value, 0.0f);
  EXPECT_EQ(band.distanceAt(grid.dims / 2), float(band.narrow->outside));
  EXPECT_EQ(codeOf([&] { surface.generateBand(grid, {.winding = true}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { surface.generateBand(grid, {.confidence = true}); }), ErrorCode::Usage);
}

TEST(NarrowBand, RefusesWhatMakesNoSense) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  const Surface surface(mesh);
  const auto refuses = [&](const Grid& g, const BandOptions& options) {
    EXPECT_EQ(codeOf([&] { surface.generateBand(g, options); }), ErrorCode::Usage);
  };
  refuses(grid, {.outside = 0.0});
  refuses(grid, {.outside = kEverywhere});
  refuses(grid, {.inside = 0.0});
  refuses(grid, {.inside = NAN});
  refuses({grid.dims, grid.origin, 0.0}, {});
  refuses({grid.dims, grid.origin, kEverywhere}, {});
  refuses({grid.dims, {0.0, NAN, 0.0}, grid.spacing}, {});
  refuses({{10, 0, 10}, grid.origin, grid.spacing}, {});
  refuses({{10, 10, (1 << 24) + 1}, grid.origin, grid.spacing}, {});
  const Grid fine = fitGrid(mesh, {.resolution = 500});
  EXPECT_EQ(codeOf([&] { surface.generateBand(fine, {}, {.memoryLimit = 1 << 20}); }), ErrorCode::Memory);
  EXPECT_EQ(codeOf([&] {
              surface.generateBand(grid, {}, {.progress = [](std::string_view, double) { return false; }});
            }),
            ErrorCode::Cancelled);
}

}  // namespace
}  // namespace raymap
