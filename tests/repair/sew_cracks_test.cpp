#include "repair/topology/sew_cracks.h"

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/repair.h>

#include <functional>
#include <map>
#include <utility>

#include "shapes.h"

namespace raymap {
namespace {

/// Gives each region of faces vertices of its own, moved by `move(region)`.
Mesh loosened(const Mesh& mesh, const std::function<int(const glm::dvec3&)>& regionOf,
              const std::function<glm::vec3(int)>& move) {
  Mesh loose{.vertices = mesh.vertices, .origin = mesh.origin};
  std::map<std::pair<int, uint32_t>, uint32_t> moved;
  for (glm::uvec3 t : mesh.triangles) {
    const int region = regionOf((mesh.position(t.x) + mesh.position(t.y) + mesh.position(t.z)) / 3.0);
    for (int c = 0; c < 3 && region > 0; ++c) {
      const auto [place, isNew] = moved.try_emplace({region, t[c]}, uint32_t(loose.vertices.size()));
      if (isNew) loose.vertices.push_back(mesh.vertices[t[c]] + move(region));
      t[c] = place->second;
    }
    loose.triangles.push_back(t);
  }
  return loose;
}

int capOf(const glm::dvec3& p) {
  return p.z > 0.3 ? 1 : 0;
}

TEST(SewCracks, JoinsRegionsThatCameLoose) {
  const Mesh ball = shapes::sphere(1.0, 3);
  const Mesh loose = loosened(ball, capOf, [](int) { return glm::vec3(1e-3f, 2e-3f, -1e-3f); });
  const size_t rim = diagnose(loose).boundaryEdges / 2;
  ASSERT_GT(rim, 20u);
  Mesh sewn = loose;
  EXPECT_EQ(sewCracks(sewn, widestCrack(sewn)), rim);
  const Diagnostics found = diagnose(sewn);
  EXPECT_TRUE(found.watertight);
  EXPECT_TRUE(found.consistentlyOriented);
  EXPECT_EQ(found.triangles, ball.triangles.size());
  for (size_t f = 0; f < ball.triangles.size(); ++f) {  // The region that did not move keeps its bits.
    const glm::uvec3 &t = sewn.triangles[f], &given = ball.triangles[f];
    if (loose.triangles[f] != given) continue;
    for (int c = 0; c < 3; ++c) EXPECT_EQ(sewn.vertices[t[c]], ball.vertices[given[c]]);
  }
  const Repaired made = repair(loose, fitRepairGrid(loose, {.resolution = 16}));
  EXPECT_EQ(made.report.depth, RepairDepth::Mended);
  EXPECT_EQ(made.report.sewnVertices, rim);
  EXPECT_EQ(made.report.closedHoles, 0u);
  EXPECT_NEAR(made.report.after.signedVolume, diagnose(ball).signedVolume, 5e-3);
}

TEST(SewCracks, JoinsRegionsThatMeetAtOnePlace) {
  const Mesh ball = shapes::sphere(1.0, 3);
  const auto octant = [](const glm::dvec3& p) {
    return 1 + (p.x > 0.01 ? 1 : 0) + (p.y > 0.01 ? 2 : 0) + (p.z > 0.01 ? 4 : 0);
  };
  Mesh sewn = loosened(ball, octant, [](int region) {
    return 4e-4f * (2.0f * glm::vec3(region & 1, region >> 1 & 1, region >> 2 & 1) - 1.0f);
  });
  ASSERT_EQ(diagnose(sewn).components, 8u);
  sewCracks(sewn, widestCrack(sewn));
  EXPECT_TRUE(diagnose(sewn).watertight);
  EXPECT_EQ(diagnose(sewn).components, 1u);
}

TEST(SewCracks, LeavesWhatIsFartherApart) {
  const Mesh ball = shapes::sphere(1.0, 3), coarse = shapes::sphere(1.0, 1);
  const auto apart = [](float distance) { return [=](int) { return glm::vec3(0.0f, 0.0f, distance); }; };
  const double diagonal = glm::length(bounds(ball).size());
  for (const double share : {1.8e-3, 2.2e-3}) {
    Mesh lifted = loosened(coarse, capOf, apart(float(share * diagonal)));
    EXPECT_EQ(sewCracks(lifted, widestCrack(lifted)) > 0, share < 2e-3) << share;
  }
  // Edges on a fine rim are shorter than the gap is wide.
  Mesh fine = loosened(shapes::sphere(1.0, 7), capOf, apart(float(1.8e-3 * diagonal)));
  ASSERT_GT(diagnose(fine).boundaryEdges, 1000u);
  EXPECT_LT(sewCracks(fine, widestCrack(fine)), diagnose(fine).boundaryEdges / 8);
  Mesh hole = ball;
  hole.triangles.erase(hole.triangles.begin(), hole.triangles.begin() + 7);
  EXPECT_EQ(sewCracks(hole, widestCrack(hole)), 0u);
}

}  // namespace
}  // namespace raymap
