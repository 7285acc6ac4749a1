// Narrow bands against the dense fields of the same samples.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <random>
#include <span>
#include <tuple>

#include "analytic_fields.h"
#include "any_threads.h"
#include "bands.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "fill.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

template <class Visit>
void forEachSample(const Grid& grid, Visit&& visit) {
  for (int z = 0; z < grid.dims.z; ++z)
    for (int y = 0; y < grid.dims.y; ++y)
      for (int x = 0; x < grid.dims.x; ++x) visit(glm::ivec3(x, y, z));
}

TEST(NarrowField, MakesADenseField) {
  for (const Field& band : someBands()) {
    const Field field = toDense(band);
    EXPECT_EQ(field.grid, band.grid);
    EXPECT_EQ(field.clampDistance, std::min(band.narrow->inside, band.narrow->outside));
    EXPECT_EQ(field.surfaceBounds.min, band.surfaceBounds.min);
    EXPECT_EQ(field.surfaceBounds.max, band.surfaceBounds.max);
    EXPECT_EQ(field.triangle.size(), band.triangle.empty() ? 0 : field.distance.size());
    EXPECT_EQ(field.winding.size(), band.winding.empty() ? 0 : field.distance.size());
    EXPECT_EQ(field.confidence.size(), band.confidence.empty() ? 0 : field.distance.size());
    forEachSample(band.grid, [&](const glm::ivec3& sample) {
      const size_t i = band.grid.index(sample);
      ASSERT_EQ(field.distance[i], band.distanceAt(sample));
      if (band.triangle.empty()) return;
      if (const std::optional<size_t> place = band.narrow->find(sample)) {
        ASSERT_EQ(field.triangle[i], band.triangle[*place]);
        ASSERT_EQ(field.winding[i], band.winding[*place]);
        ASSERT_EQ(field.confidence[i], band.confidence[*place]);
      } else {
        ASSERT_EQ(field.triangle[i], kNoTriangle);
        ASSERT_TRUE(std::isnan(field.winding[i]) && std::isnan(field.confidence[i]));
      }
    });
  }
}

TEST(NarrowField, ComesFromADenseField) {
  const Mesh mesh = withHoles(shapes::torus(1.0, 0.35, 40, 20), 3, 0.2, 7);
  const FieldOptions all{.triangle = true, .winding = true, .confidence = true};
  const Field field = generate(mesh, fitGrid(mesh, {.resolution = 70}), all, {.device = "cpu"}).field;
  for (const BandOptions& options :
       {BandOptions{.triangle = true, .winding = true, .confidence = true},
        BandOptions{.outside = 1.5, .inside = 4.25}, BandOptions{.inside = kInfinite}}) {
    const Field band = toSparse(field, options);
    EXPECT_NO_THROW(validate(band));
    EXPECT_GT(band.narrow->leaves.size(), 0u);
    size_t active = 0;
    forEachSample(field.grid, [&](const glm::ivec3& sample) {
      const size_t i = field.grid.index(sample);
      const auto value =
          float(std::clamp(double(field.distance[i]), -band.narrow->inside, band.narrow->outside));
      ASSERT_EQ(band.distanceAt(sample), value);
      const std::optional<size_t> place = band.narrow->find(sample);
      active += band.narrow->isActive(value);
      ASSERT_TRUE(place || !band.narrow->isActive(value));
      if (!place || !options.triangle) return;
      ASSERT_EQ(band.triangle[*place], band.narrow->isActive(value) ? field.triangle[i] : kNoTriangle);
      ASSERT_EQ(band.winding[*place], field.winding[i]);
      ASSERT_EQ(band.confidence[*place], field.confidence[i]);
    });
    EXPECT_EQ(band.activeCount(), active);
  }
}

// Both find the leaves that are needed. Of the tiles, only those that can be joined change.
TEST(NarrowField, KeepsItsLeavesOnTheWayThroughADenseField) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const Surface surface(mesh);
  // The second grid lies in the box, up to 3 samples from two of its faces.
  for (const Grid& grid :
       {fitGrid(mesh, {.resolution = 160}), Grid{{101, 45, 92}, {-0.002, 0.3, 0.1}, 0.008}}) {
    const Field band = surface.generateBand(grid, {.triangle = true});
    const Field again = toSparse(toDense(band), {.triangle = true});
    EXPECT_NO_THROW(validate(band));
    EXPECT_TRUE(sameBits(again.narrow->leaves, band.narrow->leaves));
    EXPECT_TRUE(sameBits(again.distance, band.distance));
    EXPECT_TRUE(sameBits(again.triangle, band.triangle));
    EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(again.narrow->tiles)),
                                   std::as_bytes(std::span(band.narrow->tiles))));
    EXPECT_TRUE(sameBits(toDense(again).distance, toDense(band).distance));
  }
}

