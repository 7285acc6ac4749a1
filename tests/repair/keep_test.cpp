#include "repair/topology/mend.h"

#include <gtest/gtest.h>
#include <raymap/error.h>

#include "broken_meshes.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::joined;

constexpr double kOddSpacing = 0.0937;  // No face lies on samples.

Repaired repaired(const Mesh& mesh, const RepairOptions& options = {}, const WarningCallback& warn = {}) {
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = kOddSpacing}, options);
  return repair(mesh, grid, {}, options, {.device = "cpu", .warn = warn});
}

Mesh ball() {
  return shapes::sphere(1.0, 3);
}

/// Gives every face corners of its own, as a STL has.
Mesh unwelded(const Mesh& mesh) {
  Mesh result{.origin = mesh.origin};
  for (const glm::uvec3& t : mesh.triangles) {
    const auto first = uint32_t(result.vertices.size());
    for (int c = 0; c < 3; ++c) result.vertices.push_back(mesh.vertices[t[c]]);
    result.triangles.emplace_back(first, first + 1, first + 2);
  }
  return result;
}

TEST(Keep, LeavesARightMeshAsItIs) {
  const Mesh mesh = ball();
  const Repaired kept = repaired(mesh);
  EXPECT_TRUE(kept.report.keepsFaces());
  EXPECT_EQ(kept.mesh.vertices, mesh.vertices);
  EXPECT_EQ(kept.mesh.triangles, mesh.triangles);
  EXPECT_EQ(kept.mesh.origin, mesh.origin);
  EXPECT_EQ(kept.report.solids, 1u);
  EXPECT_EQ(kept.report.cavities, 0u);
  EXPECT_EQ(kept.report.after.triangles, mesh.triangles.size());
  EXPECT_EQ(kept.report.after.signedVolume, kept.report.before.signedVolume);
  ASSERT_EQ(kept.report.stats.stages.size(), 1u);  // No field is made.
  EXPECT_EQ(kept.report.stats.stages[0].name, "inspect");
  const Repaired unmeasured = repaired(mesh, {.measure = false});
  EXPECT_TRUE(unmeasured.report.keepsFaces());
  EXPECT_EQ(unmeasured.mesh.triangles, mesh.triangles);
}

