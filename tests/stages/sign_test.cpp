#include "cpu/sign/sign.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "broken_meshes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

Buffer<float> bufferOf(std::initializer_list<float> values) {
  Buffer<float> buffer(values.size());
  std::copy(values.begin(), values.end(), buffer.begin());
  return buffer;
}

TEST(Sign, InsideIsBeyondTheThresholdWhicheverWayFacesPoint) {
  const Buffer<float> winding = bufferOf({0.0f, 0.5f, 0.51f, 1.0f, -1.0f, -0.2f, 2.0f});
  Buffer<float> distance = bufferOf({1, 1, 1, 1, 1, 1, 1});
  applySign(winding, 0.5, false, distance);
  const float expected[] = {1, 1, -1, -1, -1, 1, -1};
  for (size_t i = 0; i < distance.size(); ++i) EXPECT_EQ(distance[i], expected[i]) << i;
}

TEST(Sign, InvertTurnsEverything) {
  const Buffer<float> winding = bufferOf({0.0f, 1.0f});
  Buffer<float> distance = bufferOf({2, 3});
  applySign(winding, 0.5, true, distance);
  EXPECT_EQ(distance[0], -2);
  EXPECT_EQ(distance[1], 3);
}

TEST(Sign, OtherThresholds) {
  const Buffer<float> winding = bufferOf({0.25f, 0.35f});
  Buffer<float> distance = bufferOf({1, 1});
  applySign(winding, 0.3, false, distance);
  EXPECT_EQ(distance[0], 1);
  EXPECT_EQ(distance[1], -1);
}

TEST(Confidence, IsFullOnAClosedMesh) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  const RayMap map = rayMapOf(mesh, grid);
  const WindingResult result = windingOf(mesh, grid, SignMode::Harmonic);
  Buffer<float> confidence;
  computeConfidence(map, result.winding, 0.5, confidence);
  for (const float c : confidence) ASSERT_EQ(c, 1.0f);
}

TEST(Confidence, FallsAtTheRimOfAHole) {
  const Mesh mesh = withoutCap(shapes::sphere(1.0, 3), 0.7);
  const Grid grid{.dims = {21, 21, 21}, .origin = glm::dvec3(-1.2), .spacing = 0.12};
  const RayMap map = rayMapOf(mesh, grid);
  const WindingResult result = windingOf(mesh, grid, SignMode::Harmonic);
  Buffer<float> confidence;
  computeConfidence(map, result.winding, 0.5, confidence);
  for (const float c : confidence) {
    ASSERT_GE(c, 0.0f);
    ASSERT_LE(c, 1.0f);
  }
  // In the hole's plane |w| is near the threshold; below the centre and outside it is clear.
  EXPECT_LT(confidence[grid.index({10, 10, 16})], 0.4f);
  EXPECT_GT(confidence[grid.index({10, 10, 4})], 0.6f);
  EXPECT_GT(confidence[grid.index({0, 0, 0})], 0.9f);
}

}  // namespace
}  // namespace raymap
