#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "repair/stages.h"
#include "shapes.h"

namespace raymap {
namespace {

struct Outcome {
  RepairReport report;
  Grid grid;
  std::string warnings;
};

/// Repairs without plates in place of what the samples miss.
Outcome runAt(const Mesh& mesh, double spacing, RepairOptions how = {}) {
  how.remesh = true;
  how.minThickness = 0.0;
  Outcome outcome;
  outcome.grid = fitRepairGrid(mesh, {.voxelSize = spacing}, how);
  MachineOptions machine{.device = "cpu"};
  machine.warn = [&](const Warning& warning) { outcome.warnings.append(warning.message).append("\n"); };
  outcome.report = repair(mesh, outcome.grid, {}, how, machine).report;
  return outcome;
}

/// Returns by how many samples the bounds of the result are off.
double boundsOff(const Outcome& outcome) {
  const Box &before = outcome.report.before.bounds, &after = outcome.report.after.bounds;
  const glm::dvec3 off = glm::max(glm::abs(before.min - after.min), glm::abs(before.max - after.max));
  return std::max({off.x, off.y, off.z}) / outcome.grid.spacing;
}

TEST(Loss, DoesNotCountWhatTheToleranceAllows) {
  const Mesh ball = shapes::sphere(10.0, 4);
  const Outcome outcome = runAt(ball, 0.5, {.tolerance = 3.0});
  EXPECT_GT(outcome.report.meshFromResult.max, 1.0);  // Far more than a sample.
  EXPECT_LE(outcome.report.meshFromResult.max, 3.5);
  EXPECT_EQ(outcome.report.lostShare, 0.0);
  EXPECT_EQ(outcome.report.buriedShare, 0.0);
  EXPECT_EQ(outcome.warnings, "");
}

/// Returns a box of 10 x 10 x 10 with a plate, 6 high and 8 wide. A corner of the plate is inside the box.
Mesh boxWithPlate(double thickness) {
  return shapes::joined(shapes::box({0, 0, 0}, {10, 10, 10}),
                        shapes::box({1, 4.03, 9}, {9, 4.03 + thickness, 16}));
}

/// Returns a prism along y, 4 high at x = 0, that runs out to `edge` at x = 20.
Mesh wedge(double edge) {
  std::vector<glm::dvec3> p;
  for (const double y : {0.0, 10.0})
    for (const glm::dvec3& corner :
         {glm::dvec3(0, y, -2), {20, y, -0.5 * edge}, {20, y, 0.5 * edge}, {0, y, 2}})
      p.push_back(corner);
  return makeMesh(p, {{0, 1, 2},
                      {0, 2, 3},
                      {4, 6, 5},
                      {4, 7, 6},
                      {0, 4, 5},
                      {0, 5, 1},
                      {1, 5, 6},
                      {1, 6, 2},
                      {2, 6, 7},
                      {2, 7, 3},
                      {3, 7, 4},
                      {3, 4, 0}});
}

TEST(Loss, OfAPlateIsToldAndTheVoxelSizeKeepsIt) {
  const Mesh mesh = boxWithPlate(0.3);
  const Outcome coarse = runAt(mesh, 1.0);
  const Loss& loss = coarse.report.loss;
  EXPECT_GT(boundsOff(coarse), 5.0);
  // The sides of the plate outside are 2 x 48 of 600 + 117.
  EXPECT_NEAR(loss.solidShare, 0.11, 0.03);
  EXPECT_NEAR(loss.solidShare, coarse.report.lostShare, 1e-3);
  EXPECT_NEAR(loss.thinnest, 0.3, 0.01);
  EXPECT_NEAR(loss.medianThickness, 0.3, 0.01);
  EXPECT_NEAR(loss.bounds.max.z, 16.0, 1e-5);
  EXPECT_NEAR(loss.bounds.min.x, 1.0, 1e-5);
  EXPECT_GT(loss.bounds.min.z, 10.0);
  EXPECT_TRUE(loss.kept);
  EXPECT_NE(coarse.warnings.find("x from 1 to 9, y from 4.03 to 4.33, z from 1"), std::string::npos)
      << coarse.warnings;
  EXPECT_NE(coarse.warnings.find(
                "bounds parts of the solid, 0.3 thick at the thinnest, 0.3 in the median: a voxel size of"),
            std::string::npos);
  EXPECT_NE(coarse.warnings.find(" keeps them"), std::string::npos) << coarse.warnings;
  ASSERT_EQ(coarse.report.warnings.size(), 1u);
  const Warning& warning = coarse.report.warnings[0];
  EXPECT_EQ(warning.message + "\n", coarse.warnings);
  EXPECT_EQ(warning.code, WarningCode::SolidLost);
  EXPECT_EQ(warning.fields.share, loss.solidShare + loss.openShare);
  EXPECT_EQ(warning.fields.voxelSize, loss.voxelSize);
  const Outcome fine = runAt(mesh, loss.voxelSize);
  EXPECT_LT(boundsOff(fine), 1.0);
  EXPECT_TRUE(fine.report.warnings.empty());
  EXPECT_EQ(fine.report.loss.solidShare, 0.0);
  EXPECT_EQ(fine.warnings, "");
}

TEST(Loss, OfAWingIsKeptByTheVoxelSize) {
  int losses = 0;
  for (const double spacing : {1.2, 1.1, 1.0, 0.95, 0.9, 0.85, 0.8, 0.75}) {
    const Outcome coarse = runAt(wedge(0.25), spacing);
    if (coarse.report.loss.solidShare < 1e-3) continue;
    ++losses;
    EXPECT_GT(boundsOff(coarse), 1.0);
    EXPECT_NEAR(coarse.report.loss.thinnest, 0.25, 0.06);
    EXPECT_NEAR(coarse.report.loss.bounds.max.x, 20.0, 1e-5);
    ASSERT_TRUE(coarse.report.loss.kept) << coarse.warnings;
    const Outcome fine = runAt(wedge(0.25), coarse.report.loss.voxelSize);
    EXPECT_LT(boundsOff(fine), 1.0);
    EXPECT_LT(fine.report.loss.solidShare, 1e-3);
  }
  EXPECT_GE(losses, 2);
}

TEST(Loss, OfASharpEdgeSaysWhatIsKept) {
  // The middle of the wedge is never a plane of samples: it is oblique.
  Mesh mesh = wedge(0.0);
  for (glm::vec3& v : mesh.vertices) {
    v.z *= 0.25f;
    v = {v.x, std::cos(0.5f) * v.y - std::sin(0.5f) * v.z, std::sin(0.5f) * v.y + std::cos(0.5f) * v.z};
    v = {std::cos(0.3f) * v.x - std::sin(0.3f) * v.z, v.y, std::sin(0.3f) * v.x + std::cos(0.3f) * v.z};
  }
  const Outcome coarse = runAt(mesh, 1.0);
  const Loss& loss = coarse.report.loss;
  EXPECT_GT(loss.solidShare, 0.005);
  EXPECT_FALSE(loss.kept);
  EXPECT_GT(loss.keptShare, 0.5);
  EXPECT_LT(loss.keptShare, 0.995);
  EXPECT_GT(loss.keptThickness, 0.0);
  EXPECT_LT(loss.keptThickness, loss.medianThickness);
  EXPECT_NE(coarse.warnings.find("no voxel size that fits into memory keeps all"), std::string::npos)
      << coarse.warnings;
}

TEST(Loss, CountsTheOffset) {
  // The plate is 0.1 thinner on both sides.
  const Loss loss = runAt(boxWithPlate(0.5), 0.9, {.offset = -0.1}).report.loss;
  EXPECT_GT(loss.solidShare, 0.05);
  EXPECT_NEAR(loss.thinnest, 0.3, 0.01);
}

TEST(Loss, TellsSheetsFromPartsOfTheSolid) {
  const Mesh box = shapes::box({0, 0, 0}, {10, 10, 10});
  const Outcome whole = runAt(box, 1.0);
  EXPECT_EQ(whole.report.loss.solidShare, 0.0);
  EXPECT_EQ(whole.report.loss.openShare, 0.0);
  EXPECT_EQ(whole.warnings, "");
  const std::vector<glm::dvec3> corners{{15, 0, 0}, {15, 8, 0}, {15, 8, 8}, {15, 0, 8}};
  const Outcome sheet = runAt(shapes::joined(box, makeMesh(corners, {{0, 1, 2}, {0, 2, 3}})), 0.5);
  EXPECT_NEAR(sheet.report.lostShare, 64.0 / 664.0, 0.02);
  EXPECT_EQ(sheet.report.loss.solidShare, 0.0);
  EXPECT_TRUE(sheet.report.loss.bounds.isEmpty());
  EXPECT_EQ(sheet.report.loss.openShare, sheet.report.lostShare);
  EXPECT_NEAR(sheet.report.loss.openBounds.min.x, 15.0, 1e-5);
  EXPECT_LT(glm::distance(sheet.report.loss.openBounds.max, glm::dvec3(15, 8, 8)), 0.3);
  EXPECT_TRUE(sheet.warnings.starts_with("9.")) << sheet.warnings;
  for (const char* part : {"of the mesh's surface is lost: x from 15 to 15", "is sheets and open surface",
                           "without a least thickness of 0, plates keep what is thin"})
    EXPECT_NE(sheet.warnings.find(part), std::string::npos) << sheet.warnings;
  ASSERT_EQ(sheet.report.warnings.size(), 1u);
  EXPECT_EQ(sheet.report.warnings[0].code, WarningCode::SurfaceLost);
  EXPECT_EQ(sheet.report.warnings[0].fields.share, sheet.report.loss.openShare);
}

TEST(Loss, IsOneWarningWithTheWholeShare) {
  // A cube, a plate that the samples miss, and balls that are dropped on request.
  const Mesh cube = shapes::box({0, 0, 0}, {10, 10, 10}), plate = shapes::box({12, 1.1, 0}, {18, 1.4, 8});
  Mesh mesh = shapes::joined(cube, plate);
  for (int k = 0; k < 4; ++k) mesh = shapes::joined(mesh, shapes::sphere(1.5, 3, {5.0 * k, 5, -5}));
  const Outcome outcome = runAt(mesh, 1.0, {.dropSmaller = 14.2});
  ASSERT_EQ(outcome.report.warnings.size(), 1u) << outcome.warnings;
  const Warning& warning = outcome.report.warnings[0];
  const double balls = 4 * 4 * std::numbers::pi * 2.25, plateArea = 2 * (6 * 8 + 6 * 0.3 + 8 * 0.3);
  const double share = (balls + plateArea) / (600 + balls + plateArea);
  EXPECT_NEAR(warning.fields.share, share, 0.02);
  EXPECT_NEAR(outcome.report.loss.droppedShare, balls / (600 + balls + plateArea), 0.01);
  EXPECT_EQ(outcome.report.loss.droppedBounds.min.z, outcome.report.before.bounds.min.z);
  EXPECT_NE(warning.message.find("x from -1.5 to 18"), std::string::npos) << warning.message;
  EXPECT_NE(warning.message.find("a smaller volume keeps them"), std::string::npos) << warning.message;
}

TEST(Loss, TellsOfHollowsThatWereNotMade) {
  const Mesh box = shapes::box({0, 0, 0}, {10, 10, 4});
  const Outcome thin = runAt(box, 0.5, {.shell = 2.5});
  EXPECT_EQ(thin.report.hollows, 0u);
  EXPECT_EQ(thin.report.warnings.at(0).code, WarningCode::NoHollow);
  EXPECT_NE(thin.warnings.find("nowhere thick enough for a hollow"), std::string::npos) << thin.warnings;
  const Outcome narrow = runAt(box, 0.5, {.shell = 1.0, .drainHole = 3.0});
  EXPECT_EQ(narrow.report.hollows, 0u);
  EXPECT_EQ(narrow.report.filledHollows, 1u);
  EXPECT_EQ(narrow.report.warnings.at(0).code, WarningCode::HollowsFilled);
  EXPECT_EQ(narrow.report.warnings.at(0).fields.count, 1u);
  EXPECT_NE(narrow.warnings.find("1 hollow is too small for the drain hole"), std::string::npos)
      << narrow.warnings;
  const Outcome made = runAt(box, 0.5, {.shell = 1.0, .drainHole = 1.0});
  EXPECT_EQ(made.report.hollows, 1u);
  EXPECT_EQ(made.report.filledHollows, 0u);
  EXPECT_EQ(made.warnings, "");
  EXPECT_EQ(runAt(box, 0.5, {.shell = 1.0}).warnings, "");
  // The floor of 8 x 8 has no place for 50 holes that are 2 apart.
  const Outcome few = runAt(box, 0.5, {.shell = 1.0, .drainHole = 1.0, .drainHoles = 50});
  EXPECT_GT(few.report.drainHoles, 2u);
  EXPECT_LT(few.report.drainHoles, 50u);
  ASSERT_EQ(few.report.warnings.size(), 1u);
  EXPECT_EQ(few.report.warnings[0].code, WarningCode::DrainHolesMissing);
  EXPECT_EQ(few.report.warnings[0].fields.count, 50u - few.report.drainHoles);
}

Loss lossOf(RepairRun& run, const std::vector<FacePoint>& lost, double share) {
  run.lost = lost;
  run.lostShare = run.report.lostShare = share;
  run.report.loss = {};
  inspectLoss(run);
  return run.report.loss;
}

TEST(Loss, IsOfThePartsThinnerThanFourSamples) {
  const Mesh box = shapes::box({0, 0, 0}, {16, 16, 4});
  for (const double spacing : {0.25, 0.5, 0.99, 1.01, 2.0}) {
    const Grid grid = fitGrid(box, {.voxelSize = spacing});
    const FieldOptions options;
    const RepairOptions changes;
    const MachineOptions machine{.device = "cpu"};
    RepairRun run(box, grid, options, changes, machine);
    uint32_t face = 0;
    while (box.position(box.triangles[face].x).z + box.position(box.triangles[face].y).z +
               box.position(box.triangles[face].z).z <
           11.9)
      ++face;
    const std::vector<FacePoint> lost{{.position = {8, 8, 4}, .triangle = face, .area = 1.0}};
    const Loss loss = lossOf(run, lost, 0.5);
    EXPECT_EQ(loss.solidShare, spacing > 1.0 ? 0.5 : 0.0) << spacing;
    EXPECT_EQ(loss.openShare, spacing > 1.0 ? 0.0 : 0.5) << spacing;
  }
}

TEST(Loss, OfSheetsAloneLeavesNoTraceOfASolid) {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}};
  const Mesh sheet = makeMesh(corners, {{0, 1, 2}, {0, 2, 3}});
  const Grid grid = fitGrid(sheet, {.voxelSize = 1.0});
  const FieldOptions options;
  const RepairOptions changes;
  const MachineOptions machine{.device = "cpu"};
  RepairRun run(sheet, grid, options, changes, machine);
  std::vector<FacePoint> lost;
  for (int k = 1; k <= 20; ++k) {
    lost.push_back({.position = {0.3 * k, 1, 0}, .triangle = 0, .area = 0.1 / k});
    const Loss loss = lossOf(run, lost, 0.07 * k);
    EXPECT_EQ(loss.solidShare, 0.0) << k;
    EXPECT_EQ(loss.openShare, 0.07 * k) << k;
  }
}

}  // namespace
}  // namespace raymap
