#include "repair/topology/unite_parts.h"

#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "base/parallel.h"
#include "mesh/diagnostics.h"
#include "mesh/pieces.h"
#include "repair/topology/mend.h"
#include "repair/topology/sew_cracks.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::joined;

Mesh join(std::initializer_list<Mesh> parts) {
  Mesh mesh = *parts.begin();
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) mesh = joined(mesh, *part);
  return mesh;
}

std::array<glm::vec3, 3> cornersOf(const Mesh& m, const glm::uvec3& t) {
  return {glm::vec3(m.position(t.x)), glm::vec3(m.position(t.y)), glm::vec3(m.position(t.z))};
}

/// Expects a union with nothing wrong, and this volume and area.
void expectUnion(const Mesh& mesh, double volume, double area, double tolerance = 1e-6) {
  const UnitedParts united = uniteParts(Model(mesh));
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  const Diagnostics found = diagnose(united.mesh);
  EXPECT_NEAR(found.signedVolume, volume, tolerance * volume);
  EXPECT_NEAR(found.area, area, tolerance * area);
}

TEST(UniteParts, UnitesBoxesThatCross) {
  expectUnion(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})}), 15.0, 42.0);
  expectUnion(join({shapes::box({-3, -1, -1}, {3, 1, 1}), shapes::box({-1, -3, -1}, {1, 3, 1}),
                    shapes::box({-1, -1, -3}, {1, 1, 3})}),
              56.0, 120.0);
}

TEST(UniteParts, UnitesBoxesWithWallsInOnePlane) {
  expectUnion(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 0, 0}, {3, 2, 2})}), 12.0, 32.0);
  expectUnion(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, 0, 0}, {3, 2, 2})}), 12.0, 32.0);
  expectUnion(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, 0.5, 0.5}, {3, 1.5, 1.5})}), 9.0,
              28.0);
}

/// Returns a wall of boxes, whose sides are turned against each other by less than anybody sees.
Mesh wallOfBoxes(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> turn(-3e-5f, 3e-5f);
  Mesh wall;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
      glm::mat4 place = glm::rotate(glm::mat4(1.0f), 0.7f, {1, 2, 3});
      place = glm::translate(place, {i, j, 0.25f * float(i % 2)});
      for (int axis = 0; axis < 3; ++axis) {
        glm::vec3 about(0.0f);
        about[axis] = 1.0f;
        place = glm::rotate(place, turn(random), about);
      }
      for (glm::vec3& v : box.vertices) v = glm::vec3(place * glm::vec4(v, 1.0f));
      wall = joined(wall, box);
    }
  return wall;
}

TEST(UniteParts, UnitesWallsThatLieAlmostInOnePlane) {
  size_t moved = 0;
  for (uint32_t seed = 8; seed < 24; ++seed) {
    const UnitedParts united = uniteParts(Model(wallOfBoxes(seed)));
    ASSERT_EQ(united.failure, FieldReason::None) << seed;
    const Diagnostics found = diagnose(united.mesh);
    EXPECT_TRUE(isAllRight(Model(united.mesh)));
    EXPECT_NEAR(found.signedVolume, 16.0, 2e-3);
    moved += united.movedVertices > 0;
  }
  EXPECT_GT(moved, 0u);
}

TEST(UniteParts, LeavesOutWhatOthersContain) {
  const Mesh outer = shapes::box({0, 0, 0}, {3, 3, 3});
  expectUnion(join({outer, shapes::box({1, 1, 1}, {2, 2, 2})}), 27.0, 54.0);
  expectUnion(join({outer, outer}), 27.0, 54.0);
}

TEST(UniteParts, KeepsCavities) {
  const Mesh cavity = shapes::inverted(shapes::box({1, 1, 1}, {2, 2, 2}));
  expectUnion(join({shapes::box({0, 0, 0}, {3, 3, 3}), cavity, shapes::box({2.5, 0.5, 0.5}, {4, 2, 2})}),
              26.0 + 2.25, 54.0 + 6.0 + 6.0);
}

TEST(UniteParts, TurnsCrossingPartsThatAreInsideOut) {
  const Mesh small = shapes::inverted(shapes::box({1.5, 1.5, 1.5}, {3, 3, 3}));
  const Mesh mesh = join({shapes::box({0, 0, 0}, {2, 2, 2}), small});
  expectUnion(mesh, 8.0 + 3.375 - 0.125, 24.0 + 13.5 - 1.5);
  EXPECT_EQ(uniteParts(Model(mesh)).inverted.faces.size(), 12u);
}

TEST(UniteParts, PartsSolidsAtACommonEdge) {
  // The edge's middle moves by a thousandth of its length into each box.
  expectUnion(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, 2, 0}, {4, 4, 2})}), 16.0, 48.0, 1e-3);
}

