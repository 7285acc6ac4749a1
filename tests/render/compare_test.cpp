#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "analytic_fields.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "field_kinds.h"
#include "pictures.h"
#include "shapes.h"

namespace raymap {
namespace {

using analytic::cube;
using analytic::sampled;

class Compare : public EachKind {
 protected:
  static Field ball(const Grid& grid, double radius) {
    return made(sampled(grid, [&](const glm::dvec3& p) { return analytic::sphere(p, radius); }));
  }
};

INSTANTIATE_TEST_SUITE_P(Fields, Compare, kEachKind, nameOfKind);

size_t count(const Picture& picture, bool (*matches)(const glm::ivec3&)) {
  size_t n = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) n += matches(pixelAt(picture, x, y)) ? 1 : 0;
  return n;
}

bool isRed(const glm::ivec3& p) {
  return p.r > 180 && p.g < 90;
}
bool isGreen(const glm::ivec3& p) {
  return p.g > 140 && p.r < 90;
}

std::string whyNotCompared(const Field& a, const Field& b) {
  EXPECT_EQ(codeOf([&] { renderComparison(a, b); }), codeOf([&] { compareFields(a, b); }));
  return usageMessage([&] { compareFields(a, b); });
}

TEST_P(Compare, EqualFieldsDoNotDiffer) {
  const Field a = ball(cube(20, 2.0), 0.6);
  const Comparison c = compareFields(a, a);
  EXPECT_EQ(c.maxError, 0.0);
  EXPECT_EQ(c.meanError, 0.0);
  EXPECT_EQ(c.rmsError, 0.0);
  EXPECT_EQ(c.signDifferences, 0u);
  EXPECT_EQ(c.samples, 8000u);
}

TEST_P(Compare, MeasuresAnOffsetInSamples) {
  const Grid grid = cube(20, 2.0);
  const Field a = ball(grid, 0.6);
  const Field b = ball(grid, 0.65);  // Every distance is 0.05, half a sample, less.
  const Comparison c = compareFields(a, b);
  EXPECT_NEAR(c.maxError, 0.5, 1e-5);
  EXPECT_NEAR(c.meanError, 0.5, 1e-5);
  EXPECT_NEAR(c.rmsError, 0.5, 1e-5);
  size_t between = 0;
  for (size_t n = 0; n < a.distance.size(); ++n) between += a.distance[n] >= 0 && b.distance[n] < 0 ? 1 : 0;
  EXPECT_GT(between, 0u);
  EXPECT_EQ(c.signDifferences, between);
}

TEST_P(Compare, FindsTheWorstSample) {
  const Field a = ball(cube(10, 2.0), 0.6);
  Field b = ball(cube(10, 2.0), 0.6);
  b.distance[placeOf(b, {3, 7, 2})] += 0.8f;
  b.distance[placeOf(b, {1, 1, 8})] += 0.6f;
  const Comparison c = compareFields(a, b);
  EXPECT_EQ(c.worstSample, glm::ivec3(3, 7, 2));
  EXPECT_NEAR(c.maxError, 4.0, 1e-5);
  EXPECT_NEAR(c.meanError, 7.0 / 1000, 1e-5);
  EXPECT_NEAR(c.rmsError, std::sqrt((16.0 + 9.0) / 1000), 1e-5);
}

TEST_P(Compare, LeavesOutWhatIsNotFinite) {
  const Field a = ball(cube(10, 2.0), 0.6);
  Field b = ball(cube(10, 2.0), 0.6);
  b.distance[placeOf(b, {5, 0, 0})] = NAN;
  b.distance[placeOf(b, {6, 0, 0})] = -INFINITY;
  const Comparison c = compareFields(a, b);
  EXPECT_EQ(c.nonFinite, 2u);
  EXPECT_EQ(c.maxError, 0.0);
  EXPECT_EQ(c.signDifferences, 0u);
  EXPECT_EQ(renderComparison(a, b, 64).height, 64);
}

TEST_P(Compare, UsesTheNarrowerBand) {
  const Grid grid = cube(20, 2.0);
  const Field whole = ball(grid, 0.6);
  Field clamped =
      sampled(grid, [](const glm::dvec3& p) { return std::clamp(analytic::sphere(p, 0.6), -0.2, 0.2); });
  clamped.clampDistance = 0.2;
  const Field banded = made(std::move(clamped));
  EXPECT_NEAR(compareFields(whole, banded).maxError, 0.0, 1e-5);
  EXPECT_NEAR(compareFields(banded, whole).maxError, 0.0, 1e-5);
}

TEST_P(Compare, RefusesOtherGridsAndSaysHowTheyDiffer) {
  const Grid grid = cube(8, 2.0);
  const Field a = ball(grid, 0.6);
  Grid other = grid;
  other.dims.y = 9;
  EXPECT_NE(whyNotCompared(a, ball(other, 0.6)).find("8 x 8 x 8 samples against 8 x 9 x 8"),
            std::string::npos);
  other = grid;
  other.spacing *= 1.01;
  EXPECT_NE(whyNotCompared(a, ball(other, 0.6)).find("spacing"), std::string::npos);
  other = grid;
  other.origin.z += 0.1;
  EXPECT_NE(whyNotCompared(a, ball(other, 0.6)).find("origin"), std::string::npos);
  other = grid;
  other.origin.x = float(other.origin.x) + 1e-8;  // The rounding error of single precision in a file.
  EXPECT_EQ(whyNotCompared(a, ball(other, 0.6)), "no error");
}

TEST_P(Compare, DrawsTheSliceWithMostSignDifferences) {
  const Grid grid = cube(16, 2.0);
  const Field a = ball(grid, 0.6);
  Field b = ball(grid, 0.6);
  for (int n = 0; n < 12; ++n)
    b.distance[placeOf(b, {1, n, 13})] = -0.1f;                           // inside by b only: x = 1 or z = 13
  for (int n = 6; n < 9; ++n) b.distance[placeOf(b, {8, n, 8})] = 0.01f;  // inside by a only, in z = 8
  Picture picture = renderComparison(a, b, 256);
  ASSERT_EQ(picture.width, 256);
  ASSERT_EQ(picture.height, 256);
  // The first such slice, z = 13: columns are x from the left, rows y from the bottom, 16 pixels a sample.
  EXPECT_TRUE(isGreen(pixelAt(picture, 24, 256 - 5 * 16 - 8)));
  EXPECT_FALSE(isGreen(pixelAt(picture, 24, 24)));
  EXPECT_EQ(count(picture, isRed), 0u);
  picture = renderComparison(b, a, 256);
  EXPECT_TRUE(isRed(pixelAt(picture, 24, 256 - 5 * 16 - 8)));
  EXPECT_EQ(count(picture, isGreen), 0u);
}

TEST_P(Compare, ShadesTheErrorWhereNoSignDiffers) {
  const Field a = ball(cube(16, 2.0), 0.6);
  Field b = ball(cube(16, 2.0), 0.6);
  b.distance[placeOf(b, {2, 14, 5})] += 0.5f;
  const Picture picture = renderComparison(a, b, 160);
  const glm::ivec3 worst = pixelAt(picture, 25, 15);  // column 2, row 14 from the bottom
  EXPECT_LT(worst.g, 60);
  EXPECT_GT(worst.r, 120);
  const glm::ivec3 equal = pixelAt(picture, 5, 155);
  EXPECT_EQ(equal.g, 255);
}

/// Returns a field with the same values in all arrays of numbers, and with triangles.
Field filled(FieldKind kind, const Grid& grid, float value, uint32_t triangle) {
  Field field{.grid = grid};
  for (Buffer<float>* array : {&field.distance, &field.winding, &field.confidence}) {
    array->resizeUninitialized(grid.sampleCount());
    std::fill(array->begin(), array->end(), value);
  }
  field.triangle.resizeUninitialized(grid.sampleCount());
  std::fill(field.triangle.begin(), field.triangle.end(), triangle);
  return inKind(kind, std::move(field));
}

TEST_P(Compare, MeasuresWindingNumbersAndConfidencesAsTheyAre) {
  const Grid grid = cube(10, 2.0);
  for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence}) {
    const Field a = filled(GetParam(), grid, -0.25f, 0);
    Field b = filled(GetParam(), grid, -0.25f, 0);
    Buffer<float>& numbers = array == FieldArray::Winding ? b.winding : b.confidence;
    numbers[placeOf(b, {3, 7, 2})] = 0.75f;
    numbers[placeOf(b, {4, 7, 2})] = 0.25f;
    numbers[placeOf(b, {5, 0, 0})] = NAN;
    b.clampDistance = 0.1;  // Of the distances alone.
    const Comparison c = compareFields(a, b, array);
    EXPECT_EQ(c.maxError, 1.0);
    EXPECT_EQ(c.worstSample, glm::ivec3(3, 7, 2));
    EXPECT_DOUBLE_EQ(c.meanError, 1.5 / 999);
    EXPECT_DOUBLE_EQ(c.rmsError, std::sqrt(1.25 / 999));
    EXPECT_EQ(c.nonFinite, 1u);
    EXPECT_EQ(c.differences, 2u);
    EXPECT_EQ(c.signDifferences, 0u);
    const Picture picture = renderComparison(a, b, 100, array);  // z = 2, 10 pixels a sample.
    const glm::ivec3 worst = pixelAt(picture, 35, 100 - 75), half = pixelAt(picture, 45, 100 - 75),
                     same = pixelAt(picture, 75, 25);
    EXPECT_LT(worst.g, 60);
    EXPECT_GT(half.g, worst.g + 80);
    EXPECT_EQ(same.g, 255);
    EXPECT_EQ(compareFields(a, b).differences, 0u) << "the distances";
  }
}

