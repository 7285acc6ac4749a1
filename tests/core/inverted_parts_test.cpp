// Parts that cross each other face one way.

#include "mesh/inverted_parts.h"

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/generate.h>
#include <raymap/repair.h>
#include <raymap/surface.h>

#include <cmath>
#include <random>
#include <string>

#include "broken_meshes.h"
#include "cpu_run.h"
#include "mesh/measured_parts.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::inverted;
using Faces = std::vector<uint32_t>;

Mesh boxAt(const glm::dvec3& low, const glm::dvec3& size) {
  return shapes::box(low, low + size);
}

Mesh joinedAll(const std::vector<Mesh>& meshes) {
  Mesh all = meshes[0];
  for (size_t m = 1; m < meshes.size(); ++m) all = shapes::joined(all, meshes[m]);
  return all;
}

/// Returns the numbers of the boxes that are turned; each has 12 faces.
Faces turnedBoxes(const std::vector<Mesh>& boxes) {
  const Mesh mesh = joinedAll(boxes);
  const InvertedParts found = findInvertedParts(mesh);
  Faces turned;
  for (const uint32_t face : found.faces)
    if (face % 12 == 0) turned.push_back(face / 12);
  EXPECT_EQ(found.faces.size(), 12 * turned.size());
  EXPECT_LE(found.firsts.size(), turned.size());
  EXPECT_TRUE(turned.empty() || mayHaveInvertedParts(mesh));
  return turned;
}

Mesh unitBox() {
  return boxAt({0, 0, 0}, glm::dvec3(1));
}
/// Returns a box across the unit box.
Mesh acrossBox() {
  return boxAt({0.5, 0.3, 0.2}, {1, 0.9, 0.9});
}
Mesh largeBox() {
  return boxAt({0.5, 0.3, 0.2}, {2, 2, 2});
}

TEST(InvertedParts, FaceAsTheLargest) {
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(acrossBox())}), Faces({1}));
  EXPECT_EQ(turnedBoxes({inverted(acrossBox()), unitBox()}), Faces({0}));
  EXPECT_EQ(turnedBoxes({inverted(unitBox()), acrossBox()}), Faces({1}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox())}), Faces({0}));
  EXPECT_EQ(turnedBoxes({inverted(unitBox()), largeBox()}), Faces({0}));
}

TEST(InvertedParts, StayWhereAllFaceOneWay) {
  EXPECT_EQ(turnedBoxes({unitBox(), acrossBox()}), Faces());
  EXPECT_EQ(turnedBoxes({inverted(unitBox()), inverted(acrossBox())}), Faces());
  EXPECT_FALSE(mayHaveInvertedParts(joinedAll({unitBox(), acrossBox()})));
  EXPECT_FALSE(mayHaveInvertedParts(joinedAll({inverted(unitBox()), inverted(acrossBox())})));
  EXPECT_FALSE(mayHaveInvertedParts(unitBox()));
}

TEST(InvertedParts, StayWhereTheyDoNotCross) {
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({0.2, 0.2, 0.2}, glm::dvec3(0.5)))}), Faces())
      << "a cavity";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({2, 0, 0}, glm::dvec3(0.5)))}), Faces()) << "apart";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({1, 0.2, 0.2}, glm::dvec3(0.5)))}), Faces())
      << "at a wall";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({1, 0, 0}, glm::dvec3(1)))}), Faces())
      << "at a whole wall";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({1, 1, 0}, glm::dvec3(1)))}), Faces()) << "at an edge";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({0, 0.2, 0.2}, glm::dvec3(0.5)))}), Faces())
      << "a cavity at a wall";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({0.3, 0.3, 0}, {0.2, 0.2, 1}))}), Faces())
      << "a hole from wall to wall";
}

TEST(InvertedParts, CrossAlsoWithWallsInOnePlane) {
  const Mesh flush = inverted(boxAt({0.5, 0, 0}, {0.9, 1, 1}));
  EXPECT_EQ(turnedBoxes({unitBox(), flush}), Faces({1}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(boxAt({0, 0, 0}, {1.4, 0.5, 0.5}))}), Faces({1}))
      << "a shared corner";
}