TEST(NarrowField, GivesADenseFieldOfARegion) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Surface surface(mesh);
  const Field band =
      surface.generateBand(fitGrid(mesh, {.resolution = 60}), {.triangle = true, .winding = true});
  const Field whole = toDense(band);
  const Region region{{3, 17, 9}, {41, 1, 50}};
  const Field part = toDense(band, region);
  EXPECT_EQ(part.grid, (Grid{region.size, band.grid.position(region.low), band.grid.spacing}));
  EXPECT_EQ(part.clampDistance, whole.clampDistance);
  for (int z = 0; z < 50; ++z)
    for (int x = 0; x < 41; ++x) {
      const size_t to = part.grid.index({x, 0, z}), from = whole.grid.index(region.low + glm::ivec3(x, 0, z));
      ASSERT_EQ(part.distance[to], whole.distance[from]) << x << " " << z;
      ASSERT_EQ(part.triangle[to], whole.triangle[from]);
      ASSERT_EQ(std::bit_cast<uint32_t>(part.winding[to]), std::bit_cast<uint32_t>(whole.winding[from]));
    }
  for (const Region& wrong : {Region{{-1, 0, 0}, {2, 2, 2}}, Region{{0, 0, 0}, {61, 2, 2}},
                              Region{{0, 0, 59}, {2, 2, 2}}, Region{{0, 0, 0}, {2, 0, 2}}})
    EXPECT_EQ(codeOf([&] { toDense(band, wrong); }), ErrorCode::Usage);
}

TEST(NarrowField, RefusesADenseFieldThatDoesNotFit) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Surface surface(mesh);
  const Field band = surface.generateBand(fitGrid(mesh, {.resolution = 40}));
  EXPECT_EQ(codeOf([&] { toDense(band, {.memoryLimit = 100000}); }), ErrorCode::Memory);
  EXPECT_NO_THROW(toDense(band, {.memoryLimit = band.grid.sampleCount() * 4}));
  const Grid huge{.dims = glm::ivec3(1 << 24), .origin = glm::dvec3(-1.5), .spacing = 0.1};
  EXPECT_EQ(codeOf([&] { toDense(surface.generateBand(huge)); }), ErrorCode::Memory);
}

TEST(NarrowField, RefusesBandsThatADenseFieldCannotGive) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  Field field = generate(mesh, grid, {.band = 2.0}, {.device = "cpu"}).field;
  const auto refuses = [&](const BandOptions& options) {
    EXPECT_EQ(codeOf([&] { toSparse(field, options); }), ErrorCode::Usage);
  };
  refuses({.outside = 3.0, .inside = 2.0});
  refuses({.outside = 2.0, .inside = 3.0});
  refuses({.outside = 2.0, .inside = kInfinite});
  refuses({.outside = 2.0, .inside = 0.0});
  refuses({.outside = NAN, .inside = 2.0});
  refuses({.outside = 2.0, .inside = 2.0, .winding = true});
  EXPECT_NO_THROW(toSparse(field, {.outside = 2.0, .inside = 2.0}));
  EXPECT_EQ(codeOf([&] { toSparse(field, {.outside = 2.0, .inside = 2.0}, {.memoryLimit = 10000}); }),
            ErrorCode::Memory);
  field.distance[grid.index({3, 4, 5})] = NAN;
  EXPECT_EQ(codeOf([&] { toSparse(field, {.outside = 2.0, .inside = 2.0}); }), ErrorCode::Input);
}