TEST_P(Compare, DrawsTheThresholdOfWindingNumbers) {
  const Grid grid = cube(10, 2.0);
  Field a = filled(GetParam(), grid, 0.0f, 0), b = filled(GetParam(), grid, 0.0f, 0);
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 5; i < 10; ++i)
        a.winding[placeOf(a, {i, j, k})] = a.confidence[placeOf(a, {i, j, k})] = -1.0f;
  const auto isBlack = [](const glm::ivec3& p) { return p.r < 40 && p.g < 40 && p.b < 50; };
  EXPECT_GE(count(renderComparison(a, b, 100, FieldArray::Winding), isBlack), 100u);
  EXPECT_EQ(count(renderComparison(a, b, 100, FieldArray::Confidence), isBlack), 0u);
}

TEST_P(Compare, CountsTrianglesThatDiffer) {
  const Grid grid = cube(16, 2.0);
  const Field a = filled(GetParam(), grid, 1.0f, 7);
  Field b = filled(GetParam(), grid, 2.0f, 7);
  for (int n = 0; n < 12; ++n) b.triangle[placeOf(b, {1, n, 13})] = 8 + uint32_t(n);
  b.triangle[placeOf(b, {4, 4, 4})] = kNoTriangle;
  const Comparison c = compareFields(a, b, FieldArray::Triangle);
  EXPECT_EQ(c.differences, 13u);
  EXPECT_EQ(c.samples, 4096u);
  EXPECT_EQ(c.maxError, 0.0);
  EXPECT_EQ(c.nonFinite, 0u);
  const Picture picture = renderComparison(a, b, 256, FieldArray::Triangle);  // z = 13, 16 pixels a sample
  EXPECT_EQ(count(picture, isRed), 12u * 256u);
  EXPECT_TRUE(isRed(pixelAt(picture, 24, 256 - 5 * 16 - 8)));
  EXPECT_EQ(pixelAt(picture, 40, 100).b, 241);
  const Field none = ball(grid, 0.6);
  EXPECT_EQ(codeOf([&] { compareFields(a, none, FieldArray::Triangle); }), ErrorCode::Usage);
}

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

