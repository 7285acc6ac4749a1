// Pictures of narrow bands against those of the dense fields of the same samples.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "analytic_fields.h"
#include "bands.h"
#include "cpu/render/sphere_trace.h"
#include "error_code.h"
#include "field/empty_space.h"
#include "field/leaf_tree.h"
#include "picture/camera.h"
#include "picture/shape.h"
#include "picture/shown_numbers.h"
#include "pictures.h"
#include "shapes.h"

namespace raymap {
namespace {

using analytic::cube;
using analytic::sampled;

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

/// Differences of the hits of all pixels' rays.
struct HitDifferences {
  size_t hits = 0;    ///< Rays that hit the band.
  size_t missed = 0;  ///< Rays that hit one of both alone.
  size_t apart = 0;   ///< Rays whose hits lie more than 0.02 samples apart.
};

HitDifferences compareHits(const Field& band, const Field& field, RenderOptions options) {
  options.width = 80;
  options.height = 60;
  const Shape ofBand(band, options), ofField(field, options);
  const Camera camera(options, ofField), same(options, ofBand);
  if (band.narrow->inside < kEverywhere) {
    EXPECT_EQ(same.eye(), camera.eye());
    EXPECT_EQ(same.floor(), camera.floor());
  }
  HitDifferences found;
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) {
      const Ray ray = camera.ray(x + 0.5, y + 0.5);
      const std::optional<double> a = cpu::trace(ofBand, ray), b = cpu::trace(ofField, ray);
      found.hits += a ? 1 : 0;
      found.missed += a.has_value() != b.has_value();
      EXPECT_LT(a ? ofField.distance(ray.origin + *a * ray.direction) : 0.0, 2 * kHitTolerance);
      if (a && b) {
        const double apart = std::abs(*a - *b);
        found.apart += apart > 0.02 ? 1 : 0;
        EXPECT_LT(apart, 2.0);
      }
    }
  return found;
}

glm::dvec3 middleOf(const Grid& grid) {
  return grid.position(0.5 * glm::dvec3(grid.dims - 1));
}

TEST(SparseRender, RaysHitAsInTheDenseField) {
  size_t hits = 0;
  for (const Field& band : someBands()) {
    const Field field = toDense(band);
    const double width = std::min(band.narrow->inside, band.narrow->outside);
    const glm::dvec3 middle = middleOf(band.grid);
    for (const RenderOptions& options :
         {RenderOptions{}, RenderOptions{.direction = {0.3, 1.0, 0.2}, .iso = 0.5 * width},
          RenderOptions{.cut = true}, RenderOptions{.cut = true, .shell = 0.6 * width},
          RenderOptions{.direction = {0, 0, -1}, .fieldOfView = 120.0, .eye = middle},
          RenderOptions{.direction = {1, 0.1, 0}, .fieldOfView = 100.0, .eye = middle + 0.1}}) {
      const HitDifferences found = compareHits(band, field, options);
      hits += found.hits;
      EXPECT_EQ(found.missed, 0u);
      EXPECT_LE(found.apart, 3u);  // A ray that touches the surface may hit it a little before or after.
    }
  }
  EXPECT_GT(hits, 30'000u);
}

// Rays near a sphere's outline pass through many leaves and miss it, or hit it at a small angle.
TEST(SparseRender, RaysHitASphereWhereItIs) {
  const double radius = 0.8, spacing = 2.0 / 200;
  const Field field =
      sampled(cube(200, 2.0), [&](const glm::dvec3& p) { return analytic::sphere(p, radius); });
  const Field band = toSparse(field);
  const Shape shape(band, {});
  const glm::dvec3 centre(99.5);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0.0, 0.995);
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 way = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 other = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 aside = glm::normalize(glm::cross(way, other));
    const double past = (i % 3 == 0 ? 1.005 + share(random) : share(random)) * radius / spacing;
    const std::optional<double> hit = cpu::trace(shape, {centre + past * aside - 300.0 * way, way});
    if (i % 3 == 0) {
      EXPECT_FALSE(hit) << past;
      continue;
    }
    ASSERT_TRUE(hit) << past;
    const double expected = 300.0 - std::sqrt(std::pow(radius / spacing, 2.0) - past * past);
    EXPECT_NEAR(*hit, expected, 0.05) << past;
  }
}

