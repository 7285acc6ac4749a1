#include "simplify/plane_quadric.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace raymap {
namespace {

TEST(PlaneQuadric, GivesTheMeanSquareOfTheDistancesToItsPlanes) {
  struct Plane {
    glm::dvec3 normal, point;
    double weight;
  };
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2.0, 2.0), weight(0.1, 3.0);
  const auto vector = [&] { return glm::dvec3(place(random), place(random), place(random)); };
  std::vector<Plane> planes;
  PlaneQuadric all;
  for (int part = 0; part < 4; ++part) {
    PlaneQuadric some;
    for (int k = 0; k < 3; ++k) {
      const Plane& plane = planes.emplace_back(Plane{glm::normalize(vector()), vector(), weight(random)});
      some.addPlane(plane.normal, plane.point, plane.weight);
    }
    all.add(some);
  }
  for (int k = 0; k < 20; ++k) {
    const glm::dvec3 p = vector();
    double sum = 0.0, weights = 0.0;
    for (const Plane& plane : planes) {
      const double distance = glm::dot(plane.normal, p - plane.point);
      sum += plane.weight * distance * distance;
      weights += plane.weight;
    }
    EXPECT_NEAR(all.meanSquare(p), sum / weights, 1e-12);
  }
  EXPECT_EQ(PlaneQuadric().meanSquare({1, 2, 3}), 0.0);
}

}  // namespace
}  // namespace raymap
