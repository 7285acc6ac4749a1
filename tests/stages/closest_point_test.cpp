#include "cpu/points/closest_point.h"

#include <gtest/gtest.h>
#include <raymap/field.h>

#include <cmath>
#include <random>

#include "reference.h"

namespace raymap::cpu {
namespace {

void expectClosest(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const TrianglePoint point = closestPoint(p, a, b, c);
  const double exact = reference::triangleDistance(p, a, b, c);
  ASSERT_NEAR(glm::distance(p, point.position), exact, 1e-12 * (1.0 + exact));
  const glm::dvec3 w = point.weights;
  ASSERT_LT(glm::distance(w.x * a + w.y * b + w.z * c, point.position), 1e-12);
  ASSERT_NEAR(w.x + w.y + w.z, 1.0, 1e-12);
  ASSERT_GE(std::min({w.x, w.y, w.z}), -1e-12);
}

TEST(ClosestPoint, IsThatOfBruteForce) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  for (int i = 0; i < 20000; ++i) expectClosest(2.0 * point(), point(), point(), point());
}

TEST(ClosestPoint, KnowsEachRegion) {
  const glm::dvec3 a(0.0), b(2, 0, 0), c(0, 2, 0);
  const auto weightsAt = [&](const glm::dvec3& p) { return closestPoint(p, a, b, c).weights; };
  EXPECT_EQ(weightsAt({0.5, 0.5, 3}), glm::dvec3(0.5, 0.25, 0.25));
  EXPECT_EQ(weightsAt({-1, -2, 1}), glm::dvec3(1, 0, 0));
  EXPECT_EQ(weightsAt({5, -1, 1}), glm::dvec3(0, 1, 0));
  EXPECT_EQ(weightsAt({-1, 7, -1}), glm::dvec3(0, 0, 1));
  EXPECT_EQ(weightsAt({1, -1, 1}), glm::dvec3(0.5, 0.5, 0));
  EXPECT_EQ(weightsAt({2, 2, 0}), glm::dvec3(0, 0.5, 0.5));
  EXPECT_EQ(weightsAt({-3, 0.5, 0}), glm::dvec3(0.75, 0, 0.25));
}

TEST(ClosestPoint, IsTheSameToTheBitForManyAtOnce) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  Mesh mesh;
  std::vector<glm::dvec3> points;
  std::vector<uint32_t> triangles;
  for (uint32_t i = 0; i < 1003; ++i) {
    for (int c = 0; c < 3; ++c) mesh.vertices.emplace_back(point());
    if (i % 7 == 3) mesh.vertices.back() = mesh.vertices[3 * i];  // A segment.
    if (i % 7 == 4) mesh.vertices[3 * i + 1] = mesh.vertices.back() = mesh.vertices[3 * i];
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    points.push_back(i % 2 == 0 ? point() : 0.1 * point());
    triangles.push_back(i % 50 == 49 ? kNoTriangle : 1002 - i);
  }
  std::vector<TrianglePoint> closest(points.size());
  findClosestPoints(mesh, points, triangles, closest);
  for (size_t i = 0; i < points.size(); ++i) {
    if (triangles[i] == kNoTriangle) {
      EXPECT_TRUE(std::isnan(closest[i].position.x) && std::isnan(closest[i].weights.z));
      continue;
    }
    const glm::uvec3 face = mesh.triangles[triangles[i]];
    const auto corner = [&](uint32_t v) { return glm::dvec3(mesh.vertices[v]); };
    const TrianglePoint one = closestPoint(points[i], corner(face.x), corner(face.y), corner(face.z));
    ASSERT_EQ(closest[i].position, one.position) << i;
    ASSERT_EQ(closest[i].weights, one.weights) << i;
  }
}

TEST(ClosestPoint, TakesSegmentsPointsAndSlivers) {
  const glm::dvec3 a(1, 2, 3), b(2, 4, 5), middle(1.5, 3, 4);
  for (const glm::dvec3& p : {glm::dvec3(0.0), glm::dvec3(1.6, 3.2, 4.5), glm::dvec3(9, 9, 9)}) {
    expectClosest(p, a, b, middle);
    expectClosest(p, middle, a, b);
    expectClosest(p, a, a, b);
    expectClosest(p, a, a, a);
    expectClosest(p, a, b, middle + glm::dvec3(1e-9, 0, 0));
  }
}

}  // namespace
}  // namespace raymap::cpu