TEST(SparseRender, PlateausHaveOneValue) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (const Field& band : someBands()) {
    if (band.narrow->inside == kEverywhere) continue;
    const Field dense = toDense(band);
    const DrawnField drawn(band), whole(dense);
    EXPECT_FALSE(whole.plateau(glm::dvec3(1.5), {1, 0, 0}));
    std::uniform_real_distribution<double> share(-0.05, 1.05);
    size_t count = 0;
    double longest = 0.0;
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 p = drawn.last() * glm::dvec3(share(random), share(random), share(random));
      const glm::dvec3 way = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
      const auto plateau = drawn.plateau(p, way);
      if (!plateau) continue;
      ++count;
      longest = std::max(longest, plateau->length);
      ASSERT_GE(plateau->length, 0.0);
      for (const double part : {0.0, 0.3, 0.7, 1.0 - 1e-9}) {
        const glm::dvec3 there = p + part * plateau->length * way;
        const bool isInGrid = glm::all(glm::greaterThanEqual(there, glm::dvec3(0.0))) &&
                              glm::all(glm::lessThanEqual(there, drawn.last()));
        ASSERT_TRUE(!isInGrid || std::abs(whole.value(there) - plateau->value) < 1e-12);
      }
    }
    EXPECT_GT(count, 100u);
    EXPECT_GT(longest, 7.0);
  }
}

TEST(SparseRender, PicturesAreThoseOfTheDenseField) {
  const std::vector<Field> bands = someBands();
  const Field& band = bands.back();
  const Field field = toDense(band);
  const double width = band.narrow->outside;
  for (const RenderOptions& look :
       {RenderOptions{}, RenderOptions{.cut = true, .shell = 0.5 * width},
        RenderOptions{.iso = 0.4 * width, .slice = Plane{.normal = {1, 0, 1}, .offset = 0.3}}}) {
    RenderOptions options = look;
    options.width = 80;
    options.height = 60;
    const Picture picture = renderField(band, options, {.threads = 1});
    EXPECT_LT(meanDifference(picture, renderField(field, options, {.device = "cpu"})), 0.5);
    EXPECT_EQ(picture.rgb, renderField(band, options, {.threads = 3}).rgb);
  }
}

/// Returns the dense field, with a number in place of those that the band does not have.
Field filled(const Field& band, float unknown) {
  Field field = toDense(band);
  for (Buffer<float>* numbers : {&field.winding, &field.confidence})
    for (float& number : *numbers)
      if (std::isnan(number)) number = unknown;
  return field;
}

const glm::ivec3 kUnknownColour(140, 60, 160);

/// Numbers of pixels of a band's picture.
struct Pixels {
  size_t known = 0;    ///< Those whose colour does not depend on numbers that are not known.
  size_t apart = 0;    ///< Known ones whose colour is not that of the dense field.
  size_t unknown = 0;  ///< Those in the colour of numbers that are not known.
  size_t mixed = 0;    ///< Others.
};

/// Compares a picture with those of two dense fields, which differ in the numbers that the band does not
/// have.
Pixels countPixels(const Picture& picture, const Picture& a, const Picture& b) {
  Pixels found;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const glm::ivec3 pixel = pixelAt(picture, x, y), expected = pixelAt(a, x, y);
      if (expected == pixelAt(b, x, y)) {
        ++found.known;
        found.apart += colourGap(pixel, expected) > 8;
      } else {
        ++(pixel == kUnknownColour ? found.unknown : found.mixed);
      }
    }
  return found;
}