TEST(UniteParts, KeepsFacesThatNothingMeets) {
  const glm::dvec3 aside(1.61, 0.13, 0.07);
  const Mesh mesh = join({shapes::sphere(1.0, 3), shapes::sphere(1.0, 3, aside)});
  const UnitedParts united = uniteParts(Model(mesh));
  ASSERT_EQ(united.failure, FieldReason::None);
  size_t kept = 0;
  for (const glm::uvec3& t : united.mesh.triangles)
    kept += std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& given) {
      return cornersOf(mesh, given) == cornersOf(united.mesh, t);
    });
  const SelfIntersections crossing = findSelfIntersections(mesh);
  EXPECT_EQ(united.cutFaces, crossing.faces.size());
  // A sphere's faces reach down to 0.99 of its radius.
  size_t outside = 0;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f)
    outside += !std::ranges::binary_search(crossing.faces, f) &&
               std::ranges::all_of(cornersOf(mesh, mesh.triangles[f]), [&](const glm::vec3& p) {
                 return glm::length(p) > 1.001f || glm::distance(p, glm::vec3(aside)) > 1.001f;
               });
  ASSERT_GT(outside, mesh.triangles.size() / 2);
  EXPECT_GE(kept, outside);
}

/// Sheets as in an assembly: 0.8 thick, up to 1200 long, in all three directions.
std::vector<std::array<glm::dvec3, 2>> sheets() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<std::array<glm::dvec3, 2>> boxes;
  for (int i = 0; i < 60; ++i) {
    glm::dvec3 size, low;
    for (int a = 0; a < 3; ++a) size[a] = a == i % 3 ? 0.8 : 300.0 + 900.0 * share(random);
    for (int a = 0; a < 3; ++a) low[a] = share(random) * (1200.0 - size[a]);
    boxes.push_back({low, low + size});
  }
  return boxes;
}

/// Returns the volume of the union of boxes, cell by cell between all their sides.
double unionVolume(const std::vector<std::array<glm::dvec3, 2>>& boxes) {
  std::array<std::vector<double>, 3> sides;
  for (int a = 0; a < 3; ++a) {
    for (const auto& box : boxes)
      for (const glm::dvec3& corner : box) sides[a].push_back(corner[a]);
    std::ranges::sort(sides[a]);
  }
  const size_t n = sides[0].size();
  std::vector<bool> isIn(n * n * n);
  const auto placeOf = [&](double side, int a) {
    return size_t(std::ranges::lower_bound(sides[a], side) - sides[a].begin());
  };
  for (const auto& [low, high] : boxes)
    for (size_t z = placeOf(low.z, 2); z < placeOf(high.z, 2); ++z)
      for (size_t y = placeOf(low.y, 1); y < placeOf(high.y, 1); ++y)
        for (size_t x = placeOf(low.x, 0); x < placeOf(high.x, 0); ++x) isIn[(z * n + y) * n + x] = true;
  double volume = 0.0;
  for (size_t z = 0; z + 1 < n; ++z)
    for (size_t y = 0; y + 1 < n; ++y)
      for (size_t x = 0; x + 1 < n; ++x)
        if (isIn[(z * n + y) * n + x])
          volume += (sides[0][x + 1] - sides[0][x]) * (sides[1][y + 1] - sides[1][y]) *
                    (sides[2][z + 1] - sides[2][z]);
  return volume;
}

// Rounding leaves degenerate faces of the straight sheets, and turns some of the rotated ones over.
TEST(UniteParts, UnitesThinSheetsStraightAndRotated) {
  const auto boxes = sheets();
  Mesh mesh;
  for (const auto& [low, high] : boxes) mesh = joined(mesh, shapes::box(low, high));
  const double volume = unionVolume(boxes);
  for (const double angle : {0.0, 0.4}) {
    const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), angle, glm::normalize(glm::dvec3(1.0, 2.0, 3.0))));
    Mesh turned = mesh;
    for (glm::vec3& v : turned.vertices) v = glm::vec3(turn * (glm::dvec3(v) + mesh.origin));
    turned.origin = glm::dvec3(0.0);
    const UnitedParts united = uniteParts(Model(turned));
    ASSERT_EQ(united.failure, FieldReason::None) << angle;
    EXPECT_TRUE(isAllRight(Model(united.mesh)));
    EXPECT_NEAR(diagnose(united.mesh).signedVolume, volume, 1e-3 * volume) << angle;
    withThreads(1, [&] {
      const Mesh same = uniteParts(Model(turned)).mesh;
      EXPECT_EQ(same.triangles, united.mesh.triangles);
      EXPECT_EQ(same.vertices, united.mesh.vertices);
    });
  }
}

TEST(UniteParts, ClosesHolesIfAskedTo) {
  Mesh open = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})});
  open.triangles.pop_back();
  EXPECT_EQ(uniteParts(Model(open)).failure, FieldReason::Open);
  const UnitedParts united = uniteParts(Model(open), {InsideOut::Turned, true});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 15.0, 1e-5);
  EXPECT_EQ(united.filled.holes, 1u);
  EXPECT_EQ(united.filled.faces, 1u);
}

