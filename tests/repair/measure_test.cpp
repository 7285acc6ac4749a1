#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <algorithm>
#include <cmath>

#include "repair/solid/deviation.h"
#include "shapes.h"

namespace raymap {
namespace {

/// Returns the report of a repair with samples `spacing` apart, and no plates in place of what they miss.
RepairReport reportOf(const Mesh& mesh, double spacing, RepairOptions repair = {}) {
  repair.closeHoles = false;
  repair.minThickness = 0.0;
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = spacing}, repair);
  return raymap::repair(mesh, grid, {}, repair, {.device = "cpu"}).report;
}

void expectAllShown(const RepairReport& report, double within) {
  EXPECT_EQ(report.lostShare, 0.0);
  EXPECT_EQ(report.buriedShare, 0.0);
  EXPECT_GT(report.meshFromResult.points, 100u);
  EXPECT_GT(report.resultFromMesh.points, 100u);
  EXPECT_LE(report.meshFromResult.max, within);
  EXPECT_LE(report.resultFromMesh.max, within);
  EXPECT_EQ(report.keptFromResult.points, report.meshFromResult.points);
  EXPECT_EQ(report.keptFromResult.max, report.meshFromResult.max);
}

/// Returns a mesh with a square of two faces added. It lies across x and bounds nothing.
Mesh withSquare(const Mesh& mesh, double x, double side) {
  const std::vector<glm::dvec3> corners{{x, 0, 0}, {x, side, 0}, {x, side, side}, {x, 0, side}};
  return shapes::joined(mesh, makeMesh(corners, {{0, 1, 2}, {0, 2, 3}}));
}

const Mesh kBox = shapes::box({0, 0, 0}, {10, 8, 6});

TEST(Measure, RaisesNoFalseAlarmWhereFacesLieInPlanesOfSamples) {
  const Mesh box = shapes::box({0, 0, 0}, {40, 30, 10});
  for (const int resolution : {256, 96, 60, 53, 48, 47}) {
    const Grid grid = fitRepairGrid(box, {.resolution = resolution}, {});
    const RepairReport report = repair(box, grid, {}, {.remesh = true}, {.device = "cpu"}).report;
    expectAllShown(report, 0.1 * grid.spacing);
    EXPECT_EQ(report.trimmedShare, 0.0);
  }
}

TEST(Measure, CountsAsLostWhatIsMoreThanASampleOutside) {
  const RepairReport closer = reportOf(withSquare(kBox, 10.98, 4.0), 1.0);
  expectAllShown(closer, 1.0);
  // A deviation that the tolerance allows beyond its default of 0.1 is not a loss.
  expectAllShown(reportOf(withSquare(kBox, 11.48, 4.0), 1.0, {.tolerance = 0.6}), 1.5);
  EXPECT_GT(reportOf(withSquare(kBox, 11.52, 4.0), 1.0, {.tolerance = 0.6}).lostShare, 0.0);
  EXPECT_GT(reportOf(withSquare(kBox, 11.02, 4.0), 1.0, {.tolerance = 0.0}).lostShare, 0.0);
  const RepairReport farther = reportOf(withSquare(kBox, 11.02, 4.0), 1.0);
  EXPECT_GT(farther.lostShare, 0.0);
  EXPECT_EQ(farther.buriedShare, 0.0);
  EXPECT_EQ(farther.trimmedShare, 0.0);
}

TEST(Measure, DoesNotHideLostPointsInTheLargestDistance) {
  const RepairReport report = reportOf(withSquare(kBox, 13.0, 4.0), 0.25);
  EXPECT_NEAR(report.lostShare, 16.0 / (376.0 + 16.0), 1e-9);
  EXPECT_NEAR(report.meshFromResult.max, 3.0, 0.02);
  EXPECT_LT(report.keptFromResult.max, 0.02);
  EXPECT_LT(report.keptFromResult.points, report.meshFromResult.points);
}

TEST(Measure, WeighsDistancesByArea) {
  // However finely a lost square is divided, it is 16 of 392, or 2 of 378, and 3 outside.
  const auto divided = [](double side, int parts) {
    Mesh mesh = kBox;
    for (int i = 0; i < parts * parts; ++i) {
      Mesh part = withSquare({}, 13.0, side / parts);
      part.origin += glm::dvec3(0.0, side / parts * (i % parts), side / parts * (i / parts));
      mesh = shapes::joined(mesh, part);
    }
    return mesh;
  };
  for (const int parts : {1, 30}) {
    const RepairReport large = reportOf(divided(4.0, parts), 0.5);
    EXPECT_NEAR(large.meshFromResult.mean, 3.0 * 16.0 / 392.0, 0.01);
    EXPECT_NEAR(large.meshFromResult.p99, 3.0, 0.02);
    const RepairReport small = reportOf(divided(std::sqrt(2.0), parts), 0.5);
    EXPECT_LT(small.meshFromResult.p99, 0.05);
    EXPECT_NEAR(small.meshFromResult.max, 3.0, 0.02);
  }
}