TEST(SparseRender, ArraysHaveTheColoursOfTheDenseField) {
  const Mesh mesh = withHoles(shapes::torus(1.0, 0.35, 40, 20), 3, 0.2, 7);
  const Field band =
      Surface(mesh).generateBand(fitGrid(mesh, {.resolution = 180}), {.winding = true, .confidence = true});
  const Field low = filled(band, 0.0f), high = filled(band, 0.7f);
  const RenderOptions view{.width = 100, .height = 75};
  RenderOptions cut = view, sliced = view;
  cut.cut = true;
  sliced.slice = Plane{.normal = {1, 0, 1}, .offset = 0.3};
  for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence})
    for (RenderOptions options : {view, cut, sliced}) {
      const bool isSurfaceAlone = options == view;
      const Picture plain = renderField(band, options);
      options.array = array;
      const Picture picture = renderField(band, options, {.threads = 1});
      const Pixels found = countPixels(picture, renderField(low, options, {.device = "cpu"}),
                                       renderField(high, options, {.device = "cpu"}));
      EXPECT_GT(found.known, 4500u);
      EXPECT_LE(found.apart, 7u);  // One in a thousand, at edges of shadows.
      EXPECT_EQ(found.unknown > 250, !isSurfaceAlone) << found.unknown;
      EXPECT_LT(found.mixed, isSurfaceAlone ? 10u : 300u);
      EXPECT_EQ(picture.rgb == plain.rgb, isSurfaceAlone && array == FieldArray::Winding);
      EXPECT_EQ(picture.rgb, renderField(band, options, {.threads = 3}).rgb);
    }
}

/// Two balls beside each other, on lattices of their own.
struct Balls {
  Field first = sampled(cube(80, 2.0), [](const glm::dvec3& p) { return analytic::sphere(p, 0.6); });
  Field second = sampled(cube(96, 2.1), [](const glm::dvec3& p) {
    return analytic::sphere(p - glm::dvec3(0.04, 0.0, 0.0), 0.63);
  });
};

// The exact difference is that of the fields without a band.
TEST(SparseRender, DifferencesAreExactOrBoundedByTheRange) {
  const Balls balls;
  const double h = balls.first.grid.spacing, range = 2.0;
  const Field first = toSparse(balls.first, {.outside = 3.0, .inside = 5.0}),
              second = toSparse(balls.second, {.outside = 4.0, .inside = 3.0});
  const Field clamped = toDense(toSparse(balls.second, {.outside = 4.0, .inside = 4.0}));
  const DrawnField drawn(first);
  const FieldSampler a(balls.first), b(balls.second);
  std::mt19937 random(17);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const RenderOptions& options : {RenderOptions{.other = &second, .range = range * h},
                                       RenderOptions{.other = &clamped, .range = range * h},
                                       RenderOptions{.other = &balls.second, .range = range * h}}) {
    const ShownNumbers shown(drawn, options);
    EXPECT_TRUE(shown.isDifference());
    size_t exact = 0, beyond = 0, unknown = 0;
    for (int i = 0; i < 200'000; ++i) {
      const glm::dvec3 p = drawn.last() * glm::dvec3(share(random), share(random), share(random));
      const glm::dvec3 q =
          (balls.first.grid.position(p) - balls.second.grid.origin) / balls.second.grid.spacing;
      const double expected = b.value(q) * balls.second.grid.spacing / h - a.value(p), found = shown.at(p);
      if (std::isnan(found)) {
        // A sample around the point is clamped, so that one of the distances is near the end of its band.
        ++unknown;
        ASSERT_TRUE(a.value(p) > 3.0 - 1.8 || a.value(p) < -5.0 + 1.8 || b.value(q) > 4.0 - 1.8 ||
                    b.value(q) < -3.0 + 1.8);
      } else if (std::abs(found - expected) < 1e-5) {
        ++exact;
      } else {
        ++beyond;
        ASSERT_GE(std::abs(found), range);
        ASSERT_GE(expected / found, 1.0 - 1e-5) << found;  // On the same side, and no less.
      }
    }
    EXPECT_GT(exact, 5000u);
    EXPECT_GT(unknown, 50'000u);
    EXPECT_GT(beyond, 100u);
  }
}

