#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>

#include "reference.h"
#include "shapes.h"

namespace raymap {
namespace {

constexpr double kVoxel = 0.25, kLeast = 0.6;

/// Returns a rectangle of the plane z = 0 as an open sheet.
Mesh sheet(const glm::dvec2& low, const glm::dvec2& high) {
  return makeMesh(std::vector<glm::dvec3>{{low, 0}, {high.x, low.y, 0}, {high, 0}, {low.x, high.y, 0}},
                  {{0, 1, 2}, {0, 2, 3}});
}

/// Distance of a point from a rectangle of the plane z = 0.
double distanceToSheet(const glm::dvec3& p, const glm::dvec2& low, const glm::dvec2& high) {
  const glm::dvec2 q(p);
  return glm::length(glm::dvec3(q - glm::clamp(q, low, high), p.z));
}

Repaired solidOf(const Mesh& mesh, RepairOptions repairOptions, int threads = 0) {
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = kVoxel}, repairOptions);
  repairOptions.remesh = true;
  repairOptions.tolerance = 0.0;
  return repair(mesh, grid, {}, repairOptions, {.device = "cpu", .threads = threads});
}

/// Positions of a mesh, turned back.
std::vector<glm::dvec3> turnedBack(const Mesh& mesh) {
  std::vector<glm::dvec3> p;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
    p.push_back(glm::transpose(shapes::kTurn) * mesh.position(v));
  return p;
}

void expectSound(const Repaired& solid) {
  EXPECT_TRUE(solid.report.after.watertight);
  EXPECT_TRUE(solid.report.after.consistentlyOriented);
  EXPECT_EQ(solid.report.crossingAfter.pairs, 0u);
}

TEST(ThinParts, GrowToTheLeastThickness) {
  for (const double thickness : {0.02, 0.1, 0.3, 0.5, 0.59}) {
    SCOPED_TRACE(thickness);
    const Mesh mesh = shapes::rotated(shapes::box({0, 0, -0.5 * thickness}, {8, 6, 0.5 * thickness}));
    const Repaired solid = solidOf(mesh, {.minThickness = kLeast});
    expectSound(solid);
    EXPECT_EQ(solid.report.after.components, 1u);
    // All but the rim is thin.
    EXPECT_GT(solid.report.thickenedShare, 0.7);
    double lowest = 0.0, highest = 0.0;
    for (const glm::dvec3& p : turnedBack(solid.mesh)) {
      lowest = std::min(lowest, p.z), highest = std::max(highest, p.z);
      const bool isInner = p.x > 0.5 && p.x < 7.5 && p.y > 0.5 && p.y < 5.5;
      if (isInner) {
        ASSERT_NEAR(std::abs(p.z), 0.5 * kLeast, 0.02) << p.x << " " << p.y;
      }
      // The rim grows by no more than that of a sheet. Its radius is about a sample.
      ASSERT_LT(distanceToSheet(p, {0, 0}, {8, 6}), 0.5 * kLeast + 0.5 * kVoxel);
    }
    EXPECT_NEAR(highest - lowest, kLeast, 0.06);
  }
}

TEST(ThinParts, AreTheEdgesOfWedges) {
  // A prism along y, 2 high at x = 0, that runs out to an edge at x = 10.
  const std::vector<glm::dvec3> p{{0, 0, -1}, {10, 0, 0}, {0, 0, 1}, {0, 6, -1}, {10, 6, 0}, {0, 6, 1}};
  const Mesh wedge = shapes::rotated(
      makeMesh(p, {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}}));
  const Repaired solid = solidOf(wedge, {.minThickness = kLeast});
  expectSound(solid);
  // 3 of the two slopes' 10 are less than the least thickness apart.
  const double area = 2.0 * 6.0 * std::hypot(10.0, 1.0);
  EXPECT_NEAR(solid.report.thickenedShare, 0.3 * area / (area + 2.0 * 6.0 + 2.0 * 10.0), 0.03);
  for (const double x : {8.0, 8.5, 9.0, 9.5}) {
    const glm::dvec3 middle = shapes::kTurn * glm::dvec3(x, 3, 0);
    EXPECT_NEAR(reference::distance(solid.mesh, middle), 0.5 * kLeast, 0.03) << x;
    EXPECT_NEAR(reference::windingNumber(solid.mesh, middle), 1.0, 1e-6) << x;
  }
}

