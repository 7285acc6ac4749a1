#include "cpu/sign/winding_rims.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "broken_meshes.h"
#include "mesh/rim_edges.h"
#include "predicates/segment_triangle.h"
#include "random_points.h"
#include "reference.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap {

using namespace cpu;
namespace {

WindingRims rimsOf(const Mesh& mesh) {
  std::vector<RimLine> rims;
  for (const RimEdge& edge : findRimEdges(mesh, fitGrid(mesh, {.resolution = 30}).spacing))
    rims.insert(rims.end(), edge.times, RimLine{mesh.vertices[edge.from], mesh.vertices[edge.to]});
  return WindingRims(rims);
}

/// Returns the crossings of a ray that ends outside of the mesh, `kUnsure` if rounding could change them.
int32_t crossingsOf(const Mesh& mesh, const glm::dvec3& p, const glm::dvec3& direction) {
  int32_t sum = 0;
  const glm::dvec3 outside = p + 3.0 * diagonal(mesh) * direction;
  for (const glm::uvec3& t : mesh.triangles) {
    const int32_t crossing =
        crossSegment(mesh.position(t.x), mesh.position(t.y), mesh.position(t.z), outside, p);
    if (crossing == kUnsure) return kUnsure;
    sum += crossing;
  }
  return sum;
}

glm::dvec3 randomDirection(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

Mesh bowl(size_t copies) {
  const Mesh sphere = shapes::sphere(1.0, 2);
  const Mesh one = keepTriangles(sphere, [&](const glm::uvec3& t) {
    return std::min({sphere.position(t.x).z, sphere.position(t.y).z, sphere.position(t.z).z}) < -0.2;
  });
  Mesh result = one;
  for (size_t i = 1; i < copies; ++i)
    result.triangles.insert(result.triangles.end(), one.triangles.begin(), one.triangles.end());
  return result;
}

TEST(WindingRims, CompleteTheCrossingsOfAnyRay) {
  std::mt19937_64 random(7);
  for (const Mesh& mesh :
       {bowl(1), bowl(9), withHoles(shapes::sphere(1.0, 3), 3, 0.08, 1), shapes::soup(40, 1),
        withFlippedFaces(shapes::torus(1.0, 0.3, 20, 10), 0.2, 1),
        makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.3}}, {{0, 1, 2}})}) {
    const WindingRims rims = rimsOf(mesh);
    size_t compared = 0;
    for (const glm::dvec3& p : uniformPoints(mesh, 300, 0.5)) {
      const glm::dvec3 direction = randomDirection(random);
      const int32_t crossings = crossingsOf(mesh, p, direction);
      const RimShare share = rims.at(p - mesh.origin, direction);
      if (crossings == kUnsure || share.clearance < 1e-4) continue;
      ++compared;
      ASSERT_NEAR(crossings + share.winding, reference::windingNumber(mesh, p), 1e-12) << rims.count();
    }
    EXPECT_GT(compared, 290u);
  }
}

TEST(WindingRims, AreNothingOnClosedMeshes) {
  const RimShare share = rimsOf(shapes::sphere(1.0, 2)).at({0.1, 0.2, 0.3}, {1, 0, 0});
  EXPECT_EQ(share.winding, 0.0);
  EXPECT_EQ(share.clearance, 4.0);
}

TEST(WindingRims, SayHowFarTheRayPassesThem) {
  const std::vector<RimLine> rims{{{2, -1, 0}, {2, 1, 0}}};
  const WindingRims one(rims);
  EXPECT_EQ(one.at({0, 0, 0}, {1, 0, 0}).clearance, 0.0);
  EXPECT_LT(one.at({0, 0, 1e-9}, {1, 0, 0}).clearance, 1e-8);
  EXPECT_GT(one.at({0, 0, 1e-3}, {1, 0, 0}).clearance, 1e-5);
  EXPECT_GT(one.at({0, 0, 0}, {-1, 0, 0}).clearance, 1.0);
  EXPECT_TRUE(std::isfinite(one.at({2, 1, 0}, {-1, 0, 0}).winding));  // At an end.
  // A ray that passes it on the other side sees one crossing less.
  const double above = one.at({0, 0, 1e-3}, {1, 0, 0}).winding,
               below = one.at({0, 0, -1e-3}, {1, 0, 0}).winding;
  EXPECT_NEAR(std::abs(above - below), 1.0, 1e-2);
}

TEST(WindingRims, DoNotDependOnUnits) {
  const Mesh mesh = bowl(2);
  const std::vector<glm::dvec3> points = uniformPoints(mesh, 50, 0.5);
  const WindingRims rims = rimsOf(mesh);
  for (const int exponent : {-100, 100}) {
    Mesh scaled = mesh;
    const double unit = std::ldexp(1.0, exponent);
    for (glm::vec3& v : scaled.vertices) v *= float(unit);
    for (const glm::dvec3& p : points)
      for (const double allowed : {0.0, 1e-3})
        EXPECT_NEAR(rimsOf(scaled).at(unit * p, {0, 0, 1}, allowed).winding,
                    rims.at(p, {0, 0, 1}, allowed).winding, allowed + 1e-13);
  }
}