TEST(InvertedParts, AreLinkedInChains) {
  const Mesh second = boxAt({0.8, 0.1, 0.1}, {1, 0.7, 0.7}), third = boxAt({1.6, 0.2, 0.2}, {1, 0.5, 0.5});
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(second), third}), Faces({1}));
  EXPECT_EQ(turnedBoxes({unitBox(), second, inverted(third)}), Faces({2}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(second), inverted(third)}), Faces({1, 2}));
  EXPECT_EQ(turnedBoxes({inverted(unitBox()), second, third}), Faces({1, 2}));
  const Mesh far = boxAt({9, 0, 0}, {3, 3, 3});
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(second), inverted(far)}), Faces({1})) << "its own set";
  EXPECT_EQ(turnedBoxes({inverted(unitBox()), second, far}), Faces({1}));
}

TEST(InvertedParts, TurnWhatTheyEnclose) {
  const Mesh cavity = boxAt({0.1, 0.1, 0.1}, glm::dvec3(0.1)),
             solid = boxAt({0.12, 0.12, 0.12}, glm::dvec3(0.05)), other = boxAt({2, 2, 2}, glm::dvec3(0.1));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox()), inverted(cavity)}), Faces({0, 2}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox()), inverted(cavity), solid}), Faces({0, 2, 3}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox()), other}), Faces({0})) << "what the largest encloses";
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(acrossBox()), inverted(cavity)}), Faces({1}));
  const InvertedParts found =
      findInvertedParts(joinedAll({unitBox(), inverted(largeBox()), inverted(cavity)}));
  EXPECT_EQ(found.firsts, Faces({0})) << "the cavity crosses nothing";
}

TEST(InvertedParts, MayEncloseWhatLiesAtTheirWalls) {
  // The lowest face of the last box lies in a wall of the first one.
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox()), boxAt({0.1, 0.1, 0}, glm::dvec3(0.1))}),
            Faces({0, 2}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox()), boxAt({0.1, 0.1, -0.1}, glm::dvec3(0.1))}),
            Faces({0}));
  EXPECT_EQ(turnedBoxes({unitBox(), inverted(largeBox()), boxAt({0.1, 0.1, 1}, glm::dvec3(0.1))}),
            Faces({0}));
}

TEST(InvertedParts, MayBeOpen) {
  Mesh open = inverted(acrossBox());
  open.triangles.resize(10);
  const Mesh mesh = joinedAll({unitBox(), open});
  Faces expected;
  for (uint32_t f = 12; f < 22; ++f) expected.push_back(f);
  EXPECT_EQ(findInvertedParts(mesh).faces, expected);
  EXPECT_EQ(findInvertedParts(mesh).firsts, Faces({12}));
  Mesh plate = acrossBox();
  plate.triangles.resize(2);
  for (const Mesh& sheet : {plate, inverted(plate)})
    EXPECT_TRUE(findInvertedParts(joinedAll({unitBox(), sheet})).faces.empty());
}

TEST(InvertedParts, AreWholeWhereMoreFacesMeetAtAnEdge) {
  const Mesh left = boxAt({0, 0, 0}, {1, 5, 4}), right = boxAt({1, 0, 0}, {1, 5, 4});
  EXPECT_EQ(turnedBoxes({left, right, inverted(boxAt({0.5, 2, 1}, {6, 2, 2}))}), Faces({2})) << "glued";
  EXPECT_EQ(turnedBoxes({left, right, inverted(boxAt({0.5, 2, 1}, {9, 4, 4}))}), Faces({0, 1}));
  const Mesh diagonal = boxAt({1, 5, 0}, {1, 5, 4});
  EXPECT_EQ(turnedBoxes({left, diagonal, inverted(boxAt({1.5, 6, 1}, {6, 1, 1}))}), Faces({2}))
      << "at an edge";
  EXPECT_EQ(turnedBoxes({left, diagonal, inverted(boxAt({1.5, 6, 1}, {9, 4, 4}))}), Faces({1}));
}