TEST(UniteParts, TurnsFacesBackBeforeItClosesHoles) {
  // A hole, and faces beside it that are reversed: what is between them and the others is no hole.
  Mesh open = join({shapes::sphere(1.0, 3), shapes::box({0, 0, 0}, {2, 2, 2})});
  std::vector<uint32_t> near;
  std::erase_if(open.triangles, [&](const glm::uvec3& t) { return open.position(t.x).x < -0.9; });
  for (uint32_t f = 0; f < open.triangles.size(); ++f)
    if (open.position(open.triangles[f].x).x < -0.7 && open.position(open.triangles[f].x).y > 0.0)
      near.push_back(f);
  ASSERT_GT(near.size(), 10u);
  const UnitedParts expected = uniteParts(Model(open), {InsideOut::Turned, true});
  ASSERT_EQ(expected.failure, FieldReason::None);
  for (const uint32_t f : near) std::swap(open.triangles[f].y, open.triangles[f].z);
  const UnitedParts united = uniteParts(Model(open), {InsideOut::Turned, true});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_EQ(united.filled.holes, 1u);
  EXPECT_EQ(united.turned, near);
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, diagnose(expected.mesh).signedVolume, 1e-5);
  EXPECT_EQ(uniteParts(Model(open), {InsideOut::Kept, true}).failure, FieldReason::Open);
}

TEST(UniteParts, TurnsFacesBackBesideASheetWhoseHalvesContradictEachOther) {
  Mesh turned = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})});
  std::swap(turned.triangles[3].y, turned.triangles[3].z);
  const Mesh fold = makeMesh(std::vector<glm::dvec3>{{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}},
                             std::vector<glm::uvec3>{{0, 1, 2}, {0, 3, 2}});
  ASSERT_EQ(diagnose(fold).flippedEdges, 1u);
  const UnitedParts united = uniteParts(Model(join({turned, fold})), {InsideOut::Turned, true, 0.1});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_EQ(united.turned, std::vector<uint32_t>{3});
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 15.0 + 0.1, 1e-5);
}

/// Returns a sheet of these quads.
Mesh quads(const std::vector<glm::dvec3>& corners, const std::vector<glm::uvec4>& faces) {
  std::vector<glm::uvec3> triangles;
  for (const glm::uvec4& q : faces) triangles.insert(triangles.end(), {{q.x, q.y, q.z}, {q.x, q.z, q.w}});
  return makeMesh(corners, triangles);
}

TEST(UniteParts, KeepsFacesBesideFewThatContradictEachOther) {
  // Half of the faces of a tetrahedron contradict the other half. Nobody can tell which are right.
  const auto withTetrahedron = [](float size) {
    Mesh tetrahedron{.vertices = {{2, 0, 0}, {2 + size, 0, 0}, {2, size, 0}, {2, 0, size}},
                     .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    for (const size_t f : {0, 1}) std::swap(tetrahedron.triangles[f].y, tetrahedron.triangles[f].z);
    return join({shapes::sphere(1.0, 3), tetrahedron});
  };
  const Mesh ball = shapes::sphere(1.0, 3);
  const UnitedParts united = uniteParts(Model(withTetrahedron(0.02F)), {InsideOut::Turned, true});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, diagnose(ball).signedVolume, 1e-5);
  for (size_t f = 0; f < ball.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c)
      ASSERT_EQ(united.mesh.position(united.mesh.triangles[f][c]), ball.position(ball.triangles[f][c]));
  EXPECT_EQ(uniteParts(Model(withTetrahedron(1.0F)), {InsideOut::Turned, true}).failure, FieldReason::Open);
  // A wide hole elsewhere is closed as if there were no such faces.
  Mesh open = withTetrahedron(0.02F);
  std::erase_if(open.triangles, [&](const glm::uvec3& t) { return open.position(t.x).z < -0.8; });
  const UnitedParts closed = uniteParts(Model(open), {InsideOut::Turned, true});
  ASSERT_EQ(closed.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(closed.mesh)));
  EXPECT_GT(diagnose(open).holes[0].area, 0.05 * diagnose(open).area);
}

TEST(UniteParts, LeavesOutFacesWhoseCornersCracksJoin) {
  // A sheet with a waist narrower than cracks.
  const Mesh sheet = quads({{2, 0, 0}, {3, 0, 0}, {2.5005, 1, 0}, {2.4995, 1, 0}, {3, 2, 0}, {2, 2, 0}},
                           {{0, 1, 2, 3}, {3, 2, 4, 5}});
  const UnitedParts united = uniteParts(Model(sheet), {InsideOut::Turned, true, 0.1});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_EQ(united.sewnVertices, 1u);
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 0.1, 0.01);
}

TEST(UniteParts, ClosesHolesThatEndAtEdgesOfThreeFaces) {
  // A box without a side, and a box whose edge lies on the rim of the hole: that edge has three faces.
  Mesh open = shapes::box({0, 0, 0}, {2, 2, 2});
  std::erase_if(open.triangles, [&](const glm::uvec3& t) {
    return open.position(t.x).x == 2.0 && open.position(t.y).x == 2.0 && open.position(t.z).x == 2.0;
  });
  ASSERT_EQ(open.triangles.size(), 10u);
  const Mesh both = join({open, shapes::box({2, 2, 0}, {4, 4, 2})});
  ASSERT_EQ(diagnose(both).nonManifoldEdges, 1u);
  const UnitedParts united = uniteParts(Model(both), {InsideOut::Turned, true});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_EQ(united.filled.holes, 1u);
  EXPECT_EQ(united.filled.faces, 2u);
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 16.0, 0.01);  // The boxes are parted at their edge.
}

