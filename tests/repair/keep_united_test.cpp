#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "closed_mesh.h"
#include "mesh/groups_apart.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::joined;
using shapes::sphere;

constexpr double kBallVolume = 4.0 / 3.0 * std::numbers::pi;

Repaired repairedApart(const Mesh& mesh, const RepairOptions& options = {}) {
  const Grid grid = fitRepairGrid(mesh, {.resolution = 96}, options);
  return repair(mesh, grid, {}, options, {.device = "cpu"});
}

/// Shrinks each face of a mesh towards its centre, so that no faces share corners. They bound a solid still.
Mesh shards(const Mesh& mesh) {
  Mesh apart{.origin = mesh.origin};
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 corners[] = {mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
    const glm::vec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0F;
    const auto first = uint32_t(apart.vertices.size());
    for (const glm::vec3& p : corners) apart.vertices.push_back(centre + 0.8F * (p - centre));
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  return apart;
}

using Corners = std::vector<std::array<float, 3>>;

/// Returns the positions of a face's corners, relative to the origin of a mesh.
Corners cornersOf(const Mesh& mesh, size_t face, const glm::dvec3& origin) {
  Corners corners;
  for (int c = 0; c < 3; ++c) {
    const glm::vec3 p(mesh.position(mesh.triangles[face][c]) - origin);
    corners.push_back({p.x, p.y, p.z});
  }
  return corners;
}

/// Returns how many of the given faces from one on the result has, with equal bits and said to be those.
size_t keptFaces(const Mesh& given, const Repaired& made, size_t first, size_t end) {
  std::set<size_t> kept;
  for (size_t f = 0; f < made.faceSource.size(); ++f) {
    const uint32_t source = made.faceSource[f];
    if (source < first || source >= end) continue;
    EXPECT_LT(source, given.triangles.size());
    if (cornersOf(made.mesh, f, given.origin) == cornersOf(given, source, given.origin)) kept.insert(source);
  }
  return kept.size();
}

void expectSolids(const Repaired& made, size_t solids, double volume, double tolerance = 0.04) {
  const RepairReport& report = made.report;
  EXPECT_TRUE(isClosed(made.mesh));
  EXPECT_EQ(report.crossingAfter.pairs, 0u);
  EXPECT_EQ(report.solids, solids);
  EXPECT_NEAR(report.after.signedVolume, volume, tolerance * volume);
}

TEST(GroupsApart, AreDividedBySlabs) {
  // Slabs across z first, then what lies in them. The last box touches the slab around the third.
  const std::vector<Mesh> boxes{box({0, 0, 0}, {1, 1, 1}), box({0, 0, 2}, {1, 1, 3}),
                                box({2, 0, 2}, {3, 1, 3}), box({2, 1.4, 2}, {3, 3, 3})};
  const Mesh mesh = joined(joined(boxes[0], boxes[1]), joined(boxes[2], boxes[3]));
  const auto sizes = [&](double gap) {
    std::vector<size_t> found;
    uint32_t faces = 0;
    for (const std::vector<uint32_t>& group : groupsApart(mesh, gap)) {
      EXPECT_TRUE(std::ranges::is_sorted(group));
      const Mesh part = partOf(mesh, group);
      EXPECT_EQ(part.triangles.size(), group.size());
      EXPECT_EQ(part.vertices.size(), group.size() / 12 * 8);
      for (size_t f = 0; f < group.size(); ++f)
        EXPECT_EQ(cornersOf(part, f, {}), cornersOf(mesh, group[f], {}));
      found.push_back(group.size());
      faces += uint32_t(group.size());
    }
    EXPECT_EQ(faces, mesh.triangles.size());
    return found;
  };
  EXPECT_EQ(sizes(0.3), (std::vector<size_t>{12, 12, 12, 12}));
  EXPECT_EQ(sizes(0.7), (std::vector<size_t>{12, 12, 24}));
  EXPECT_EQ(sizes(1.2), (std::vector<size_t>{48}));
  EXPECT_EQ(groupsApart(Mesh{}, 1.0).size(), 1u);
}

TEST(GroupsApart, HaveRoomForTheirLastSlab) {
  // The difference of the bounds is rounded down in single precision, to the begin of the last slab.
  std::mt19937 random(3);
  for (int turn = 0; turn < 200; ++turn) {
    const float low = std::ldexp(float(random()), -30), high = low + std::ldexp(float(random()), -31);
    Mesh mesh;
    mesh.vertices = {{low, 0, 0}, {high, 0, 0}, {low, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const double exact = double(high) - double(low);
    EXPECT_EQ(groupsApart(mesh, exact / 1000.0 * 8.0).size(), 1u);
    EXPECT_EQ(groupsApart(mesh, exact / 1e9).size(), 1u);
  }
}

TEST(GroupsApart, AreInTheOrderOfTheirFirstFaces) {
  Mesh mesh = joined(box({5, 0, 0}, {6, 1, 1}), box({0, 0, 0}, {1, 1, 1}));
  std::swap(mesh.triangles[1], mesh.triangles[12]);
  const std::vector<std::vector<uint32_t>> groups = groupsApart(mesh, 1.0);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].front(), 0u);
  EXPECT_EQ(groups[1].front(), 1u);
  EXPECT_EQ(groups[0][1], 2u);
}

TEST(KeepUnited, KeepsABallBesideShards) {
  const Mesh ball = sphere(1.0, 3), broken = shards(sphere(1.0, 3, {5, 0, 0}));
  for (const bool isFirst : {true, false}) {
    const Mesh mesh = isFirst ? joined(ball, broken) : joined(broken, ball);
    const size_t first = isFirst ? 0 : broken.triangles.size();
    const Repaired made = repairedApart(mesh);
    EXPECT_EQ(made.report.depth, RepairDepth::Field);
    EXPECT_EQ(made.report.fieldReason, FieldReason::Sheet);
    EXPECT_EQ(made.report.keptFaces, ball.triangles.size());
    EXPECT_EQ(keptFaces(mesh, made, first, first + ball.triangles.size()), ball.triangles.size());
    EXPECT_EQ(size_t(std::ranges::count(made.faceSource, kNoTriangle)),
              made.mesh.triangles.size() - ball.triangles.size());
    expectSolids(made, 2, 2.0 * kBallVolume);
    EXPECT_LT(made.report.lostShare, 0.01);
    EXPECT_LT(made.report.meshFromResult.max, 0.2);
  }
}

TEST(KeepUnited, KeepsFacesOfABallThatShardsCross) {
  const Mesh ball = sphere(1.0, 3), mesh = joined(shards(sphere(1.0, 3, {1.5, 0, 0})), ball);
  const size_t first = mesh.triangles.size() - ball.triangles.size();
  const Repaired made = repairedApart(mesh);
  EXPECT_EQ(made.report.depth, RepairDepth::Field);
  size_t outside = 0;  // Faces of the ball that are farther from the other one than its plates.
  for (const glm::uvec3& t : ball.triangles) {
    double least = INFINITY;
    for (int c = 0; c < 3; ++c)
      least = std::min(least, glm::distance(ball.position(t[c]), glm::dvec3(1.5, 0, 0)));
    outside += least > 1.15 ? 1 : 0;
  }
  EXPECT_GE(keptFaces(mesh, made, first, mesh.triangles.size()), outside);
  EXPECT_GT(outside, ball.triangles.size() / 2);
  // Both balls without the lens of two caps 0.25 high.
  const double lens = 2.0 * std::numbers::pi * 0.25 * 0.25 * (3.0 - 0.25) / 3.0;
  expectSolids(made, 1, 2.0 * kBallVolume - lens);
}

TEST(KeepUnited, MakesTheSameOfShardsWhateverElseThereIs) {
  // The other balls have most of the area.
  const Mesh balls = joined(sphere(1.0, 3, {0, 0, 5}), sphere(1.0, 3, {5, 0, 5}));
  const Repaired made = repairedApart(joined(balls, shards(sphere(1.0, 2))));
  EXPECT_EQ(made.report.depth, RepairDepth::Field);
  expectSolids(made, 3, 3.0 * kBallVolume);
}

TEST(KeepUnited, TakesWallsThatAreApartForOneSolid) {
  // Each wall alone would be a plate.
  Mesh walls;
  const Mesh solid = box({0, 0, 0}, {4, 4, 4});
  for (size_t f = 0; f < solid.triangles.size(); f += 2) {
    Mesh wall = solid;
    wall.triangles = {solid.triangles[f], solid.triangles[f + 1]};
    glm::vec3 centre(0.0F);
    for (const glm::uvec3& t : wall.triangles)
      for (int c = 0; c < 3; ++c) centre += wall.vertices[t[c]] / 6.0F;
    for (glm::vec3& p : wall.vertices) p = centre + 0.85F * (p - centre);
    walls = joined(walls, wall);
  }
  const Repaired made = repairedApart(joined(walls, box({6, 0, 0}, {7, 1, 1})));
  EXPECT_EQ(made.report.depth, RepairDepth::Field);
  EXPECT_EQ(made.report.fieldReason, FieldReason::Sheet);
  EXPECT_EQ(made.report.keptFaces, 12u);
  expectSolids(made, 2, 65.0, 0.06);
  // The same beside a solid with most of the area.
  const Mesh large = box({6, 0, 0}, {14, 8, 8});
  const Repaired beside = repairedApart(joined(walls, large));
  EXPECT_EQ(beside.report.keptFaces, 12u);
  expectSolids(beside, 2, 576.0, 0.06);
  // A wall beside a solid that is larger is a plate.
  Mesh wall = solid;
  wall.triangles = {solid.triangles[0], solid.triangles[1]};
  EXPECT_EQ(repairedApart(joined(wall, box({6, 0, 0}, {9, 3, 3}))).report.depth, RepairDepth::Mended);
}

TEST(KeepUnited, MendsWhatIsKept) {
  Mesh ball = sphere(1.0, 3);
  ball.triangles.pop_back();
  std::swap(ball.triangles[7].x, ball.triangles[7].y);
  const Mesh broken = shards(sphere(1.0, 3, {5, 0, 0})), mesh = joined(broken, ball);
  const Repaired made = repairedApart(mesh);
  EXPECT_EQ(made.report.depth, RepairDepth::Field);
  EXPECT_EQ(made.report.closedHoles, 1u);
  EXPECT_EQ(made.report.keptFaces, ball.triangles.size() + 1);
  EXPECT_EQ(keptFaces(mesh, made, broken.triangles.size(), mesh.triangles.size()), ball.triangles.size() - 1);
  EXPECT_EQ(made.report.stats.turnedFaces, (std::vector<uint32_t>{uint32_t(broken.triangles.size()) + 7}));
  expectSolids(made, 2, 2.0 * kBallVolume);
}

TEST(KeepUnited, ReportsTurnedFacesOfTheRest) {
  const Mesh ball = sphere(1.0, 3);
  Mesh open = sphere(1.0, 3, {5, 0, 0});
  open.triangles.pop_back();
  std::vector<uint32_t> turned;
  for (uint32_t f = 0; f < open.triangles.size(); ++f) {
    glm::uvec3& t = open.triangles[f];
    if (open.vertices[t.x].z < 0.6F) continue;
    std::swap(t.x, t.y);
    turned.push_back(f + uint32_t(ball.triangles.size()));
  }
  const Repaired made = repairedApart(joined(ball, open), {.closeHoles = false});
  EXPECT_EQ(made.report.fieldReason, FieldReason::Open);
  EXPECT_EQ(made.report.stats.turnedFaces, turned);
  EXPECT_EQ(made.report.keptFaces, ball.triangles.size());
  expectSolids(made, 2, 2.0 * kBallVolume);
}

TEST(KeepUnited, MakesAllFacesFromAFieldIfTheyAreSimplifiedOrSheetsGetNoThickness) {
  const Mesh mesh = joined(sphere(1.0, 3), shards(sphere(1.0, 2, {5, 0, 0})));
  for (const RepairOptions& options : {RepairOptions{.minThickness = 0.0}, RepairOptions{.tolerance = 0.01},
                                       RepairOptions{.triangles = 900}}) {
    const Repaired made = repairedApart(mesh, options);
    EXPECT_EQ(made.report.depth, RepairDepth::Field);
    EXPECT_EQ(made.report.keptFaces, 0u);
    EXPECT_TRUE(made.faceSource.empty());
    EXPECT_TRUE(isClosed(made.mesh));
  }
}

TEST(KeepUnited, CountsSharesOfTheWholeArea) {
  // A third of the shards' area is within the other ball of shards.
  const Mesh broken = joined(shards(sphere(1.0, 3)), shards(sphere(1.0, 3, {4.0 / 3.0, 0, 0})));
  const double alone = repairedApart(broken).report.buriedShare;
  EXPECT_NEAR(alone, 1.0 / 6.0, 0.03);
  const Mesh mesh = joined(broken, sphere(std::sqrt(2.0 * 0.64), 4, {0, 0, 5}));
  EXPECT_NEAR(repairedApart(mesh).report.buriedShare, 0.5 * alone, 0.02);
}

TEST(KeepUnited, MeasuresNothingIfNotAsked) {
  const Mesh ball = sphere(1.0, 3), mesh = joined(ball, shards(sphere(1.0, 3, {5, 0, 0})));
  const Repaired made = repairedApart(mesh, {.measure = false});
  EXPECT_EQ(keptFaces(mesh, made, 0, ball.triangles.size()), ball.triangles.size());
  EXPECT_EQ(made.report.solids, 2u);
  EXPECT_EQ(made.report.after.triangles, 0u);
}

}  // namespace
}  // namespace raymap
