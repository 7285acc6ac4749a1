#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <limits>
#include <string>

#include "analytic_fields.h"

namespace raymap {
namespace {

using analytic::cube;
using analytic::sampled;

Field ball(const Grid& grid, double radius) {
  return sampled(grid, [&](const glm::dvec3& p) { return analytic::sphere(p, radius); });
}

struct Pixel {
  int red, green, blue;
};

Pixel at(const Picture& picture, int x, int y) {
  const uint8_t* p = picture.rgb.data() + 3 * (size_t(y) * picture.width + x);
  return {p[0], p[1], p[2]};
}

size_t count(const Picture& picture, bool (*matches)(Pixel)) {
  size_t n = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) n += matches(at(picture, x, y)) ? 1 : 0;
  return n;
}

bool isRed(Pixel p) {
  return p.red > 180 && p.green < 90;
}
bool isGreen(Pixel p) {
  return p.green > 140 && p.red < 90;
}

std::string whyNotCompared(const Field& a, const Field& b) {
  try {
    compareFields(a, b);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Usage);
    return error.what();
  }
  return "";
}

TEST(Compare, EqualFieldsDoNotDiffer) {
  const Field a = ball(cube(20, 2.0), 0.6);
  const Comparison c = compareFields(a, a);
  EXPECT_EQ(c.maxError, 0.0);
  EXPECT_EQ(c.meanError, 0.0);
  EXPECT_EQ(c.rmsError, 0.0);
  EXPECT_EQ(c.signDifferences, 0u);
  EXPECT_EQ(c.samples, 8000u);
}