/// Expects that sheets of an area beside a box become plates of a volume, and that the box keeps its faces.
void expectPlates(const Mesh& sheets, double area, double volume) {
  constexpr double kThickness = 0.125;
  const Mesh ball = shapes::rotated(shapes::sphere(1.5, 3));
  const Mesh mesh = join({ball, shapes::rotated(sheets)});
  const UnitedParts united = uniteParts(Model(mesh), {InsideOut::Turned, true, kThickness});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  const Diagnostics alone = diagnose(ball), all = diagnose(mesh), found = diagnose(united.mesh);
  EXPECT_NEAR(all.area, alone.area + area, 1e-4);
  EXPECT_NEAR(united.thickenedShare, area / all.area, 1e-6);
  EXPECT_TRUE(united.turned.empty());  // A plate has both sides.
  EXPECT_NEAR(found.signedVolume, alone.signedVolume + volume * kThickness, 1e-4);
  std::vector<uint8_t> isThere(mesh.triangles.size());
  for (size_t f = 0; f < united.sources.size(); ++f) {
    const uint32_t source = united.sources[f];
    ASSERT_LT(source, mesh.triangles.size());
    isThere[source] = 1;
    if (source < ball.triangles.size()) {
      EXPECT_EQ(cornersOf(united.mesh, united.mesh.triangles[f]), cornersOf(mesh, mesh.triangles[source]));
    }
  }
  EXPECT_EQ(std::ranges::count(isThere, 1), ptrdiff_t(isThere.size()));
}

TEST(UniteParts, MakesPlatesOfSheets) {
  const std::vector<glm::dvec3> square{{3, 0, 0}, {5, 0, 0}, {5, 2, 0}, {3, 2, 0}};
  expectPlates(quads(square, {{0, 1, 2, 3}}), 4.0, 4.0);
  // A right angle: the outer side gains what the inner one loses. Directions of faces do not matter.
  std::vector<glm::dvec3> angle = square;
  angle.insert(angle.end(), {{3, 0, 1}, {3, 2, 1}});
  expectPlates(quads(angle, {{0, 1, 2, 3}, {0, 3, 5, 4}}), 6.0, 6.0);
  expectPlates(quads(angle, {{0, 1, 2, 3}, {0, 4, 5, 3}}), 6.0, 6.0);
  Mesh odd = quads(angle, {{0, 1, 2, 3}, {0, 3, 5, 4}});
  std::swap(odd.triangles[0].y, odd.triangles[0].z);
  expectPlates(odd, 6.0, 6.0);
  // Three faces at an edge: each has a plate of its own, which ends there, and they overlap.
  std::vector<glm::dvec3> three = angle;
  three.insert(three.end(), {{1.75, 0, 0}, {1.75, 2, 0}});
  expectPlates(quads(three, {{0, 1, 2, 3}, {0, 3, 5, 4}, {0, 6, 7, 3}}), 8.5, 8.5 - 2.0 * 0.0625);
  // Two sheets that share a vertex.
  std::vector<glm::dvec3> touching = square;
  touching.insert(touching.end(), {{7, 2, 0}, {7, 4, 0}, {5, 4, 0}});
  expectPlates(quads(touching, {{0, 1, 2, 3}, {2, 4, 5, 6}}), 8.0, 8.0);
}

TEST(UniteParts, KeepsNeedlesWithoutWhichOthersCross) {
  // A rod with sides so narrow that all are degenerate: welds of their short edges would crush it.
  constexpr uint32_t kSides = 1024;
  constexpr double kLength = 8000.0;
  std::vector<glm::dvec3> corners{{0, 0, 0}, {kLength, 0, 0}};
  std::vector<glm::uvec3> faces;
  for (uint32_t i = 0; i < kSides; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kSides;
    for (const double x : {0.0, kLength}) corners.emplace_back(x, std::cos(turn), std::sin(turn));
    const uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % kSides);
    faces.insert(faces.end(), {{a, b + 1, a + 1}, {a, b, b + 1}, {0, b, a}, {1, a + 1, b + 1}});
  }
  const Mesh rod = makeMesh(corners, faces);
  ASSERT_EQ(diagnose(rod).degenerateFaces, 2u * kSides);
  const Mesh box = shapes::box({4000, -2, -2}, {4004, 2, 2});
  const UnitedParts united = uniteParts(Model(join({rod, box})));
  ASSERT_EQ(united.failure, FieldReason::None);
  const double section = 0.5 * kSides * std::sin(2.0 * std::numbers::pi / kSides);
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, section * (kLength - 4.0) + 64.0, 0.01);
  EXPECT_TRUE(isAllRight(Model(united.mesh), nullptr, true));
  EXPECT_FALSE(isAllRight(Model(united.mesh)));
}

