#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <numbers>

#include "broken_meshes.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::inverted;
using shapes::joined;

Repaired mendedBy(const Mesh& mesh, const RepairOptions& options = {}, const FieldOptions& field = {},
                  int resolution = 40) {
  const Grid grid = fitRepairGrid(mesh, {.resolution = resolution}, options);
  return repair(mesh, grid, field, options, {.device = "cpu"});
}

/// A closed rod of `sides` sides.
Mesh voidRod(uint32_t sides, double radius, const glm::dvec3& low, double height) {
  std::vector<glm::dvec3> p{low, low + glm::dvec3(0, 0, height)};
  std::vector<glm::uvec3> t;
  for (uint32_t i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    for (const double z : {0.0, height})
      p.push_back(low + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), z));
    const uint32_t at = 2 + 2 * i, next = 2 + 2 * ((i + 1) % sides);
    t.insert(t.end(), {{at, next, at + 1}, {next, next + 1, at + 1}, {0, next, at}, {1, at + 1, next + 1}});
  }
  return makeMesh(p, t);
}

/// A plate with voids for magnets.
Mesh plateWithVoids() {
  Mesh plate = box({0, 0, 0}, {60, 40, 4});
  for (const double x : {10.0, 30.0, 50.0})
    for (const double y : {10.0, 30.0}) plate = joined(plate, inverted(voidRod(12, 3.0, {x, y, 1}, 2.0)));
  return plate;
}

void turnFace(Mesh& mesh, uint32_t face) {
  turnFaces(mesh, std::vector<uint32_t>{face});
}

TEST(Mend, TurnsACertainFaceBackAndKeepsTheRest) {
  const Mesh plate = plateWithVoids();
  for (const uint32_t face : {0u, 20u}) {  // Of the plate, and of a void.
    Mesh mesh = plate;
    turnFace(mesh, face);
    const Repaired made = mendedBy(mesh);
    EXPECT_TRUE(made.report.keepsFaces());
    EXPECT_EQ(made.report.stats.turnedFaces, std::vector<uint32_t>{face});
    EXPECT_EQ(made.mesh.vertices, plate.vertices);
    EXPECT_EQ(made.report.cavities, 6u);
    EXPECT_EQ(made.report.closedHoles, 0u);
    Mesh turnedBack = made.mesh;
    turnedBack.triangles[face] = plate.triangles[face];
    EXPECT_EQ(turnedBack.triangles, plate.triangles);
    EXPECT_EQ(made.report.after.signedVolume, diagnose(plate).signedVolume);
  }
  Mesh mesh = plate;
  turnFace(mesh, 0);
  EXPECT_FALSE(mendedBy(mesh, {}, {.orientation = Orientation::Keep}).report.keepsFaces());
  EXPECT_FALSE(mendedBy(mesh, {.remesh = true}).report.keepsFaces());
}

TEST(Mend, TurnsOutwardsWhatIsMostlyTurned) {
  const Mesh ball = shapes::sphere(1.0, 2);
  for (const size_t count : {32, 200, 319}) {  // Of 320.
    Mesh mesh = joined(ball, box({2, 0, 0}, {3, 1, 1}));
    std::vector<uint32_t> faces;
    for (uint32_t f = 0; f < count; ++f) faces.push_back(f);
    turnFaces(mesh, faces);
    const Repaired made = mendedBy(mesh);
    EXPECT_TRUE(made.report.keepsFaces()) << count;
    EXPECT_EQ(made.report.stats.turnedFaces, faces);
    EXPECT_NEAR(made.report.after.signedVolume, diagnose(ball).signedVolume + 1.0, 1e-6);
  }
}

TEST(Mend, LeavesToTheUnionWhatIsAllTurned) {
  const Mesh ball = shapes::sphere(1.0, 2);
  const Repaired made = mendedBy(inverted(ball));
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_NEAR(made.report.after.signedVolume, diagnose(ball).signedVolume, 1e-6);
  EXPECT_EQ(made.report.stats.turnedFaces.size(), ball.triangles.size());
  Mesh half = ball;  // Either half may be the turned one.
  for (uint32_t f = 0; f < 160; ++f) turnFace(half, f);
  EXPECT_FALSE(mendedBy(half).report.keepsFaces());
}

/// Leaves out the faces of a mesh at a height.
Mesh withoutSide(const Mesh& mesh, double z) {
  return keepTriangles(mesh, [&](const glm::uvec3& t) {
    return mesh.position(t.x).z != z || mesh.position(t.y).z != z || mesh.position(t.z).z != z;
  });
}

TEST(Mend, TurnsAFaceBackAndClosesTheHole) {
  Mesh mesh = withoutSide(box({0, 0, 0}, {20, 20, 20}), 0.0);
  turnFace(mesh, 3);
  const Repaired made = mendedBy(mesh);
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_EQ(made.report.stats.turnedFaces, std::vector<uint32_t>{3});
  EXPECT_EQ(made.report.closedHoles, 1u);
  EXPECT_EQ(made.report.closingFaces, 2u);
  EXPECT_DOUBLE_EQ(made.report.after.signedVolume, 8000.0);
}

TEST(Mend, ClosesFlatHolesBeforeTheUnion) {
  // Two boxes without floors, and two without lids, which cross.
  const Mesh boxes = joined(box({0, 0, 0}, {20, 20, 15}), box({12, 3, 0}, {32, 17, 30}));
  for (const double z : {0.0, 30.0}) {
    const Mesh mesh = withoutSide(boxes, z);
    const Repaired made = mendedBy(mesh, {}, {}, 64);
    EXPECT_TRUE(made.report.keepsFaces());
    EXPECT_GT(made.report.unitedFaces, 0u);
    EXPECT_EQ(made.report.closedHoles, z == 0.0 ? 2u : 1u);
    EXPECT_NEAR(made.report.after.signedVolume, 20 * 20 * 15 + 20 * 14 * 30 - 8 * 14 * 15, 1e-3);
    EXPECT_NEAR(made.report.after.bounds.min.z, 0.0, 0.05);
    EXPECT_NEAR(made.report.after.bounds.max.z, 30.0, 0.05);
    EXPECT_TRUE(made.report.warnings.empty());
  }
  // Without measuring, and with a turned face.
  Mesh turned = withoutSide(boxes, 0.0);
  turnFace(turned, 5);
  const Repaired brief = mendedBy(turned, {.offset = 1.0, .measure = false}, {}, 64);
  EXPECT_EQ(brief.report.stats.turnedFaces, std::vector<uint32_t>{5});
  EXPECT_NEAR(bounds(brief.mesh).min.z, -1.0, 0.1);
  EXPECT_EQ(mendedBy(turned, {.closeHoles = false}, {}, 40).report.closedHoles, 0u);
}

}  // namespace
}  // namespace raymap