TEST(NarrowField, SaysWhatIsNotValid) {
  const auto expectRefused = [](auto&& make, std::initializer_list<void (*)(Field&)> changes) {
    EXPECT_EQ(codeOf([&] { validate(make()); }), std::nullopt);
    size_t number = 0;
    for (const auto change : changes) {
      Field field = make();
      change(field);
      EXPECT_EQ(codeOf([&] { validate(field); }), ErrorCode::Usage) << number;
      ++number;
    }
  };
  const auto narrow = [] {
    Field band{.grid = {.dims = {40, 40, 40}, .spacing = 1.0},
               .distance = Buffer<float>(2 * NarrowBand::kLeafSamples),
               .narrow = NarrowBand{.outside = 3.0, .inside = 3.0}};
    fill(band.narrow->leaves, {{8, 0, 0}, {0, 8, 0}});
    band.narrow->tiles = {{{0, 0, 16}, 16}, {{32, 0, 0}, 8}};
    return band;
  };
  expectRefused(
      narrow,
      {[](Field& band) { band.grid.spacing = 0.0; }, [](Field& band) { band.grid.dims.z = (1 << 24) + 1; },
       [](Field& band) { band.narrow->outside = kInfinite; }, [](Field& band) { band.narrow->inside = 0.0; },
       [](Field& band) { band.distance.resizeUninitialized(512); },
       [](Field& band) { band.triangle.resizeUninitialized(512); },
       [](Field& band) { band.winding.resizeUninitialized(512); },
       [](Field& band) { band.confidence.resizeUninitialized(512); },
       [](Field& band) { std::swap(band.narrow->leaves[0], band.narrow->leaves[1]); },
       [](Field& band) { band.narrow->leaves[1] = band.narrow->leaves[0]; },
       [](Field& band) { band.narrow->leaves[1].y = 9; }, [](Field& band) { band.narrow->leaves[0].x = -8; },
       [](Field& band) { band.narrow->leaves[1].z = 40; },
       [](Field& band) { band.narrow->tiles[0].side = 24; },
       [](Field& band) { band.narrow->tiles[0].side = 4; },
       [](Field& band) { band.narrow->tiles[0].side = 32; },
       [](Field& band) { std::swap(band.narrow->tiles[0], band.narrow->tiles[1]); }});
  const auto dense = [] {
    return Field{.grid = {.dims = {4, 3, 2}, .spacing = 1.0}, .distance = Buffer<float>(24)};
  };
  expectRefused(dense, {[](Field& field) { field.distance = {}; },
                        [](Field& field) { field.distance.resizeUninitialized(23); },
                        [](Field& field) { field.triangle.resizeUninitialized(23); },
                        [](Field& field) { field.winding.resizeUninitialized(25); },
                        [](Field& field) { field.confidence.resizeUninitialized(1); },
                        [](Field& field) { field.grid.spacing = 0.0; }});
}

