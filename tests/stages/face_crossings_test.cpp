#include "cpu/points/face_crossings.h"

#include <gtest/gtest.h>

#include <numeric>

#include "cpu/points/segment_crossings.h"
#include "shapes.h"

namespace raymap::cpu {
namespace {

Mesh meshOf(std::vector<glm::vec3> vertices, std::vector<glm::uvec3> triangles) {
  return {.vertices = std::move(vertices), .triangles = std::move(triangles)};
}

int32_t crossings(const Mesh& mesh, const glm::dvec3& from, const glm::dvec3& to, const Turns& turns = {}) {
  std::vector<uint32_t> faces(mesh.triangles.size());
  std::iota(faces.begin(), faces.end(), 0u);
  return countFaceCrossings(mesh, turns, faces, from, to);
}

/// One triangle in the plane z = 0, whose front is up.
const Mesh kTriangle = meshOf({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}});

TEST(FaceCrossings, CountWhereASegmentEntersAndLeaves) {
  const glm::dvec3 above(0.9, 1.1, 1.0), below(1.1, 0.9, -1.0);
  EXPECT_EQ(crossings(kTriangle, above, below), 1);
  EXPECT_EQ(crossings(kTriangle, below, above), -1);
  EXPECT_EQ(crossings(kTriangle, above, {1, 1, 0.5}), 0);
  EXPECT_EQ(crossings(kTriangle, {1, 1, -0.5}, below), 0);
  EXPECT_EQ(crossings(kTriangle, above, below, {kReversed}), -1);
  EXPECT_EQ(crossings(kTriangle, above, below, {kLeftOut}), 0);
}

TEST(FaceCrossings, PassBesideTheTriangle) {
  for (const glm::dvec3& p : {glm::dvec3(-0.01, 1, 0), glm::dvec3(1, -0.01, 0), glm::dvec3(2.01, 2, 0)})
    EXPECT_EQ(crossings(kTriangle, p + glm::dvec3(0, 0, 1), p - glm::dvec3(0, 0, 1)), 0);
  for (const glm::dvec3& p : {glm::dvec3(0.01, 1, 0), glm::dvec3(1, 0.01, 0), glm::dvec3(1.99, 2, 0)})
    EXPECT_EQ(crossings(kTriangle, p + glm::dvec3(0, 0, 1), p - glm::dvec3(0, 0, 1)), 1);
}

TEST(FaceCrossings, AreUnsureOnEdgesAndInThePlane) {
  EXPECT_EQ(crossings(kTriangle, {2, 0, 1}, {2, 0, -1}), kUnsure);
  EXPECT_EQ(crossings(kTriangle, {0, 0, 1}, {0, 0, -1}), kUnsure);
  EXPECT_EQ(crossings(kTriangle, {1, 1, 1}, {1, 1, 0}), kUnsure);
  EXPECT_EQ(crossings(kTriangle, {1, 1, 0}, {1, 1, 1}), kUnsure);
  EXPECT_EQ(crossings(kTriangle, {5, 5, 1}, {5, 5, 0}), 0);
}

TEST(FaceCrossings, TellPointsApartThatAreVeryClose) {
  EXPECT_EQ(crossings(kTriangle, {1, 1, 1}, {1, 1, 1e-12}), 0);
  EXPECT_EQ(crossings(kTriangle, {1, 1, 1}, {1, 1, -1e-12}), 1);
}

TEST(FaceCrossings, AddUpThroughASolid) {
  const Mesh sphere = shapes::sphere(1.0, 3);
  EXPECT_EQ(crossings(sphere, {2, 0.123, 0.217}, {0.1, 0.05, 0.02}), 1);
  EXPECT_EQ(crossings(sphere, {2, 0.123, 0.217}, {-2, 0.05, 0.02}), 0);
  EXPECT_EQ(crossings(shapes::joined(sphere, sphere), {2, 0.123, 0.217}, {0.1, 0.05, 0.02}), 2);
}

TEST(FaceCrossings, SkipFacesWithoutArea) {
  const Mesh mesh = meshOf({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 1}});
  EXPECT_EQ(crossings(mesh, {1, 0, 1}, {1, 0, -1}), 0);
}

}  // namespace
}  // namespace raymap::cpu