TEST(UniteParts, UnitesPlatesWithTheSolidsThatTheyMeet) {
  const Mesh fin = quads({{1, 0.5, 1}, {3, 0.5, 1}, {3, 1.5, 1}, {1, 1.5, 1}}, {{0, 1, 2, 3}});
  const UnitedParts united =
      uniteParts(Model(join({shapes::box({0, 0, 0}, {2, 2, 2}), fin})), {InsideOut::Turned, true, 0.25});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 8.0 + 0.25, 1e-6);
}

Mesh moebiusStrip() {
  constexpr int kSteps = 48;
  std::vector<glm::dvec3> corners;
  std::vector<glm::uvec4> faces;
  for (uint32_t i = 0; i < kSteps; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / kSteps;
    const glm::dvec3 out(std::cos(turn), std::sin(turn), 0.0);
    for (const double side : {-0.5, 0.5})
      corners.push_back((4.0 + side * std::cos(0.5 * turn)) * out +
                        glm::dvec3(0, 0, side * std::sin(0.5 * turn)));
    const uint32_t a = 2 * i, b = i + 1 < kSteps ? a + 2 : 1, c = i + 1 < kSteps ? a + 3 : 0;
    faces.emplace_back(a, b, c, a + 1);
  }
  return quads(corners, faces);
}

TEST(UniteParts, TurnsNoFacesThatContradictAsManyThen) {
  // The faces between its seam and the last vertex contradict the others, but turned, they do at both ends.
  Mesh strip = moebiusStrip();
  for (glm::vec3& v : strip.vertices) v = {-v.y, v.x, v.z};
  const std::vector<glm::uvec3> given = strip.triangles;
  ASSERT_EQ(diagnose(strip).flippedEdges, 1u);
  EXPECT_TRUE(turnBack(strip, true).empty());
  EXPECT_EQ(strip.triangles, given);
  for (const uint32_t face : {10u, 11u, 50u}) std::swap(strip.triangles[face].y, strip.triangles[face].z);
  ASSERT_GT(diagnose(strip).flippedEdges, 3u);
  EXPECT_FALSE(turnBack(strip, true).empty());
  EXPECT_EQ(diagnose(strip).flippedEdges, 1u);
}

TEST(UniteParts, MakesAPlateOfAMoebiusStrip) {
  const Mesh strip = moebiusStrip(), mesh = join({shapes::sphere(2.5, 4), strip});
  const UnitedParts united = uniteParts(Model(mesh), {InsideOut::Turned, true, 0.1});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  const double ball = diagnose(shapes::sphere(2.5, 4)).signedVolume;
  EXPECT_NEAR(diagnose(united.mesh).signedVolume - ball, 0.1 * diagnose(strip).area, 2e-2);
}

/// Returns the sides of a box apart from each other: they end before its edges.
Mesh panels(const glm::dvec3& low, const glm::dvec3& high, double gap) {
  std::vector<glm::dvec3> corners;
  std::vector<glm::uvec4> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool isHigh : {false, true}) {
      glm::dvec3 from = low + gap, to = high - gap, u(0.0), v(0.0);
      from[axis] = isHigh ? high[axis] : low[axis];
      u[(axis + 1) % 3] = to[(axis + 1) % 3] - from[(axis + 1) % 3];
      v[(axis + 2) % 3] = to[(axis + 2) % 3] - from[(axis + 2) % 3];
      if (!isHigh) std::swap(u, v);
      const auto first = uint32_t(corners.size());
      corners.insert(corners.end(), {from, from + u, from + u + v, from + v});
      faces.emplace_back(first, first + 1, first + 2, first + 3);
    }
  return quads(corners, faces);
}

/// Turns the first of some panels, so that they bound no solid together.
Mesh oneTurned(Mesh panels) {
  for (size_t f = 0; f < 2; ++f) std::swap(panels.triangles[f].x, panels.triangles[f].y);
  return panels;
}