TEST(ThinParts, LeaveThickOnesAsTheyAre) {
  const Mesh mesh = shapes::rotated(shapes::box({0, 0, 0}, {8, 6, 0.7}));
  const Repaired plain = solidOf(mesh, {.minThickness = 0.0}),
                 thick = solidOf(mesh, {.minThickness = kLeast});
  EXPECT_EQ(thick.report.thickenedShare, 0.0);
  // The grids differ in their padding.
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = kVoxel}, {.minThickness = kLeast});
  const MachineOptions machine{.device = "cpu"};
  EXPECT_EQ(repair(mesh, grid, {}, {.minThickness = 0.0, .remesh = true}, machine).mesh.vertices,
            repair(mesh, grid, {}, {.minThickness = kLeast}, machine).mesh.vertices);
  EXPECT_NEAR(thick.report.after.signedVolume, plain.report.after.signedVolume, 0.1);
}

TEST(ThinParts, AreFinsOfABodyThatStaysAsItIs) {
  // A fin of 0.1 on top of a cube.
  const Mesh cube = shapes::box({0, 0, 0}, {4, 4, 4}), fin = shapes::box({1, 1.95, 3.5}, {3, 2.05, 6});
  const Mesh mesh = shapes::rotated(shapes::joined(cube, fin));
  const Repaired lost = solidOf(mesh, {.minThickness = 0.0}), solid = solidOf(mesh, {.minThickness = kLeast});
  expectSound(solid);
  EXPECT_EQ(solid.report.after.components, 1u);
  EXPECT_LT(lost.report.after.signedVolume, 64.5);
  // The fin ends 0.25 farther out on three sides, with round rims.
  EXPECT_NEAR(solid.report.after.signedVolume, 64.0 + 2.5 * kLeast * 2.25, 0.25);
  double cubeDeviation = 0.0, finDeviation = 0.0, top = 0.0;
  size_t onFin = 0;
  for (const glm::dvec3& p : turnedBack(solid.mesh)) {
    top = std::max(top, p.z);
    const double finDistance = glm::length(p - glm::clamp(p, glm::dvec3(1, 2, 3.5), glm::dvec3(3, 2, 6)));
    if (finDistance > 0.5 * kLeast + kVoxel)
      cubeDeviation = std::max(cubeDeviation, reference::distance(cube, p));
    else if (p.z > 4.3 && p.z < 5.7 && p.x > 1.3 && p.x < 2.7)
      finDeviation = std::max(finDeviation, std::abs(std::abs(p.y - 2.0) - 0.5 * kLeast)), ++onFin;
  }
  EXPECT_LT(cubeDeviation, 0.06);
  EXPECT_GT(onFin, 20u);
  EXPECT_LT(finDeviation, 0.02);
  EXPECT_NEAR(top, 6.0 + 0.5 * (kLeast - 0.1), 0.1);
  // The fin's part of the area grew.
  const double finArea = 2.0 * 2.0 * 2.0, area = 2.0 * (2.0 * 0.1 + 2.5 * 0.1 + 2.0 * 2.5) + 96.0;
  EXPECT_NEAR(solid.report.thickenedShare, finArea / area, 0.01);
}

TEST(ThinParts, AreSheetsBesideSolids) {
  const Mesh ball = shapes::sphere(2.0, 4, {3, 3, 4});
  const Mesh mesh = shapes::rotated(shapes::joined(ball, sheet({0, 0}, {6, 6})));
  const Repaired solid = solidOf(mesh, {.minThickness = kLeast});
  expectSound(solid);
  EXPECT_EQ(solid.report.after.components, 2u);
  for (const glm::dvec3& p : turnedBack(solid.mesh)) {
    const double plate = distanceToSheet(p, {0, 0}, {6, 6}) - 0.5 * kLeast;
    const double sphere = glm::distance(p, {3, 3, 4}) - 2.0;
    const bool isRim = glm::any(glm::greaterThan(glm::abs(glm::dvec2(p) - 3.0), glm::dvec2(2.9)));
    ASSERT_LT(std::min(std::abs(plate), std::abs(sphere)), isRim ? 0.5 * kVoxel : 0.02) << p.x << " " << p.y;
  }
  EXPECT_NEAR(solid.report.thickenedShare, 36.0 / (36.0 + 16.0 * std::numbers::pi), 0.01);
}

