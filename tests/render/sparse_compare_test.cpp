// Comparisons of narrow bands against those of the dense fields of the same samples.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "broken_meshes.h"
#include "error_code.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr BandOptions kWithAll{.triangle = true, .winding = true, .confidence = true};

/// Pairs of bands on one lattice each: a torus with holes and a smaller one, and balls with tiles of several
/// sizes, one of them beside the other.
std::vector<std::pair<Field, Field>> somePairs() {
  std::vector<std::pair<Field, Field>> pairs;
  const Mesh torus = withHoles(shapes::torus(1.0, 0.35, 40, 20), 3, 0.2, 7),
             thin = shapes::torus(1.0, 0.3, 40, 20);
  const Grid grid = fitGrid(torus, {.resolution = 61});
  pairs.emplace_back(Surface(torus).generateBand(grid, kWithAll), Surface(thin).generateBand(grid, kWithAll));
  Mesh ball = shapes::sphere(1.0, 3);
  const Grid around = fitGrid(ball, {.resolution = 100});
  Field first = Surface(ball).generateBand(around, kWithAll);
  BandOptions wider = kWithAll;
  wider.outside = 4.0, wider.inside = 5.5;
  for (glm::vec3& v : ball.vertices) v = 0.8f * v + glm::vec3(0.1f, 0, 0);
  pairs.emplace_back(std::move(first), Surface(ball).generateBand(around, wider));
  return pairs;
}

/// Returns a field with NaN where the band knows nothing.
Field denseOf(const Field& band) {
  Field field = toDense(band);
  for (int k = 0; k < band.grid.dims.z; ++k)
    for (int j = 0; j < band.grid.dims.y; ++j)
      for (int i = 0; i < band.grid.dims.x; ++i) {
        if (band.narrow->find({i, j, k})) continue;
        const size_t n = band.grid.index({i, j, k});
        field.winding[n] = field.confidence[n] = NAN;
        field.triangle[n] = kNoTriangle;
      }
  return field;
}

TEST(SparseCompare, FindsWhatTheDenseFieldsDiffer) {
  size_t tiles = 0, differences = 0;
  for (const auto& [a, b] : somePairs()) {
    tiles += std::min(a.narrow->tiles.size(), b.narrow->tiles.size());
    const Field fieldA = denseOf(a), fieldB = denseOf(b);
    for (const FieldArray array :
         {FieldArray::Distance, FieldArray::Winding, FieldArray::Confidence, FieldArray::Triangle}) {
      const Comparison found = compareFields(a, b, array), wanted = compareFields(fieldA, fieldB, array);
      EXPECT_EQ(found.samples, wanted.samples);
      EXPECT_EQ(found.signDifferences, wanted.signDifferences);
      EXPECT_EQ(found.differences, wanted.differences);
      EXPECT_EQ(found.nonFinite, wanted.nonFinite);
      EXPECT_EQ(found.maxError, wanted.maxError);
      EXPECT_NEAR(found.meanError, wanted.meanError, 1e-9);
      EXPECT_NEAR(found.rmsError, wanted.rmsError, 1e-9);
      differences += wanted.differences;
      EXPECT_EQ(renderComparison(a, b, 200, array).rgb, renderComparison(fieldA, fieldB, 200, array).rgb);
    }
  }
  EXPECT_GT(tiles, 0u);
  EXPECT_GT(differences, 100'000u);
}

TEST(SparseCompare, FindsTheWorstSample) {
  for (const auto& [a, b] : somePairs()) {
    const glm::ivec3 worst = compareFields(a, b).worstSample;
    const double band = std::min(a.clamp(), b.clamp());
    const auto clamped = [&](float value) { return std::clamp(double(value), -band, band); };
    EXPECT_EQ(std::abs(clamped(a.distanceAt(worst)) - clamped(b.distanceAt(worst))) / a.grid.spacing,
              compareFields(a, b).maxError);
  }
}

TEST(SparseCompare, EqualBandsDoNotDiffer) {
  const Field a = std::move(somePairs().back().first);
  const Comparison found = compareFields(a, a);
  EXPECT_EQ(found.differences, 0u);
  EXPECT_EQ(found.maxError, 0.0);
  EXPECT_EQ(found.samples, size_t(a.grid.dims.x) * a.grid.dims.y * a.grid.dims.z);
}

// 10^15 samples are compared by the cubes of which both bands know that they are alike.
TEST(SparseCompare, CountsTheSamplesOfHugeTiles) {
  Field a, b;
  a.grid = b.grid = {.dims = glm::ivec3(100'000), .origin = {}, .spacing = 0.5};
  for (Field* each : {&a, &b}) each->narrow = NarrowBand{.outside = 1.0, .inside = 1.0};
  a.narrow->tiles = {{.low = {4096, 0, 0}, .side = 4096}};
  b.narrow->tiles = {{.low = {4096, 0, 0}, .side = 2048}, {.low = {65536, 65536, 65536}, .side = 65536}};
  const Comparison found = compareFields(a, b);
  const size_t ofA = size_t{4096} * 4096 * 4096 - size_t{2048} * 2048 * 2048,
               ofB = size_t{34464} * 34464 * 34464;  // The part of the large tile on the lattice.
  EXPECT_EQ(found.samples, size_t{1'000'000'000'000'000});
  EXPECT_EQ(found.signDifferences, ofA + ofB);
  EXPECT_EQ(found.differences, ofA + ofB);
  EXPECT_EQ(found.maxError, 4.0);
  EXPECT_DOUBLE_EQ(found.meanError, 4.0 * double(ofA + ofB) / 1e15);
}

TEST(SparseCompare, RefusesOtherLatticesAndMissingArrays) {
  const Field a = std::move(somePairs().front().first);
  Field other = toSparse(toDense(a));
  EXPECT_EQ(codeOf([&] { compareFields(a, other, FieldArray::Winding); }), ErrorCode::Usage);
  other.grid.spacing *= 1.01;
  EXPECT_EQ(codeOf([&] { compareFields(a, other); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { renderComparison(a, other); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { compareFields(a, toDense(a)); }), ErrorCode::Usage);
}

}  // namespace
}  // namespace raymap