TEST(Measure, CountsAsBuriedWhatIsMoreThanASampleInside) {
  // 16 + 4 of the second box are inside the first one, and 4 of the first inside the second.
  const Mesh mesh = shapes::joined(shapes::box({0, 0, 0}, {4, 4, 4}), shapes::box({2, 1, 1}, {6, 3, 3}));
  const RepairReport report = reportOf(mesh, 0.05, {.remesh = true});
  EXPECT_NEAR(report.buriedShare, 24.0 / 136.0, 0.02);
  EXPECT_EQ(report.lostShare, 0.0);
  EXPECT_LE(report.meshFromResult.max, 0.05);
}

TEST(Measure, ComparesWithTheMovedSurface) {
  Mesh insideOut = kBox;
  for (glm::uvec3& face : insideOut.triangles) std::swap(face.y, face.z);
  for (const Mesh& mesh : {kBox, insideOut}) {
    const RepairReport grown = reportOf(mesh, 0.1, {.offset = 1.0});
    expectAllShown(grown, 0.02);
    EXPECT_EQ(grown.trimmedShare, 0.0);
    // The box inside is 8 x 6 x 4. Its faces moved from the middle of the given ones.
    const RepairReport shrunken = reportOf(mesh, 0.1, {.offset = -1.0});
    expectAllShown(shrunken, 0.1);
    EXPECT_NEAR(shrunken.trimmedShare, 1.0 - 208.0 / 376.0, 0.03);
  }
}

TEST(Measure, TrimsNothingOfASurfaceWithoutArea) {
  const Mesh line{{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, {{0, 1, 2}}};
  const RepairReport report = reportOf(line, 0.25, {.offset = 1.0});
  EXPECT_NEAR(report.after.bounds.size().x, 5.0, 0.1);
  EXPECT_EQ(report.trimmedShare, 0.0);
}

TEST(Measure, TakesEachVertexOnce) {
  const Mesh ball = shapes::sphere(1.0, 1, {5, 6, 7});
  const Grid grid = fitGrid(ball, {.voxelSize = 0.5});
  const SurfacePoints points = surfacePoints(ball, grid, 0.5);
  EXPECT_GT(points.positions.size(), ball.vertices.size());
  for (uint32_t v = 0; v < ball.vertices.size(); ++v) {
    size_t found = 0;
    for (size_t i = 0; i < points.positions.size(); ++i) {
      if (glm::distance(grid.position(points.positions[i]), ball.position(v)) > 1e-5) continue;
      ++found;
      const glm::uvec3& face = ball.triangles[points.faces[i]];
      EXPECT_TRUE(face.x == v || face.y == v || face.z == v);
    }
    EXPECT_EQ(found, 1u) << v;
  }
}

TEST(Measure, TakesFewerPointsWhereThereWouldBeTooMany) {
  // 2.1e7 points if they were as close as asked for. Points half as far apart again are 1 / 2.25 as many.
  const Mesh mesh = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {64, 0, 0}, {0, 64, 0}}, {{0, 1, 2}});
  const double step = std::sqrt(0.5 * 64 * 64 / 2.1e7);
  const SurfacePoints points = surfacePoints(mesh, {.dims = glm::ivec3(64), .spacing = 1.0}, step);
  EXPECT_GT(points.positions.size(), 0.9 * 2.1e7 / 2.25);
  EXPECT_LT(points.positions.size(), 1.5 * 2.1e7 / 2.25);
}

TEST(Measure, KnowsTheSurfaceOfAHollow) {
  for (const double shell : {0.5, 1.5}) {
    expectAllShown(reportOf(kBox, 0.2, {.offset = 1.0, .shell = shell}), 0.04);
    expectAllShown(reportOf(kBox, 0.2, {.shell = shell}), 0.04);
  }
  expectAllShown(reportOf(kBox, 0.2, {.shell = 0.5, .drainHole = 2.0}), 0.1);
}

}  // namespace
}  // namespace raymap