TEST(Compare, MeasuresAnOffsetInSamples) {
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

TEST(Compare, FindsTheWorstSample) {
  const Field a = ball(cube(10, 2.0), 0.6);
  Field b = ball(cube(10, 2.0), 0.6);
  b.distance[b.grid.index({3, 7, 2})] += 0.8f;
  b.distance[b.grid.index({1, 1, 8})] += 0.6f;
  const Comparison c = compareFields(a, b);
  EXPECT_EQ(c.worstSample, glm::ivec3(3, 7, 2));
  EXPECT_NEAR(c.maxError, 4.0, 1e-5);
  EXPECT_NEAR(c.meanError, 7.0 / 1000, 1e-5);
  EXPECT_NEAR(c.rmsError, std::sqrt((16.0 + 9.0) / 1000), 1e-5);
}

TEST(Compare, LeavesOutWhatIsNotFinite) {
  const Field a = ball(cube(10, 2.0), 0.6);
  Field b = ball(cube(10, 2.0), 0.6);
  b.distance[5] = std::numeric_limits<float>::quiet_NaN();
  b.distance[6] = -std::numeric_limits<float>::infinity();
  const Comparison c = compareFields(a, b);
  EXPECT_EQ(c.nonFinite, 2u);
  EXPECT_EQ(c.maxError, 0.0);
  EXPECT_EQ(c.signDifferences, 0u);
  EXPECT_EQ(renderComparison(a, b, 64).height, 64);
}

TEST(Compare, UsesTheNarrowerBand) {
  const Grid grid = cube(20, 2.0);
  const Field whole = ball(grid, 0.6);
  Field banded =
      sampled(grid, [](const glm::dvec3& p) { return std::clamp(analytic::sphere(p, 0.6), -0.2, 0.2); });
  banded.clampDistance = 0.2;
  EXPECT_NEAR(compareFields(whole, banded).maxError, 0.0, 1e-5);
  EXPECT_NEAR(compareFields(banded, whole).maxError, 0.0, 1e-5);
}

TEST(Compare, RefusesOtherGridsAndSaysHowTheyDiffer) {
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
  EXPECT_EQ(whyNotCompared(a, ball(other, 0.6)), "");
}

TEST(Compare, DrawsTheSliceWithMostSignDifferences) {
  const Grid grid = cube(16, 2.0);
  const Field a = ball(grid, 0.6);
  Field b = ball(grid, 0.6);
  for (int n = 0; n < 12; ++n)
    b.distance[grid.index({1, n, 13})] = -0.1f;                           // inside by b only: x = 1 or z = 13
  for (int n = 6; n < 9; ++n) b.distance[grid.index({8, n, 8})] = 0.01f;  // inside by a only, in z = 8
  Picture picture = renderComparison(a, b, 256);
  ASSERT_EQ(picture.width, 256);
  ASSERT_EQ(picture.height, 256);
  // The first such slice, z = 13: columns are x from the left, rows y from the bottom, 16 pixels a sample.
  EXPECT_TRUE(isGreen(at(picture, 24, 256 - 5 * 16 - 8)));
  EXPECT_FALSE(isGreen(at(picture, 24, 24)));
  EXPECT_EQ(count(picture, isRed), 0u);
  picture = renderComparison(b, a, 256);
  EXPECT_TRUE(isRed(at(picture, 24, 256 - 5 * 16 - 8)));
  EXPECT_EQ(count(picture, isGreen), 0u);
}

TEST(Compare, ShadesTheErrorWhereNoSignDiffers) {
  const Field a = ball(cube(16, 2.0), 0.6);
  Field b = ball(cube(16, 2.0), 0.6);
  b.distance[b.grid.index({2, 14, 5})] += 0.5f;
  const Picture picture = renderComparison(a, b, 160);
  const Pixel worst = at(picture, 25, 15);  // column 2, row 14 from the bottom
  EXPECT_LT(worst.green, 60);
  EXPECT_GT(worst.red, 120);
  const Pixel equal = at(picture, 5, 155);
  EXPECT_EQ(equal.green, 255);
}

/// Returns a field with the same values in all arrays of numbers, and with triangles.
Field filled(const Grid& grid, float value, uint32_t triangle) {
  Field field{.grid = grid};
  for (Buffer<float>* array : {&field.distance, &field.winding, &field.confidence}) {
    array->resizeUninitialized(grid.sampleCount());
    std::fill(array->begin(), array->end(), value);
  }
  field.triangle.resizeUninitialized(grid.sampleCount());
  std::fill(field.triangle.begin(), field.triangle.end(), triangle);
  return field;
}

TEST(Compare, MeasuresWindingNumbersAndConfidencesAsTheyAre) {
  const Grid grid = cube(10, 2.0);
  for (const FieldArray array : {FieldArray::Winding, FieldArray::Confidence}) {
    const Field a = filled(grid, -0.25f, 0);
    Field b = filled(grid, -0.25f, 0);
    Buffer<float>& numbers = array == FieldArray::Winding ? b.winding : b.confidence;
    numbers[grid.index({3, 7, 2})] = 0.75f;
    numbers[grid.index({4, 7, 2})] = 0.25f;
    numbers[5] = NAN;
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
    const Pixel worst = at(picture, 35, 100 - 75), half = at(picture, 45, 100 - 75),
                same = at(picture, 75, 25);
    EXPECT_LT(worst.green, 60);
    EXPECT_GT(half.green, worst.green + 80);
    EXPECT_EQ(same.green, 255);
    EXPECT_EQ(compareFields(a, b).differences, 0u) << "the distances";
  }
}

TEST(Compare, DrawsTheThresholdOfWindingNumbers) {
  const Grid grid = cube(10, 2.0);
  Field a = filled(grid, 0.0f, 0), b = filled(grid, 0.0f, 0);
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 5; i < 10; ++i)
        a.winding[grid.index({i, j, k})] = a.confidence[grid.index({i, j, k})] = -1.0f;
  const auto isBlack = [](Pixel p) { return p.red < 40 && p.green < 40 && p.blue < 50; };
  EXPECT_GE(count(renderComparison(a, b, 100, FieldArray::Winding), isBlack), 100u);
  EXPECT_EQ(count(renderComparison(a, b, 100, FieldArray::Confidence), isBlack), 0u);
}

TEST(Compare, CountsTrianglesThatDiffer) {
  const Grid grid = cube(16, 2.0);
  const Field a = filled(grid, 1.0f, 7);
  Field b = filled(grid, NAN, 7);
  for (int n = 0; n < 12; ++n) b.triangle[grid.index({1, n, 13})] = 8 + uint32_t(n);
  b.triangle[grid.index({4, 4, 4})] = kNoTriangle;
  const Comparison c = compareFields(a, b, FieldArray::Triangle);
  EXPECT_EQ(c.differences, 13u);
  EXPECT_EQ(c.samples, 4096u);
  EXPECT_EQ(c.maxError, 0.0);
  EXPECT_EQ(c.nonFinite, 0u);
  const Picture picture = renderComparison(a, b, 256, FieldArray::Triangle);  // z = 13, 16 pixels a sample
  EXPECT_EQ(count(picture, isRed), 12u * 256u);
  EXPECT_TRUE(isRed(at(picture, 24, 256 - 5 * 16 - 8)));
  EXPECT_EQ(at(picture, 40, 100).blue, 241);
  Field none;
  none.grid = grid;
  EXPECT_THROW(compareFields(a, none, FieldArray::Triangle), Error);
}

}  // namespace
}  // namespace raymap