TEST(NarrowField, IsAskedForWhereADenseFieldIsGiven) {
  const Field field = analytic::sampled(analytic::cube(20, 2.0),
                                        [](const glm::dvec3& p) { return analytic::sphere(p, 0.7); });
  const Field band = toSparse(field);
  EXPECT_EQ(codeOf([&] { toSparse(band); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { toDense(field); }), ErrorCode::Usage);
}

TEST(NarrowField, CountsWhatADenseFieldHolds) {
  Field field{.grid = {.dims = {5, 1, 1}, .spacing = 1.0}};
  fill(field.distance, {-2.0f, -1.5f, 0.0f, 1.5f, 2.0f});
  EXPECT_EQ(field.activeCount(), 5u);
  EXPECT_EQ(field.clamp(), 0.0);
  field.clampDistance = 2.0;
  EXPECT_EQ(field.activeCount(), 3u);
  EXPECT_EQ(field.clamp(), 2.0);
  EXPECT_EQ(field.distanceAt({3, 0, 0}), 1.5f);
  EXPECT_EQ(field.bytes(), field.distance.capacityBytes());
  field.triangle.resizeUninitialized(5);
  EXPECT_EQ(field.bytes(), field.distance.capacityBytes() + field.triangle.capacityBytes());
  const Field band = toSparse(field, {.outside = 1.0, .inside = 2.0});
  EXPECT_EQ(band.clamp(), 1.0);
  EXPECT_EQ(band.bytes(), band.distance.capacityBytes() + band.narrow->leaves.capacityBytes());
}

TEST(NarrowField, IsSampledAsItsDenseField) {
  std::mt19937 random(5);
  for (const Field& band : someBands()) {
    const Field field = toDense(band);
    const glm::dvec3 size = glm::dvec3(band.grid.dims - 1);
    std::uniform_real_distribution<> share(-0.3, 1.3);
    std::vector<glm::dvec3> points{{NAN, 0, 0}, {INFINITY, 0, 0}, {0, -1e300, 0}};
    for (int n = 0; n < 3000; ++n)
      points.push_back(band.grid.position(size * glm::dvec3(share(random), share(random), share(random))));
    for (int n = 0; n < 300; ++n)  // On samples, and on sides of leaves.
      points.push_back(band.grid.position(glm::round(size * glm::dvec3(share(random), share(random), 0.5))));
    for (const Outside outside : {Outside::Bound, Outside::NaN}) {
      const SampleOptions options{.gradients = true, .outside = outside};
      const Samples expected = sample(field, points, options), got = sample(band, points, options),
                    one = sample(band, points, options, {.threads = 1});
      for (const Samples& samples : {std::cref(got), std::cref(one)}) {
        EXPECT_TRUE(sameBits(samples.distance, expected.distance));
        EXPECT_TRUE(sameBits(samples.gradient, expected.gradient));
      }
      const auto isSame = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
      for (size_t i = 0; i < points.size(); i += 10) {
        EXPECT_TRUE(isSame(distanceAt(band, points[i], outside), distanceAt(field, points[i], outside)));
        const glm::dvec3 g = gradientAt(band, points[i], outside), h = gradientAt(field, points[i], outside);
        for (int a = 0; a < 3; ++a) EXPECT_TRUE(isSame(g[a], h[a]));
      }
    }
  }
}

void expectSameSurface(const Field& band, const Field& field, double iso) {
  std::vector<WarningCode> ofBand, ofField;
  const auto into = [](std::vector<WarningCode>& codes) {
    return [&codes](const Warning& warning) { codes.push_back(warning.code); };
  };
  const Mesh expected = isosurface(field, {.iso = iso}, {.warn = into(ofField)});
  const Mesh got = isosurface(band, {.iso = iso}, {.warn = into(ofBand)}),
             one = isosurface(band, {.iso = iso}, {.threads = 1});
  EXPECT_GT(expected.triangles.size(), 0u);
  for (const Mesh& mesh : {std::cref(got), std::cref(one)}) {
    EXPECT_TRUE(mesh.vertices == expected.vertices);
    EXPECT_TRUE(mesh.triangles == expected.triangles);
    EXPECT_EQ(mesh.origin, expected.origin);
  }
  EXPECT_EQ(ofBand, ofField);
}

TEST(NarrowField, HasTheSurfaceOfItsDenseField) {
  for (const Field& band : someBands()) {
    const Field field = toDense(band);
    for (const double share : {0.0, 0.4, -0.4}) expectSameSurface(band, field, share * field.clampDistance);
  }
}

// The sides of tiles are surface where no leaf lies beside them, as in the middle of a large hole, and where
// the lattice ends.
TEST(NarrowField, HasASurfaceAtTheSidesOfTiles) {
  Field band{.grid = {.dims = {45, 41, 50}, .spacing = 0.5},
             .narrow = NarrowBand{.outside = 2.0, .inside = 1.5}};
  band.narrow->tiles = {
      {{0, 0, 0}, 16}, {{16, 0, 0}, 8}, {{24, 24, 8}, 8}, {{16, 32, 16}, 8}, {{32, 32, 32}, 16}};
  std::ranges::sort(band.narrow->tiles, {}, [](const NarrowBand::Tile& tile) {
    return std::tuple(tile.low.z / 32, tile.low.y / 32, tile.low.x / 32, tile.low.z / 16, tile.low.y / 16,
                      tile.low.x / 16, tile.low.z, tile.low.y, tile.low.x);
  });
  expectSameSurface(band, toDense(band), 0.0);
  expectSameSurface(band, toDense(band), 0.7);
}

// The way through a dense field would take 4 TB.
TEST(NarrowField, HasASurfaceOnAHugeLattice) {
  const Mesh ball = shapes::sphere(1.0, 3);
  const Surface surface(ball);
  const Grid small = fitGrid(ball, {.voxelSize = 0.0625});
  Grid huge = small;
  huge.dims = glm::ivec3(10000);
  huge.origin -= huge.spacing * 8.0 * 600.0;
  const Mesh expected = isosurface(surface.generateBand(small)), got = isosurface(surface.generateBand(huge));
  EXPECT_EQ(got.triangles.size(), expected.triangles.size());
  const Box box = bounds(got);
  EXPECT_NEAR(box.min.x, -1.0, 0.02);
  EXPECT_NEAR(box.max.z, 1.0, 0.02);
}

}  // namespace
}  // namespace raymap