TEST(UniteParts, LeavesSheetsToTheField) {
  const auto reasonFor = [](const Mesh& mesh, double thickness) {
    return uniteParts(Model(mesh), {InsideOut::Turned, true, thickness}).failure;
  };
  Mesh sheet = shapes::box({5, 5, 5}, {6, 6, 6});
  sheet.triangles.resize(2);
  const Mesh boxes = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})});
  EXPECT_EQ(reasonFor(join({boxes, sheet}), 0.0), FieldReason::Sheet);
  // They bound a solid together. If one is turned, they may with most of the area, but not beside more of a
  // solid. Nor if one is missing.
  const Mesh apart = panels({5, 0, 0}, {8, 3, 3}, 0.2);
  EXPECT_EQ(reasonFor(apart, 0.1), FieldReason::Sheet);
  EXPECT_EQ(reasonFor(join({shapes::box({0, 0, 0}, {2, 2, 2}), apart}), 0.1), FieldReason::Sheet);
  const Mesh beside = shapes::box({0, 0, 0}, {4, 4, 4});
  EXPECT_EQ(reasonFor(join({beside, apart}), 0.1), FieldReason::Sheet);
  EXPECT_EQ(reasonFor(join({beside, oneTurned(apart)}), 0.1), FieldReason::None);
  EXPECT_EQ(reasonFor(oneTurned(apart), 0.1), FieldReason::Sheet);
  Mesh missing = apart;
  missing.triangles.resize(10);
  EXPECT_EQ(reasonFor(join({beside, missing}), 0.1), FieldReason::None);
  // Nor if they enclose next to nothing.
  EXPECT_EQ(reasonFor(join({beside, panels({5, 0, 0}, {8, 3, 0.06}, 0.01)}), 0.01), FieldReason::None);
  // One that has most of the area does not.
  const Mesh large = quads({{5, 0, 0}, {9, 0, 0}, {9, 7, 0}, {5, 7, 0}}, {{0, 1, 2, 3}});
  EXPECT_EQ(reasonFor(join({shapes::box({0, 0, 0}, {2, 2, 2}), large}), 0.1), FieldReason::None);
  // Noise is finer than the plate is thick.
  std::mt19937 random(1);
  std::vector<glm::dvec3> corners;
  std::vector<glm::uvec4> cells;
  for (uint32_t y = 0; y < 20; ++y)
    for (uint32_t x = 0; x < 20; ++x) {
      corners.emplace_back(x, y, 2.0 * double(random()) * 0x1p-32);
      const uint32_t c = 20 * y + x;
      if (x > 0 && y > 0) cells.emplace_back(c - 21, c - 20, c, c - 1);
    }
  EXPECT_EQ(reasonFor(quads(corners, cells), 0.02), FieldReason::None);
  EXPECT_EQ(reasonFor(quads(corners, cells), 5.0), FieldReason::Sheet);
}

TEST(UniteParts, JoinsNoCracksThatWouldLeaveNoFaces) {
  // The short edges of both are as close to each other as the sides of a crack.
  Mesh slivers;
  slivers.vertices = {{0.876307F, 0.481754F, 0},
                      {0.904827F, 0.425779F, 0},
                      {0.902963F, 0.425107F, 0},
                      {0.929776F, 0.368125F, 0},
                      {0.903042F, 0.424939F, 0}};
  slivers.triangles = {{0, 1, 2}, {1, 3, 4}};
  Mesh joined = slivers;
  EXPECT_GT(sewCracks(joined, 0.01), 0u);
  const UnitedParts united =
      uniteParts(Model(slivers), {.closesHoles = true, .sheetThickness = 0.1, .crack = 0.01});
  EXPECT_EQ(united.failure, FieldReason::None);
  EXPECT_EQ(united.sewnVertices, 0u);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
}

TEST(UniteParts, MakesAPlateOfASheetAlone) {
  const Mesh sheet =
      quads({{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}, {4, 0, 2}, {4, 3, 2}}, {{0, 1, 2, 3}, {1, 4, 5, 2}});
  for (const Mesh& mesh : {sheet, joined(sheet, shapes::inverted(sheet))}) {
    const Repaired made = repair(mesh, fitRepairGrid(mesh, {.resolution = 64}));
    EXPECT_EQ(made.report.depth, RepairDepth::Mended);
    EXPECT_TRUE(isAllRight(Model(made.mesh)));
    EXPECT_NEAR(made.report.after.signedVolume, 18.0 * made.report.leastThickness, 1e-5);
    EXPECT_DOUBLE_EQ(made.report.thickenedShare, 1.0);
    EXPECT_EQ(made.report.cleanedFaces, mesh.triangles.size() - sheet.triangles.size());
    EXPECT_EQ(made.report.unitedFaces, 0u);
  }
}

TEST(UniteParts, MakesPlatesOfSheetsWithBothSides) {
  const Mesh box = shapes::box({0, 0, 0}, {2, 2, 2});
  const Mesh fin = quads({{3, 0, 0}, {5, 0, 0}, {5, 2, 0}, {3, 2, 0}}, {{0, 1, 2, 3}});
  const Mesh mesh = join({box, fin, shapes::inverted(fin)});
  ASSERT_TRUE(diagnose(mesh).balanced);
  const UnitedParts united = uniteParts(Model(mesh), {InsideOut::Turned, true, 0.125});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 8.5, 1e-6);
  EXPECT_NEAR(united.thickenedShare, 4.0 / 28.0, 1e-6);
  EXPECT_EQ(united.cleanedFaces, 2u);
  EXPECT_EQ(united.cutFaces, 0u);
  for (size_t f = 0; f < united.sources.size(); ++f) {
    ASSERT_LT(united.sources[f], 14u);
    if (united.sources[f] >= 12u) continue;
    EXPECT_EQ(cornersOf(united.mesh, united.mesh.triangles[f]),
              cornersOf(mesh, mesh.triangles[united.sources[f]]));
  }
  EXPECT_EQ(uniteParts(Model(mesh), {InsideOut::Turned, true, 0.0}).failure, FieldReason::Sheet);
  EXPECT_EQ(united.lostShare, 0.0);
  // A small one is left out if it cannot become a plate.
  const Mesh scale = quads({{3, 0, 0}, {3.25, 0, 0}, {3.25, 0.4, 0}, {3, 0.4, 0}}, {{0, 1, 2, 3}});
  const UnitedParts without =
      uniteParts(Model(join({box, scale, shapes::inverted(scale)})), {InsideOut::Turned, true, 0.0});
  ASSERT_EQ(without.failure, FieldReason::None);
  EXPECT_EQ(without.mesh.triangles.size(), box.triangles.size());
  EXPECT_NEAR(without.lostShare, 0.2 / 24.2, 1e-6);
  EXPECT_EQ(without.lostBounds, (Box{{3, 0, 0}, {3.25, 0.4F, 0}}));
  // A wall between two solids is no sheet.
  expectUnion(join({box, shapes::box({2, 0, 0}, {3, 2, 2})}), 12.0, 32.0);
}

