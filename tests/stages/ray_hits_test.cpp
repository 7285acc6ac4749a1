#include "cpu/points/ray_hits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "shapes.h"

namespace raymap::cpu {
namespace {

std::vector<RayHit> hitsOf(const Mesh& mesh, const glm::dvec3& from, const glm::dvec3& direction,
                           const Turns& turns = {}) {
  std::vector<uint32_t> faces(mesh.triangles.size());
  std::iota(faces.begin(), faces.end(), 0u);
  std::vector<RayHit> hits;
  findRayHits(mesh, turns, faces, from - mesh.origin, glm::normalize(direction), hits);
  return hits;
}

/// Distance along a ray by Cramer's rule, or a negative number.
double distanceTo(const Mesh& mesh, const glm::uvec3& t, const glm::dvec3& from, const glm::dvec3& d) {
  const glm::dvec3 a = mesh.position(t.x), u = mesh.position(t.y) - a, v = mesh.position(t.z) - a;
  const glm::dmat3 m(u, v, -d);
  const glm::dvec3 s = glm::inverse(m) * (from - a);
  return s.x >= 0.0 && s.y >= 0.0 && s.x + s.y <= 1.0 ? s.z : -1.0;
}

TEST(RayHits, AreThoseOfEachFace) {
  const Mesh mesh = shapes::soup(400, 2);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  size_t total = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 from = 0.5 + 0.5 * glm::dvec3(unit(random), unit(random), unit(random));
    const glm::dvec3 d = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)));
    const std::vector<RayHit> hits = hitsOf(mesh, from, d);
    size_t expected = 0;
    for (const glm::uvec3& t : mesh.triangles) expected += distanceTo(mesh, t, from, d) >= 0.0;
    ASSERT_EQ(hits.size(), expected);
    total += expected;
    for (size_t k = 0; k < hits.size(); ++k) {
      const glm::uvec3& t = mesh.triangles[hits[k].triangle];
      const glm::dvec3 a = mesh.position(t.x);
      const glm::dvec3 n = glm::normalize(glm::cross(mesh.position(t.y) - a, mesh.position(t.z) - a));
      EXPECT_NEAR(hits[k].distance, distanceTo(mesh, t, from, d), 1e-9);
      EXPECT_GT(glm::dot(hits[k].normal, d), 0.0);
      EXPECT_NEAR(std::abs(glm::dot(hits[k].normal, n)), 1.0, 1e-12);
      EXPECT_EQ(hits[k].change, glm::dot(n, d) > 0.0 ? -1 : 1);
      EXPECT_LE(hits[k == 0 ? 0 : k - 1].distance, hits[k].distance);
    }
  }
  EXPECT_GT(total, 1000u);
}

TEST(RayHits, PassEdgesAndVerticesOnce) {
  const Mesh mesh = shapes::box({-1, -1, -1}, {1, 1, 1});
  // Through the middles of sides, which lie on diagonals, through corners and through edges.
  for (const glm::dvec3 d : {glm::dvec3(1, 0, 0),
                             {0, -1, 0},
                             {0, 0, 1},
                             {1, 1, 1},
                             {-1, 1, -1},
                             {1, 1, 0},
                             {0, 1, -1},
                             {-1, 0, 1},
                             {1, 1, 0.5}}) {
    const std::vector<RayHit> hits = hitsOf(mesh, {0, 0, 0}, d);
    ASSERT_EQ(hits.size(), 1u) << d.x << " " << d.y << " " << d.z;
    EXPECT_EQ(hits[0].change, -1);
    const glm::dvec3 end = hits[0].distance * glm::normalize(d);
    EXPECT_NEAR(std::max({std::abs(end.x), std::abs(end.y), std::abs(end.z)}), 1.0, 1e-9);
  }
  // From outside, a closed surface is entered as often as it is left.
  for (const double y : {-1.0, -0.5, 0.0, 1.0})
    for (const double z : {-1.0, 0.0, 0.25, 1.0}) {
      int sum = 0;
      for (const RayHit& hit : hitsOf(mesh, {-3, y, z}, {1, 0, 0})) sum += hit.change;
      EXPECT_EQ(sum, 0) << y << " " << z;
    }
}

TEST(RayHits, TakeFacesAsTurned) {
  const Mesh mesh = makeMesh(std::vector<glm::dvec3>{{-1, -1, 1}, {3, -1, 1}, {-1, 3, 1}}, {{0, 1, 2}});
  const auto changeOf = [&](const Turns& turns) {
    return hitsOf(mesh, {0, 0, 0}, {0, 0, 1}, turns)[0].change;
  };
  EXPECT_EQ(changeOf({}), -1);
  EXPECT_EQ(changeOf({kAsGiven}), -1);
  EXPECT_EQ(changeOf({kReversed}), 1);
  EXPECT_TRUE(hitsOf(mesh, {0, 0, 0}, {0, 0, 1}, {kLeftOut}).empty());
  EXPECT_TRUE(hitsOf(mesh, {0, 0, 0}, {0, 0, -1}).empty());
}

}  // namespace
}  // namespace raymap::cpu