TEST(ThinParts, AreSheetsAlone) {
  const Repaired solid = solidOf(sheet({0, 0}, {6, 6}), {.minThickness = kLeast});
  expectSound(solid);
  EXPECT_EQ(solid.report.thickenedShare, 1.0);
  EXPECT_NEAR(solid.report.after.signedVolume, 36.0 * kLeast + 0.5 * std::numbers::pi * 0.09 * 24.0, 0.5);
  EXPECT_THROW(solidOf(sheet({0, 0}, {6, 6}), {.minThickness = 0.0}), Error);
}

TEST(ThinParts, AreKeptByDefault) {
  // A plate, a rod of three sides and a sheet, all thinner than a sample, on a cube.
  const Mesh cube = shapes::box({0, 0, 0}, {4, 4, 4}), plate = shapes::box({1, 1.93, 3.5}, {3, 1.99, 7});
  const Mesh rod = makeMesh(
      std::vector<glm::dvec3>{
          {3.5, 1, 2}, {3.5, 1.1, 2}, {3.5, 1.05, 2.1}, {8, 1, 2}, {8, 1.1, 2}, {8, 1.05, 2.1}},
      {{0, 2, 1}, {3, 4, 5}, {0, 4, 3}, {0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 3, 5}, {2, 0, 3}});
  for (const bool isTurned : {false, true}) {
    Mesh mesh = shapes::joined(shapes::joined(shapes::joined(cube, plate), rod), sheet({-4, 2}, {2, 3}));
    if (isTurned) mesh = shapes::rotated(mesh);
    const Repaired kept = solidOf(mesh, {}), lost = solidOf(mesh, {.minThickness = 0.0});
    expectSound(kept);
    EXPECT_GT(lost.report.lostShare, 0.05);
    EXPECT_LT(kept.report.lostShare, 1e-3);
    ASSERT_EQ(kept.report.warnings.size(), 1u);
    EXPECT_EQ(kept.report.warnings[0].code, WarningCode::PartsThickened);
    EXPECT_LE(kept.report.after.components, 2u);  // There may be a gap between the rod and the cube.
    EXPECT_DOUBLE_EQ(kept.report.leastThickness, 1.75 * kVoxel);
    EXPECT_GT(kept.report.thickenedShare, 0.1);
    const Box before = kept.report.before.bounds, after = kept.report.after.bounds;
    EXPECT_LT(glm::length(before.min - after.min), 2.0 * kVoxel);
    EXPECT_LT(glm::length(before.max - after.max), 2.0 * kVoxel);
    // What it gains is hardly farther from the mesh than half a plate.
    EXPECT_LT(kept.report.resultFromMesh.max, 1.5 * kVoxel);
  }
}

TEST(ThinParts, OfADoubleSidedChairStayOnAnyGrid) {
  Mesh chair = shapes::box({0, 0, 4}, {4, 4, 4.4});
  for (const double x : {0.2, 3.6})
    for (const double y : {0.2, 3.6})
      chair = shapes::joined(chair, shapes::box({x, y, 0}, {x + 0.2, y + 0.2, 4.2}));
  chair = shapes::rotated(chair);
  const Mesh mesh = shapes::joined(chair, shapes::inverted(chair));
  for (const double voxel : {0.055, 0.08, 0.11, 0.15, 0.2, 0.3}) {
    SCOPED_TRACE(voxel);
    const Grid grid = fitRepairGrid(mesh, {.voxelSize = voxel});
    const Repaired kept = repair(mesh, grid, {}, {.remesh = true}, {.device = "cpu"});
    expectSound(kept);
    // Every leg ends nowhere, so it bounds a solid on any grid.
    EXPECT_EQ(kept.report.stats.leftOutFaces.size(), chair.triangles.size());
    EXPECT_EQ(kept.report.after.components, 1u);
    EXPECT_LT(kept.report.lostShare, 1e-3);
    EXPECT_LT(glm::length(kept.report.before.bounds.min - kept.report.after.bounds.min), 2.0 * voxel);
    EXPECT_LT(glm::length(kept.report.before.bounds.max - kept.report.after.bounds.max), 2.0 * voxel);
  }
}

TEST(ThinParts, OfASolidAreNotThere) {
  for (const Mesh& mesh : {shapes::rotated(shapes::box({0, 0, 0}, {4, 3, 2})), shapes::sphere(2.0, 4)}) {
    const Repaired kept = solidOf(mesh, {}), plain = solidOf(mesh, {.minThickness = 0.0});
    EXPECT_EQ(kept.report.thickenedShare, 0.0);
    EXPECT_EQ(kept.mesh.vertices, plain.mesh.vertices);
  }
}