TEST(UniteParts, MakesPlatesOfSheetsThatShareEdgesWithSolids) {
  const Mesh fin = quads({{0, 0, 2}, {2, 0, 2}, {2, 0, 4}, {0, 0, 4}}, {{0, 1, 2, 3}});
  const Mesh mesh = join({shapes::box({0, 0, 0}, {2, 2, 2}), fin});
  ASSERT_EQ(diagnose(mesh).sheets, 0u);  // It is one component with the box.
  const UnitedParts united = uniteParts(Model(mesh), {InsideOut::Turned, true, 0.25});
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 9.0, 1e-4);
}

TEST(UniteParts, KeepsOneSideOfSolidsWithBoth) {
  const Mesh box = shapes::box({0, 0, 0}, {2, 2, 2}), ball = shapes::sphere(1.0, 3, {5, 0, 0});
  for (const Mesh& mesh : {join({ball, shapes::inverted(ball)}), join({shapes::inverted(ball), ball})}) {
    const UnitedParts united = uniteParts(Model(mesh), {InsideOut::Turned, true, 0.1});
    ASSERT_EQ(united.failure, FieldReason::None);
    EXPECT_EQ(united.mesh.triangles.size(), ball.triangles.size());
    EXPECT_NEAR(diagnose(united.mesh).signedVolume, diagnose(ball).signedVolume, 1e-6);
  }
  const UnitedParts united =
      uniteParts(Model(join({box, ball, shapes::inverted(ball)})), {InsideOut::Turned, true, 0.1});
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 8.0 + diagnose(ball).signedVolume, 1e-5);
  EXPECT_EQ(united.cleanedFaces, ball.triangles.size());
}

TEST(UniteParts, FillsBubblesBetweenPlates) {
  // Within the plates of a box's sides: narrower than they are thick, or wider. One face of a box else.
  const Mesh ball = shapes::sphere(8.0, 3, {-20, 0, 0});
  const auto cavitiesOf = [](const UnitedParts& united) {
    const Pieces found = findPieces(Model(united.mesh));
    return std::ranges::count_if(found.pieces, &Piece::isCavity);
  };
  const auto unite = [&](const Mesh& sheets) {
    return uniteParts(Model(join({ball, oneTurned(sheets)})), {InsideOut::Turned, true, 1.0});
  };
  const UnitedParts narrow = unite(panels({0, 0, 0}, {1.5, 1.5, 1.5}, 0.2));
  ASSERT_EQ(narrow.failure, FieldReason::None);
  EXPECT_EQ(cavitiesOf(narrow), 0);
  EXPECT_EQ(narrow.sources.size(), narrow.mesh.triangles.size());
  EXPECT_EQ(cavitiesOf(unite(panels({0, 0, 0}, {2.5, 2.5, 2.5}, 0.2))), 1);
  // A bubble that was given.
  const Mesh bubble = shapes::inverted(shapes::sphere(0.2, 2, {-20, 0, 0}));
  EXPECT_EQ(
      cavitiesOf(unite(join({bubble, quads({{3, 0, 0}, {5, 0, 0}, {5, 2, 0}, {3, 2, 0}}, {{0, 1, 2, 3}})}))),
      1);
}

TEST(UniteParts, RepairMakesPlatesAsThickAsAFieldWould) {
  const Mesh fin = quads({{3, 0, 0}, {5, 0, 0}, {5, 2, 0}, {3, 2, 0}}, {{0, 1, 2, 3}});
  const Mesh mesh = join({shapes::box({0, 0, 0}, {2, 2, 2}), fin});
  const RepairGrid grid = fitRepairGrid(mesh, {.resolution = 32});
  const Repaired made = repair(mesh, grid);
  EXPECT_EQ(made.report.depth, RepairDepth::Mended);
  EXPECT_DOUBLE_EQ(made.report.leastThickness, kThinnestWall * grid.spacing);
  EXPECT_NEAR(made.report.after.signedVolume, 8.0 + 4.0 * made.report.leastThickness, 1e-5);
  EXPECT_NEAR(made.report.thickenedShare, 4.0 / 28.0, 1e-6);
  EXPECT_EQ(repair(mesh, grid, {}, {.minThickness = 0.0}).report.fieldReason, FieldReason::Sheet);
}