TEST(Keep, JoinsVerticesAtEqualPositions) {
  const Mesh mesh = ball();
  const Mesh split = unwelded(mesh);
  const Repaired kept = repaired(split);
  EXPECT_TRUE(kept.report.keepsFaces());
  EXPECT_EQ(kept.mesh.vertices.size(), mesh.vertices.size());
  ASSERT_EQ(kept.mesh.triangles.size(), split.triangles.size());
  for (size_t f = 0; f < split.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(kept.mesh.vertices[kept.mesh.triangles[f][c]], split.vertices[split.triangles[f][c]]);
}

TEST(Keep, MakesAMeshAnewOnRequestOrForAChange) {
  const Mesh mesh = ball();
  for (const RepairOptions& options :
       {RepairOptions{.remesh = true}, RepairOptions{.offset = 0.1}, RepairOptions{.offset = -0.1},
        RepairOptions{.shell = 0.3}, RepairOptions{.remesh = true, .measure = false}}) {
    const Repaired made = repaired(mesh, options);
    EXPECT_FALSE(made.report.keepsFaces());
    EXPECT_NE(made.mesh.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(made.report.solids, 1u);
    EXPECT_EQ(made.report.cavities, options.shell > 0.0 ? 1u : 0u);
  }
}

TEST(Keep, RepairsWhatIsWrong) {
  Mesh open = ball();
  open.triangles.pop_back();
  const Mesh crossing = joined(ball(), shapes::sphere(1.0, 3, {1, 0, 0}));
  for (const Mesh& mesh : {open, shapes::inverted(ball()), crossing}) {
    const Repaired made = repaired(mesh, {.closeHoles = false});
    EXPECT_EQ(made.report.keepsFaces(), made.report.before.watertight);
    EXPECT_EQ(made.report.unitedFaces > 0, made.report.before.signedVolume > 5.0);  // The crossing balls.
    EXPECT_FALSE(made.report.partsOverlap);
    EXPECT_TRUE(made.report.after.watertight);
    EXPECT_GT(made.report.after.signedVolume, 3.9);
  }
}

TEST(Keep, FillsHolesIfNothingIsWrongThen) {
  const auto closed = [](const Mesh& mesh, RepairOptions options = {}, bool closeHoles = true) {
    const Grid grid = fitRepairGrid(mesh, {.voxelSize = kOddSpacing}, options);
    options.closeHoles = closeHoles;
    return repair(mesh, grid, {}, options, {.device = "cpu"});
  };
  Mesh open = ball();
  open.triangles.erase(open.triangles.begin() + 100, open.triangles.begin() + 103);
  const Repaired made = closed(unwelded(open));
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_EQ(made.report.closedHoles, 3u);
  EXPECT_EQ(made.report.closingFaces, 3u);
  ASSERT_EQ(made.mesh.triangles.size(), ball().triangles.size());
  for (size_t f = 0; f < open.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(made.mesh.vertices[made.mesh.triangles[f][c]], open.vertices[open.triangles[f][c]]);
  EXPECT_TRUE(made.report.after.watertight);
  EXPECT_EQ(made.report.crossingAfter.pairs, 0u);
  EXPECT_EQ(made.report.solids, 1u);
  EXPECT_FALSE(closed(open, {.remesh = true}).report.keepsFaces());
  EXPECT_FALSE(closed(open, {}, false).report.keepsFaces());
  // Something crosses what fills the hole, or lies behind it: the union stays.
  const Mesh bowl = keepTriangles(ball(), [&](const glm::uvec3& t) { return ball().position(t.x).z < 0.5; });
  EXPECT_TRUE(closed(bowl).report.keepsFaces());
  const Mesh crossed = joined(bowl, shapes::sphere(0.25, 2, {0, 0, 0.5}));
  EXPECT_EQ(findSelfIntersections(crossed).pairs, 0u);
  const Mesh behind = joined(bowl, shapes::sphere(0.2, 2));
  const double volume = closed(bowl).report.after.signedVolume,
               small = closed(crossed).report.after.signedVolume;
  EXPECT_TRUE(closed(shapes::inverted(open)).report.keepsFaces());
  for (const Mesh& mesh : {crossed, behind}) {
    const Repaired other = closed(mesh);
    EXPECT_TRUE(other.report.keepsFaces());
    EXPECT_FALSE(other.report.partsOverlap);
    EXPECT_EQ(other.report.closedHoles, 1u);
    EXPECT_TRUE(other.report.after.watertight);
    EXPECT_EQ(other.report.crossingAfter.pairs, 0u);
  }
  EXPECT_NEAR(closed(behind).report.after.signedVolume, volume, 1e-6);
  EXPECT_GT(small, volume + 0.005);  // A part of the small ball, 0.063: the hole is closed by a dome.
  EXPECT_LT(small, volume + 0.06);
}

TEST(Keep, RepairsPartsThatOverlapOrFaceTheWrongWay) {
  const Mesh big = box(glm::dvec3(0), glm::dvec3(3)), small = box(glm::dvec3(1), glm::dvec3(2));
  const Mesh onTop = box({0, 0, 1.5}, {3, 3, 5});
  EXPECT_TRUE(repaired(joined(big, shapes::inverted(small))).report.keepsFaces());
  for (const Mesh& mesh : {joined(big, small), joined(big, onTop)}) {
    const Repaired made = repaired(mesh);
    EXPECT_TRUE(made.report.keepsFaces());
    EXPECT_TRUE(made.report.partsOverlap);
    EXPECT_NEAR(made.report.after.signedVolume, made.report.after.bounds.max.z * 9.0, 1e-4);
    EXPECT_EQ(made.report.solids, 1u);
  }
  const Mesh apart = joined(big, box(glm::dvec3(4), glm::dvec3(5)));
  EXPECT_TRUE(repaired(apart).report.keepsFaces());
  const Repaired turned = repaired(joined(big, shapes::inverted(box(glm::dvec3(4), glm::dvec3(5)))));
  EXPECT_TRUE(turned.report.keepsFaces());
  EXPECT_EQ(turned.report.stats.turnedFaces.size(), 12u);
  EXPECT_NEAR(turned.report.after.signedVolume, 28.0, 1e-4);
}

TEST(Keep, DropsFromARightMeshOnlyWhatIsAskedFor) {
  const Mesh crumb = box({4, 0, 0}, {4.2, 0.2, 0.2});
  const Mesh hollow =
      joined(box(glm::dvec3(0), glm::dvec3(3)), shapes::inverted(box(glm::dvec3(1), glm::dvec3(2))));
  const Mesh mesh = joined(hollow, crumb);
  std::vector<WarningCode> warnings;
  const auto warn = [&](const Warning& warning) { warnings.push_back(warning.code); };
  const Repaired all = repaired(mesh, {}, warn);
  EXPECT_EQ(all.mesh.triangles, mesh.triangles);
  EXPECT_EQ(all.report.dropped.count, 0u);
  EXPECT_EQ(all.report.solids, 2u);
  EXPECT_EQ(all.report.cavities, 1u);
  EXPECT_EQ(warnings.size(), 1u);
  const Repaired less = repaired(mesh, {.dropSmaller = 0.1}, warn);
  EXPECT_TRUE(less.report.keepsFaces());
  EXPECT_EQ(less.mesh.triangles, hollow.triangles);
  EXPECT_EQ(less.report.dropped.count, 1u);
  EXPECT_NEAR(less.report.dropped.volume, 0.008, 1e-6);
  EXPECT_EQ(less.report.dropSmaller, 0.1);
  EXPECT_EQ(less.report.solids, 1u);
  EXPECT_EQ(less.report.cavities, 1u);
  EXPECT_EQ(less.report.after.triangles, 24u);
  const Repaired none = repaired(mesh, {.dropSmaller = 0.0}, warn);
  EXPECT_EQ(none.mesh.triangles, mesh.triangles);
  EXPECT_EQ(warnings.size(), 1u);
  EXPECT_THROW(repaired(mesh, {.dropSmaller = 100.0}), Error);
  EXPECT_THROW(repaired(mesh, {.dropSmaller = -1.0}), Error);
}

TEST(Keep, TakesNoMeshForRightThatEnclosesNothing) {
  Diagnostics found = diagnose(box(glm::dvec3(0), glm::dvec3(2)));
  EXPECT_TRUE(looksRight(found));
  found.signedVolume = 0.0;
  EXPECT_FALSE(looksRight(found));
}

/// A cube with a bubble, and a crumb beside it.
Mesh cubeAndCrumb() {
  const Mesh bubble = shapes::inverted(shapes::sphere(0.5, 3, {1.5, 1.5, 1.5}));
  return joined(joined(box(glm::dvec3(0), glm::dvec3(3)), bubble), shapes::sphere(0.15, 2, {4, 1, 1}));
}

TEST(Repair, DropsCrumbsAndFillsBubbles) {
  const Repaired made = repaired(cubeAndCrumb(), {.dropSmaller = 0.1, .remesh = true, .tolerance = 0.0});
  const RepairReport& report = made.report;
  EXPECT_EQ(report.solids, 1u);
  EXPECT_EQ(report.cavities, 0u);
  EXPECT_EQ(report.dropped.count, 1u);
  EXPECT_NEAR(report.dropped.volume, 4.18879 * 0.003375, 0.002);
  EXPECT_EQ(report.filled.count, 1u);
  EXPECT_NEAR(report.filled.volume, 4.18879 * 0.125, 0.02);
  EXPECT_NEAR(report.after.signedVolume, 27.0, 0.01);
  EXPECT_EQ(report.after.components, 1u);
  EXPECT_EQ(report.crossingAfter.pairs, 0u);
  // The bubble's points lie inside, the crumb's outside; neither is missed by the result.
  EXPECT_GT(report.buriedShare, 0.05);
  EXPECT_GT(report.lostShare, 0.004);
  // Other samples would not keep what was dropped on purpose.
  EXPECT_EQ(report.loss.voxelSize, 0.0);
  EXPECT_EQ(report.loss.solidShare, 0.0);
  EXPECT_GT(report.loss.droppedShare, 0.0);
  EXPECT_EQ(report.loss.droppedShare, report.lostShare);
  EXPECT_LT(report.keptFromResult.max, 0.5 * kOddSpacing);
}

TEST(Repair, DropsByDefaultOnlyWhatShowsNothingOfTheMesh) {
  // The ball encloses less than a thousandth of the cube, but nothing else shows it.
  const Mesh mesh = joined(box(glm::dvec3(0), glm::dvec3(4)), shapes::sphere(0.2, 3, {6, 2, 2}));
  const Repaired made = repaired(mesh, {.remesh = true});
  EXPECT_EQ(made.report.solids, 2u);
  EXPECT_EQ(made.report.dropped.count, 0u);
  EXPECT_EQ(made.report.lostShare, 0.0);
  EXPECT_TRUE(made.report.warnings.empty());
  const Repaired asked = repaired(mesh, {.dropSmaller = 0.05, .remesh = true});
  EXPECT_EQ(asked.report.solids, 1u);
  EXPECT_EQ(asked.report.dropped.count, 1u);
  EXPECT_GT(asked.report.loss.droppedShare, 1e-3);
}

TEST(Repair, NeedsAWayDown) {
  EXPECT_THROW(repaired(ball(), {.down = glm::dvec3(0.0), .remesh = true}), Error);
}

TEST(Repair, KeepsCrumbsAndBubblesOnRequest) {
  const Repaired made = repaired(cubeAndCrumb(), {.dropSmaller = 0.0, .keepCavities = true, .remesh = true});
  EXPECT_EQ(made.report.solids, 2u);
  EXPECT_EQ(made.report.cavities, 1u);
  EXPECT_EQ(made.report.dropped.count + made.report.filled.count, 0u);
  EXPECT_EQ(made.report.after.components, 3u);
}

TEST(Repair, HollowsOutWhatIsLeftWithoutBubbles) {
  const Repaired made = repaired(cubeAndCrumb(), {.shell = 0.4, .dropSmaller = 0.1});
  EXPECT_EQ(made.report.solids, 1u);
  EXPECT_EQ(made.report.cavities, 1u);
  EXPECT_EQ(made.report.hollows, 1u);
  EXPECT_NEAR(made.report.after.signedVolume, 27.0 - 2.2 * 2.2 * 2.2, 0.05);
  const Mesh bubbly =
      joined(box(glm::dvec3(0), glm::dvec3(3)), shapes::inverted(shapes::sphere(0.5, 3, {1.5, 1.5, 1.5})));
  const Repaired alone = repaired(bubbly, {.shell = 0.4});
  EXPECT_EQ(alone.report.filled.count, 1u);
  EXPECT_EQ(alone.report.dropped.count, 0u);
  EXPECT_NEAR(alone.report.after.signedVolume, 27.0 - 2.2 * 2.2 * 2.2, 0.1);
  const Repaired bubble = repaired(cubeAndCrumb(), {.shell = 0.4, .dropSmaller = 0.1, .keepCavities = true});
  // The bubble's wall is a ball of 0.9 with a cavity of 0.5 in the hollow.
  EXPECT_EQ(bubble.report.solids, 2u);
  EXPECT_EQ(bubble.report.cavities, 2u);
  EXPECT_NEAR(bubble.report.after.signedVolume, 27.0 - 2.2 * 2.2 * 2.2 + 4.18879 * (0.729 - 0.125), 0.1);
  const Repaired drained = repaired(cubeAndCrumb(), {.shell = 0.4, .drainHole = 0.4, .dropSmaller = 0.1});
  EXPECT_EQ(drained.report.solids, 1u);
  EXPECT_EQ(drained.report.cavities, 0u);
  EXPECT_EQ(drained.report.drainHoles, 1u);
}

}  // namespace
}  // namespace raymap