TEST(ThinParts, ThatTheOffsetTakesAwayStayAwayByDefault) {
  const Mesh mesh = shapes::joined(shapes::box({0, 0, 0}, {4, 4, 4}), shapes::box({6, 0, 0}, {10, 4, 0.3}));
  const Repaired solid = solidOf(mesh, {.offset = -0.25});
  EXPECT_EQ(solid.report.after.components, 1u);
  EXPECT_NEAR(solid.report.after.signedVolume, 3.5 * 3.5 * 3.5, 0.5);
}

TEST(ThinParts, AreRefusedWithLengthsThatSaySomething) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1e-6, 1e-6, 1e-6});
  const auto messageFor = [&](const RepairOptions& how) -> std::string {
    try {
      repair(mesh, fitRepairGrid(mesh, {.voxelSize = 2e-8}, how), {}, how);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(messageFor({.minThickness = 1e-8}),
            "a least thickness of 1e-08 is less than two samples (4e-08); use a voxel size "
            "of at most 5e-09");
  EXPECT_EQ(messageFor({.shell = 3e-8}),
            "a wall of 3e-08 is thinner than two samples (4e-08); use more samples");
}

TEST(ThinParts, AreThickAfterTheOffset) {
  const Mesh mesh = shapes::box({0, 0, -0.1}, {8, 6, 0.1});
  for (const double offset : {-0.05, 0.1}) {
    const Repaired solid = solidOf(mesh, {.offset = offset, .minThickness = kLeast});
    const Box box = bounds(solid.mesh);
    EXPECT_NEAR(box.size().z, kLeast, 0.02);
  }
  // Moved outwards by 0.25, the plate is 0.7 thick by itself.
  const Repaired thick = solidOf(mesh, {.offset = 0.25, .minThickness = kLeast});
  EXPECT_NEAR(bounds(thick.mesh).size().z, 0.7, 0.02);
  EXPECT_EQ(thick.report.thickenedShare, 0.0);
}

TEST(ThinParts, NeedNoPlatesIfTheOffsetAloneMakesThemThick) {
  const Repaired solid = solidOf(sheet({0, 0}, {4, 4}), {.offset = 0.5 * kLeast, .minThickness = kLeast});
  EXPECT_EQ(solid.report.thickenedShare, 0.0);
  EXPECT_NEAR(bounds(solid.mesh).size().z, kLeast, 0.02);
}

TEST(ThinParts, AreWithinTheGrid) {
  const Mesh mesh = sheet({0, 0}, {1, 1});
  RepairOptions options{.minThickness = 2.0};
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = kVoxel}, options);
  EXPECT_LE(grid.origin.z, -1.0);
  EXPECT_GE(grid.position(grid.dims - 1).x, 2.0);
  EXPECT_NEAR(bounds(solidOf(mesh, options).mesh).size().z, 2.0, 0.05);
  options.offset = 3.0;
  EXPECT_LE(fitRepairGrid(mesh, {.voxelSize = kVoxel}, options).origin.z, -3.0);
}

TEST(ThinParts, NeedTwoSamples) {
  const Mesh mesh = shapes::box({0, 0, 0}, {4, 4, 4});
  const auto messageFor = [&](double least) -> std::string {
    try {
      solidOf(mesh, {.minThickness = least, .measure = false});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Usage);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(messageFor(0.5), "");
  const std::string message = messageFor(0.4);
  for (const char* part : {"least thickness", "0.4", "0.5", "at most 0.2"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_NE(messageFor(-1.0), "");
}

TEST(ThinParts, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = shapes::joined(shapes::soup(40, 3), shapes::box({0.4, 0.4, 2}, {1, 1, 2.1}));
  Mesh big = mesh;
  for (glm::vec3& v : big.vertices) v *= 6.0f;
  const RepairOptions options{.minThickness = kLeast, .measure = false};
  const Mesh one = solidOf(big, options, 1).mesh, many = solidOf(big, options, 5).mesh;
  EXPECT_EQ(one.vertices, many.vertices);
  EXPECT_EQ(one.triangles, many.triangles);
}

}  // namespace
}  // namespace raymap