TEST(SparseRender, DifferencesHaveTheColoursOfTheDenseFields) {
  const auto ballOf = [](double radius, double x) {
    return toSparse(sampled(cube(80, 2.0), [&](const glm::dvec3& p) {
      return analytic::sphere(p - glm::dvec3(x, 0.0, 0.0), radius);
    }));
  };
  const Field first = ballOf(0.6, 0.0), second = ballOf(0.61, 0.02);
  const Field firstDense = toDense(first), secondDense = toDense(second);
  RenderOptions ofBands{.width = 100, .height = 75, .other = &second};
  ofBands.range = 1.25 * first.grid.spacing;
  RenderOptions ofFields = ofBands;
  ofFields.other = &secondDense;
  // All samples around the surface lie in both bands.
  const Picture surface = renderField(first, ofBands);
  EXPECT_LT(meanDifference(surface, renderField(firstDense, ofFields, {.device = "cpu"})), 0.5);
  EXPECT_GT(meanDifference(surface, renderField(first, {.width = 100, .height = 75})), 2.0);
  EXPECT_EQ(renderField(first, ofFields).rgb, surface.rgb);
  // The middle of the cut face lies in none.
  ofBands.cut = ofFields.cut = true;
  const Picture cut = renderField(first, ofBands, {.threads = 1});
  EXPECT_EQ(cut.rgb, renderField(first, ofBands, {.threads = 3}).rgb);
  const Picture expected = renderField(firstDense, ofFields, {.device = "cpu"});
  size_t same = 0, unknown = 0;
  for (int y = 0; y < cut.height; ++y)
    for (int x = 0; x < cut.width; ++x) {
      const bool isUnknown = pixelAt(cut, x, y) == kUnknownColour;
      unknown += isUnknown;
      same += !isUnknown && pixelAt(cut, x, y) == pixelAt(expected, x, y);
    }
  EXPECT_GT(unknown, 500u);
  EXPECT_GT(same + unknown, 7000u);
}

TEST(SparseRender, SlicesAreThoseOfTheDenseField) {
  for (const Field& band : someBands()) {
    const Field field = toDense(band);
    for (const FieldArray array :
         {FieldArray::Distance, FieldArray::Winding, FieldArray::Confidence, FieldArray::Triangle})
      for (int axis = 0; axis < 3; ++axis) {
        if (array != FieldArray::Distance && band.winding.empty()) continue;
        const int index = axis == 1 ? 5 : -1;
        EXPECT_EQ(renderSlice(band, axis, index, 70, array).rgb,
                  renderSlice(field, axis, index, 70, array).rgb);
      }
  }
}