TEST(InvertedParts, MayHaveFacesThatShareNoVertex) {
  const Mesh both = joinedAll({unitBox(), inverted(acrossBox())});
  Mesh apart;
  for (const glm::uvec3& t : both.triangles) {
    const auto first = uint32_t(apart.vertices.size());
    for (int c = 0; c < 3; ++c) apart.vertices.push_back(both.vertices[t[c]]);
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  EXPECT_TRUE(mayHaveInvertedParts(apart));
  EXPECT_EQ(findInvertedParts(apart).faces.size(), 12u);
  Mesh closed = apart;
  closed.triangles.resize(12);
  EXPECT_FALSE(mayHaveInvertedParts(closed));
}

TEST(MeasuredParts, HaveASideIfTheyEncloseAVolume) {
  const auto sideOf = [](const Mesh& mesh) {
    return measureParts(mesh, Faces(mesh.triangles.size(), 0), 1).parts[0].side();
  };
  const Mesh ball = shapes::sphere(1.0, 3, {5, 5, 5});
  const auto below = [&](double z) {
    return keepTriangles(ball, [&](const glm::uvec3& t) { return ball.position(t.x).z < 5.0 + z; });
  };
  EXPECT_EQ(sideOf(ball), 1);
  EXPECT_EQ(sideOf(inverted(ball)), -1);
  EXPECT_EQ(sideOf(below(0.5)), 1);
  EXPECT_EQ(sideOf(inverted(below(0.5))), -1);
  EXPECT_EQ(sideOf(below(-0.8)), 0) << "a shallow bowl";
  Mesh flat = unitBox();
  flat.triangles.resize(2);
  EXPECT_EQ(sideOf(flat), 0);
  EXPECT_NEAR(measureParts(unitBox(), Faces(12, 0), 1).parts[0].volume, 1.0, 1e-12);
}

/// Returns the overlapping boxes, the second one inside out.
Mesh overlapping() {
  return shapes::joined(unitBox(), inverted(boxAt({0.5, 0.3, 0.2}, glm::dvec3(1))));
}

void expectUnion(const Mesh& mesh, const Mesh& right, const FieldOptions& options) {
  const Grid grid = fitGrid(right, {.resolution = 24});
  std::vector<Warning> warnings;
  MachineOptions machine;
  machine.warn = [&](const Warning& warning) { warnings.push_back(warning); };
  const Generated run = runOf(mesh, grid, options, machine);
  EXPECT_EQ(countUnlike(run, runOf(right, grid, Orientation::Keep)), 0u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, WarningCode::PartsInsideOut);
  EXPECT_EQ(warnings[0].fields.count, run.stats.invertedParts.size());
  for (const uint32_t part : run.stats.invertedParts)
    EXPECT_NE(warnings[0].message.find(std::to_string(part)), std::string::npos) << warnings[0].message;
}

TEST(InvertedParts, AreSolidInFields) {
  const Mesh right = shapes::joined(unitBox(), boxAt({0.5, 0.3, 0.2}, glm::dvec3(1)));
  for (const SignMode sign : {SignMode::Harmonic, SignMode::Exact})
    expectUnion(overlapping(), right, {.sign = sign});
  for (const SignMode sign : {SignMode::Harmonic, SignMode::Exact, SignMode::Rays, SignMode::Ray})
    expectUnion(overlapping(), right, {.sign = sign, .orientation = Orientation::Repair});
  const Generated kept = runOf(overlapping(), fitGrid(right, {.resolution = 24}), Orientation::Keep);
  EXPECT_TRUE(kept.stats.invertedParts.empty());
  EXPECT_TRUE(kept.stats.turnedFaces.empty());
  EXPECT_EQ(
      runOf(overlapping(), fitGrid(right, {.resolution = 24}), Orientation::Auto).stats.turnedFaces.size(),
      12u);
}

TEST(InvertedParts, AreNamedByTheirLowestFaces) {
  const auto warningOf = [](int parts) {
    Mesh mesh = boxAt({0, 0, 0}, {10, 1, 1});
    for (int p = 0; p < parts; ++p)
      mesh = shapes::joined(mesh, inverted(boxAt({p + 0.2, 0.2, 0.8}, glm::dvec3(0.5))));
    std::string message;
    MachineOptions machine;
    machine.warn = [&](const Warning& warning) { message += warning.message; };
    runOf(mesh, fitGrid(mesh, {.resolution = 20}), {}, machine);
    return message;
  };
  const std::string end = "; keep the faces' directions if that is meant";
  EXPECT_EQ(warningOf(0), "");
  EXPECT_EQ(warningOf(1),
            "1 part (with face 12) is inside out and crosses others, so the sign reverses it" + end);
  EXPECT_EQ(
      warningOf(8),
      "8 parts (with faces 12, 24, 36, 48, 60, 72, 84, 96) are inside out and cross others, so the sign "
      "reverses them" +
          end);
  EXPECT_EQ(
      warningOf(9),
      "9 parts (with faces 12, 24, 36, 48, 60, 72, 84, 96, ...) are inside out and cross others, so the sign "
      "reverses them" +
          end);
}

TEST(InvertedParts, AreSolidWithHolesAndTurnedFaces) {
  const Mesh first = shapes::sphere(1.0, 3), second = shapes::sphere(0.8, 3, {0.9, 0.2, 0.1});
  const Mesh right = shapes::joined(first, second);
  const Mesh holed =
      keepTriangles(inverted(second), [&](const glm::uvec3& t) { return second.position(t.x).x < 1.6; });
  expectUnion(shapes::joined(first, holed), shapes::joined(first, inverted(holed)), {});
  Mesh turned = second;
  std::mt19937 random(1);
  for (glm::uvec3& t : turned.triangles)
    if (random() % 10 < 6) std::swap(t.y, t.z);
  expectUnion(shapes::joined(first, turned), right, {});
}

TEST(InvertedParts, MayBeGluedOfPartsWithAWallInCommon) {
  const Mesh left = boxAt({0, 0, 0}, {1, 5, 4}), right = boxAt({1, 0, 0}, {1, 5, 4});
  const Mesh across = boxAt({0.5, 2, 1}, {6, 2, 2});
  const Mesh mesh = joinedAll({left, right, inverted(across)});
  expectUnion(mesh, joinedAll({left, right, across}), {});
}

TEST(InvertedParts, AreSolidAtPoints) {
  std::vector<Warning> warnings;
  MachineOptions machine;
  machine.warn = [&](const Warning& warning) { warnings.push_back(warning); };
  const Surface surface(overlapping(), {}, machine);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].code, WarningCode::PartsInsideOut);
  EXPECT_EQ(surface.stats().invertedParts, Faces({12}));
  const std::vector<glm::dvec3> points{
      {0.75, 0.65, 0.6}, {0.25, 0.5, 0.5}, {1.25, 0.8, 0.7}, {0.2, 1.2, 0.5}};
  const QueryResult found = surface.query(points, {.winding = true});
  EXPECT_NEAR(found.distance[0], -0.25, 1e-6);
  EXPECT_LT(found.distance[1], 0.0f);
  EXPECT_LT(found.distance[2], 0.0f);
  EXPECT_GT(found.distance[3], 0.0f);
  EXPECT_EQ(found.winding[0], 2.0f);
  const Surface kept(overlapping(), {.orientation = Orientation::Keep}, machine);
  EXPECT_EQ(warnings.size(), 1u);
  EXPECT_NEAR(kept.query(points).distance[0], 0.25, 1e-6);
}

TEST(InvertedParts, AreSolidInARepair) {
  const Mesh mesh = overlapping();
  const Repaired repaired = repair(mesh, fitRepairGrid(mesh, {.resolution = 48}, {}));
  EXPECT_NEAR(diagnose(repaired.mesh).signedVolume, 1.72, 0.01);
  ASSERT_EQ(repaired.report.warnings.size(), 1u);
  EXPECT_EQ(repaired.report.warnings[0].code, WarningCode::PartsInsideOut);
}

}  // namespace
}  // namespace raymap