TEST(WindingRims, KeepToTheErrorThatIsAllowed) {
  std::mt19937_64 random(3);
  const Mesh sphere = shapes::sphere(1.0, 4);
  for (const Mesh& mesh : {bowl(1), withMissingFaces(sphere, 0.3, 1), shapes::soup(300, 1)}) {
    const WindingRims rims = rimsOf(mesh);
    std::vector<glm::dvec3> points = uniformPoints(mesh, 500, 0.5);
    const std::vector<glm::dvec3> near = nearPoints(mesh, 500, 1e-3);
    points.insert(points.end(), near.begin(), near.end());
    for (const double allowed : {0.1, 1e-3, 9e-7}) {
      double largest = 0.0;
      for (const glm::dvec3& p : points) {
        const glm::dvec3 direction = randomDirection(random);
        const RimShare exact = rims.at(p - mesh.origin, direction);
        if (exact.clearance < 1e-9) continue;
        largest =
            std::max(largest, std::abs(rims.at(p - mesh.origin, direction, allowed).winding - exact.winding));
      }
      EXPECT_LE(largest, allowed) << rims.count();
    }
  }
}

/// Returns a random point of a ball.
glm::dvec3 pointInBall(std::mt19937_64& random, const glm::dvec3& centre, double radius) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  return centre + radius * std::cbrt(unit(random)) * randomDirection(random);
}

TEST(WindingRims, ChangeByTheirSlopeWithinTheBound) {
  std::mt19937_64 random(5);
  constexpr glm::dvec3 kRay(0.36, 0.48, 0.8);
  for (const Mesh& mesh : {bowl(1), bowl(3), withMissingFaces(shapes::sphere(1.0, 3), 0.2, 1),
                           shapes::soup(300, 1), shapes::soup(2000, 2)}) {
    const WindingRims rims = rimsOf(mesh);
    size_t bounded = 0, bent = 0;
    for (const glm::dvec3& at : uniformPoints(mesh, 300, 0.5)) {
      const glm::dvec3 centre = at - mesh.origin;
      for (const double radius : {0.3, 0.03, 3e-3, 3e-4}) {
        const RimChange change = rims.changeIn(centre, radius);
        if (change.bend > 0.4) continue;
        ++bounded;
        if (change.slope != glm::dvec3(0.0)) ++bent;
        for (int pair = 0; pair < 10; ++pair) {
          const glm::dvec3 a = pointInBall(random, centre, radius), b = pointInBall(random, centre, radius);
          const double found = rims.at(b, kRay).winding - rims.at(a, kRay).winding,
                       left = found - glm::dot(change.slope, b - a);
          ASSERT_LE(std::abs(left - std::round(left)), change.bend + 1e-9) << rims.count() << ", " << radius;
        }
      }
    }
    EXPECT_GT(bounded, 100u) << rims.count();
    EXPECT_EQ(bent > 0, rims.count() <= 4096) << rims.count();
  }
}

TEST(WindingRims, BendLessInSmallerBalls) {
  const WindingRims rims = rimsOf(bowl(1));
  const RimChange large = rims.changeIn({0.1, 0.2, 0.9}, 0.02), small = rims.changeIn({0.1, 0.2, 0.9}, 0.01);
  EXPECT_GT(glm::length(large.slope), 0.05);
  EXPECT_LT(glm::distance(large.slope, small.slope), 1e-6);
  EXPECT_LT(small.bend, 0.3 * large.bend);
  EXPECT_LT(large.bend, 0.002);
}

TEST(WindingRims, SayNothingOfABallThatARimMayMeet) {
  for (const size_t triangles : {1, 2000}) {
    const Mesh mesh = shapes::soup(triangles, 4);
    const glm::dvec3 corner(mesh.vertices[mesh.triangles[0].x]);
    EXPECT_TRUE(std::isinf(rimsOf(mesh).changeIn(corner + glm::dvec3(1e-3, 0, 0), 2e-3).bend));
  }
  const RimChange nothing = WindingRims().changeIn({0, 0, 0}, 1.0);
  EXPECT_EQ(nothing.bend, 0.0);
  EXPECT_EQ(nothing.slope, glm::dvec3(0.0));
}

TEST(WindingRims, ChangeAlikeInAnyUnit) {
  const Mesh mesh = bowl(1);
  const RimChange change = rimsOf(mesh).changeIn({0.1, 0.2, 0.9}, 0.1);
  for (const int exponent : {-100, 100}) {
    Mesh scaled = mesh;
    const double unit = std::ldexp(1.0, exponent);
    for (glm::vec3& v : scaled.vertices) v *= float(unit);
    const RimChange same = rimsOf(scaled).changeIn(unit * glm::dvec3(0.1, 0.2, 0.9), 0.1 * unit);
    EXPECT_NEAR(same.bend, change.bend, 1e-6);
    EXPECT_LT(glm::distance(unit * same.slope, change.slope), 1e-6);
  }
}

}  // namespace
}  // namespace raymap