TEST(SparseRender, RefusesWhatCannotBeDrawn) {
  const Mesh ball = shapes::sphere(1.0, 2);
  Field band = Surface(ball).generateBand(fitGrid(ball, {.resolution = 30}),
                                          {.outside = 2.0, .inside = 4.0, .winding = true});
  const double h = band.grid.spacing;
  const auto codeWith = [&](RenderOptions options) {
    options.width = options.height = 8;
    return codeOf([&] { renderField(band, options); });
  };
  EXPECT_EQ(codeWith({.iso = 1.9 * h}), std::nullopt);
  EXPECT_EQ(codeWith({.iso = 2.0 * h}), ErrorCode::Usage);
  EXPECT_EQ(codeWith({.iso = -3.9 * h}), std::nullopt);
  EXPECT_EQ(codeWith({.iso = -4.0 * h}), ErrorCode::Usage);
  EXPECT_EQ(codeWith({.shell = 3.9 * h}), std::nullopt);
  EXPECT_EQ(codeWith({.shell = 4.0 * h}), ErrorCode::Usage);
  EXPECT_EQ(codeWith({.array = FieldArray::Winding}), std::nullopt);
  EXPECT_EQ(codeWith({.array = FieldArray::Confidence}), ErrorCode::Usage);
  EXPECT_EQ(codeWith({.array = FieldArray::Triangle}), ErrorCode::Usage);
  const Field other = toDense(band);
  EXPECT_EQ(codeWith({.other = &other}), std::nullopt);
  EXPECT_EQ(codeWith({.other = &band}), std::nullopt);
  EXPECT_EQ(codeWith({.array = FieldArray::Winding, .other = &band}), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { renderField(other, {.other = &band}, {.device = "cpu"}); }), ErrorCode::Usage);
  Field odd = toSparse(other, {.outside = 2.0, .inside = 2.0});
  odd.distance[5] = NAN;
  EXPECT_EQ(codeWith({.other = &odd}), ErrorCode::Input);
  EXPECT_EQ(codeOf([&] { renderSlice(band, 0, -1, 9, FieldArray::Confidence); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { renderSlice(band, 3); }), ErrorCode::Usage);
  const glm::ivec3 sample = band.narrow->leaves[3] + glm::ivec3(2, 1, 0);
  band.winding[3 * 512 + 10] = INFINITY;
  EXPECT_EQ(codeWith({}), std::nullopt);
  try {
    renderField(band, {.array = FieldArray::Winding});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Input);
    const std::string where = "sample (" + std::to_string(sample.x) + ", " + std::to_string(sample.y) + ", " +
                              std::to_string(sample.z) + ")";
    EXPECT_NE(std::string(error.what()).find(where), std::string::npos) << error.what();
  }
  band.distance[5] = NAN;
  EXPECT_EQ(codeWith({}), ErrorCode::Input);
  band.narrow->leaves[1] = band.narrow->leaves[0];
  EXPECT_EQ(codeWith({}), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { renderSlice(band, 0); }), ErrorCode::Usage);
}

// The dense field would take 4 TB.
TEST(SparseRender, DrawsAHugeLattice) {
  const Mesh ball = shapes::sphere(1.0, 3);
  const Surface surface(ball);
  const Grid small = fitGrid(ball, {.voxelSize = 0.0625});
  Grid huge = small;
  huge.dims = glm::ivec3(10000);
  huge.origin -= huge.spacing * 8.0 * 600.0;
  const RenderOptions options{.width = 80, .height = 60};
  const Picture expected = renderField(surface.generateBand(small), options),
                got = renderField(surface.generateBand(huge), options);
  EXPECT_LT(meanDifference(got, expected), 0.5);
}

TEST(LeafTree, FindsWhatTheBandHas) {
  for (const Field& band : someBands()) {
    const LeafTree tree(band);
    const glm::ivec3 dims = band.grid.dims;
    for (int z = 0; z < dims.z; ++z)
      for (int y = 0; y < dims.y; ++y)
        for (int x = 0; x < dims.x; ++x) {
          const glm::ivec3 sample(x, y, z);
          const std::optional<size_t> place = band.narrow->find(sample);
          const int64_t found = tree.find(sample);
          ASSERT_EQ(found >= 0, place.has_value());
          ASSERT_TRUE(!place || size_t(found) == *place);
          ASSERT_EQ(tree.blockWith(sample).at(sample), band.distanceAt(sample));
          ASSERT_EQ(tree.emptyCube(sample).has_value(), !place);
        }
  }
}