TEST(UniteParts, ClosesBowlsBesideSolids) {
  // Less than half of a ball is a sheet, but no plate once it is closed.
  Mesh bowl = shapes::sphere(1.0, 3);
  std::erase_if(bowl.triangles, [&](const glm::uvec3& t) { return bowl.position(t.x).z > -0.1; });
  const Mesh mesh = join({shapes::sphere(2.0, 3, {5, 0, 0}), bowl});
  ASSERT_EQ(diagnose(mesh).sheets, 1u);
  const Repaired made = repair(mesh, fitRepairGrid(mesh, {.resolution = 32}));
  EXPECT_EQ(made.report.depth, RepairDepth::Mended);
  EXPECT_EQ(made.report.closedHoles, 1u);
  EXPECT_EQ(made.report.thickenedShare, 0.0);
}

TEST(UniteParts, SewsNoRimsOfPartsThatContradictEachOther) {
  constexpr double kGap = 1e-3, kThickness = 0.1;
  Mesh open = shapes::box({0, 0, 0}, {2, 2, 2});
  std::erase_if(open.triangles, [&](const glm::uvec3& t) {
    return open.position(t.x).z + open.position(t.y).z + open.position(t.z).z == 6.0;
  });
  ASSERT_EQ(open.triangles.size(), 10u);
  const double z = 2.0 + kGap;
  const std::vector<glm::dvec3> corners{{0, 0, z}, {2, 0, z}, {2, 2, z}, {0, 2, z}};
  const Mesh up = quads(corners, {{0, 1, 2, 3}}), down = quads(corners, {{3, 2, 1, 0}});
  const UnitedParts sewn = uniteParts(Model(join({open, up})), {InsideOut::Turned, true, kThickness});
  ASSERT_EQ(sewn.failure, FieldReason::None);
  EXPECT_EQ(sewn.sewnVertices, 4u);
  EXPECT_NEAR(diagnose(sewn.mesh).signedVolume, 8.0, 4.1 * kGap);
  const UnitedParts apart = uniteParts(Model(join({open, down})), {InsideOut::Turned, true, kThickness});
  ASSERT_EQ(apart.failure, FieldReason::None);
  EXPECT_EQ(apart.sewnVertices, 0u);
  EXPECT_NEAR(diagnose(apart.mesh).signedVolume, 8.0 + 4.0 * (kGap + 0.5 * kThickness), 1e-4);
}

TEST(UniteParts, TurnsLonePartsInsideOut) {
  const Mesh lone = shapes::inverted(shapes::box({5, 5, 5}, {6, 6, 6}));
  const Mesh mesh = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3}), lone});
  const UnitedParts united = uniteParts(Model(mesh));
  ASSERT_EQ(united.failure, FieldReason::None);
  EXPECT_TRUE(isAllRight(Model(united.mesh)));
  EXPECT_NEAR(diagnose(united.mesh).signedVolume, 16.0, 1e-5);
  std::vector<uint32_t> faces(12);
  std::iota(faces.begin(), faces.end(), 24u);
  EXPECT_EQ(united.turned, faces);
}

TEST(UniteParts, TellsWhatShareOfTheAreaLiesInside) {
  const UnitedParts nested =
      uniteParts(Model(join({shapes::box({0, 0, 0}, {3, 3, 3}), shapes::box({1, 1, 1}, {2, 2, 2})})));
  EXPECT_NEAR(nested.buriedShare, 6.0 / 60.0, 1e-6);
  const UnitedParts crossing =
      uniteParts(Model(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})})));
  EXPECT_NEAR(crossing.buriedShare, 6.0 / 48.0, 1e-6);
  const Mesh mesh = join({shapes::box({0, 0, 0}, {3, 3, 3}), shapes::box({1, 1, 1}, {2, 2, 2})});
  const Repaired made = repair(mesh, fitRepairGrid(mesh, {.resolution = 16}));
  EXPECT_NEAR(made.report.buriedShare, 6.0 / 60.0, 1e-6);
}

TEST(UniteParts, NumbersTurnedFacesAsGiven) {
  // The first face is repeated, so others move up before a hole is closed and the lone box is turned.
  Mesh mesh = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3}),
                    shapes::inverted(shapes::box({5, 5, 5}, {6, 6, 6}))});
  mesh.triangles.insert(mesh.triangles.begin() + 1, {0, 0, 1});
  mesh.triangles.erase(mesh.triangles.begin());
  const UnitedParts united = uniteParts(Model(mesh), {InsideOut::Turned, true});
  ASSERT_EQ(united.failure, FieldReason::None);
  std::vector<uint32_t> faces(12);
  std::iota(faces.begin(), faces.end(), 24u);
  EXPECT_EQ(united.turned, faces);
}

TEST(UniteParts, RepairKeepsTheFacesOfCrossingParts) {
  const Mesh mesh = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})});
  const Repaired made = repair(mesh, fitRepairGrid(mesh, {.resolution = 16}));
  EXPECT_EQ(made.report.depth, RepairDepth::Mended);
  EXPECT_EQ(made.report.fieldReason, FieldReason::None);
  EXPECT_EQ(made.report.unitedFaces, 12u);
  EXPECT_NEAR(made.report.after.signedVolume, 15.0, 1e-6);
}

}  // namespace
}  // namespace raymap
