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

}  // namespace
}  // namespace raymap