TEST(EmptySpace, IsAsLargeAsItCanBe) {
  Field band{.grid = {.dims = {900, 700, 2100}, .spacing = 1.0},
             .narrow = NarrowBand{.outside = 3.0, .inside = 3.0}};
  band.narrow->tiles = {{{320, 64, 512}, 64}, {{512, 512, 1024}, 16}};
  ASSERT_NO_THROW(validate(band));
  const EmptySpace space(band);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const glm::ivec3 sample(glm::dvec3(band.grid.dims) *
                            glm::dvec3(share(random), share(random), share(random)));
    // Numbers of cubes of 32 samples to the tiles, along each axis.
    int least = std::numeric_limits<int>::max();
    for (const NarrowBand::Tile& tile : band.narrow->tiles) {
      const glm::ivec3 cube = sample / 32, low = tile.low / 32, high = (tile.low + tile.side - 1) / 32;
      const glm::ivec3 away = glm::max(glm::max(low - cube, cube - high), 0);
      least = std::min(least, std::max({away.x, away.y, away.z}));
    }
    const std::optional<SampleBox> box = space.boxAround(sample);
    ASSERT_EQ(box.has_value(), least > 0);
    if (!box) continue;
    ASSERT_EQ(box->first, 32 * (sample / 32 - (least - 1)));
    ASSERT_EQ(box->last, 32 * (sample / 32 + least) - 1);
  }
}

TEST(LeafTree, KnowsTilesOfAnySizeOnTheLargestLattice) {
  Field band{.grid = {.dims = glm::ivec3(1 << 24), .spacing = 1.0},
             .narrow = NarrowBand{.outside = 3.0, .inside = 2.0}};
  const int side = 1 << 13;
  band.narrow->tiles = {{{0, 0, 0}, 8}, {{16, 0, 0}, 16}, {{0, 0, 64}, 64}, {{0, 0, side}, side}};
  band.narrow->leaves.resizeUninitialized(1);
  band.narrow->leaves[0] = glm::ivec3((1 << 24) - 8);
  band.distance.resizeUninitialized(512);
  std::ranges::fill(band.distance, 0.25f);
  ASSERT_NO_THROW(validate(band));
  const LeafTree tree(band);
  for (const NarrowBand::Tile& tile : band.narrow->tiles)
    for (const glm::ivec3& at : {tile.low, tile.low + tile.side / 2, tile.low + tile.side - 1}) {
      EXPECT_EQ(tree.blockWith(at).at(at), -2.0f);
      EXPECT_GE(tree.emptyCube(at)->side, std::min(tile.side, 8));
    }
  const glm::ivec3 beside(0, 0, 2 * side), last((1 << 24) - 1);
  EXPECT_EQ(tree.blockWith(beside).at(beside), 3.0f);
  EXPECT_EQ(tree.find(last), 511);
  EXPECT_GE(tree.emptyCube(glm::ivec3(1 << 23))->side, 1 << 21);
}

// A pixel is as wide as the band or wider. Slice and cut face are dark near the surface alone.
TEST(SparseRender, WhatIsFarHasNoLines) {
  const Mesh ball = shapes::sphere(1.0, 4);
  const Field band = Surface(ball).generateBand(fitGrid(ball, {.resolution = 400}));
  RenderOptions options{
      .width = 180, .height = 180, .direction = {0, 0, -1}, .slice = Plane{{0.0, 0.0, 1.0}, 0.0}};
  const auto brightness = [](const Picture& picture, int x, int y) {
    const glm::ivec3 pixel = pixelAt(picture, x, y);
    return pixel.r + pixel.g + pixel.b;
  };
  EXPECT_GT(brightness(renderField(band, options), 2, 2), 700);
  options.slice.reset();
  options.cutPlane = Plane{{0.0, 0.0, 1.0}, 0.0};
  const Picture cut = renderField(band, options);
  const int inside = brightness(cut, 90, 90);
  EXPECT_GT(inside, 200);
  int dark = 0, face = 0;
  for (int x = 0; x < 90; ++x) {
    face += brightness(cut, x, 90) < 600 ? 1 : 0;
    dark += brightness(cut, x, 90) < inside - 60 ? 1 : 0;
  }
  EXPECT_GT(face, 60);
  EXPECT_GE(dark, 1);  // The surface's own line.
  EXPECT_LE(dark, 3);
}

}  // namespace
}  // namespace raymap