TEST(CompareBands, FindsWhatTheDenseFieldsDiffer) {
  size_t tiles = 0, differences = 0;
  for (const auto& pair : somePairs()) {
    const Field &a = pair.first, &b = pair.second;
    tiles += std::min(a.narrow->tiles.size(), b.narrow->tiles.size());
    const Field fieldA = toDense(a), fieldB = toDense(b);
    for (const FieldArray array :
         {FieldArray::Distance, FieldArray::Winding, FieldArray::Confidence, FieldArray::Triangle}) {
      const Comparison found = compareFields(a, b, array), wanted = compareFields(fieldA, fieldB, array);
      EXPECT_EQ(found.samples, wanted.samples);
      EXPECT_EQ(found.signDifferences, wanted.signDifferences);
      EXPECT_EQ(found.differences, wanted.differences);
      EXPECT_EQ(found.nonFinite, wanted.nonFinite);
      EXPECT_EQ(found.maxError, wanted.maxError);
      EXPECT_EQ(found.worstSample, wanted.worstSample);
      EXPECT_NEAR(found.meanError, wanted.meanError, 1e-9);
      EXPECT_NEAR(found.rmsError, wanted.rmsError, 1e-9);
      differences += wanted.differences;
      EXPECT_EQ(renderComparison(a, b, 200, array).rgb, renderComparison(fieldA, fieldB, 200, array).rgb);
    }
    EXPECT_EQ(codeOf([&] { compareFields(a, fieldA); }), ErrorCode::Usage);
    EXPECT_EQ(codeOf([&] { renderComparison(fieldA, a); }), ErrorCode::Usage);
  }
  EXPECT_GT(tiles, 0u);
  EXPECT_GT(differences, 100'000u);
}

// 10^15 samples are compared by the cubes of which both bands know that they are alike.
TEST(CompareBands, CountsTheSamplesOfHugeTiles) {
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

}  // namespace
}  // namespace raymap
