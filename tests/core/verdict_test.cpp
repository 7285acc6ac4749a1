#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <string>

#include "shapes.h"

namespace raymap {
namespace {

Verdict judged(const Mesh& mesh) {
  const Diagnostics found = diagnose(mesh);
  const SelfIntersections crossings = findSelfIntersections(mesh);
  return judge(found, crossings, arrangeParts(mesh, found, crossings));
}

MeshKind kindOf(const Mesh& mesh) {
  return judged(mesh).kind;
}

Mesh turned(Mesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.x, t.y);
  return mesh;
}

/// A square box without its lid. The hole's share of the closed box is 1 / (2 + 4 depth).
Mesh tray(double depth) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, depth});
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return mesh.position(t.x).z > 0.0 && mesh.position(t.y).z > 0.0 && mesh.position(t.z).z > 0.0;
  });
  return mesh;
}

/// A square of area 1.
Mesh plate() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh doubled(const Mesh& mesh) {
  return shapes::joined(mesh, turned(mesh));
}

TEST(Verdict, NamesCleanSolids) {
  const Verdict one = judged(shapes::sphere(1.0, 2));
  EXPECT_EQ(one.kind, MeshKind::CleanSolid);
  EXPECT_EQ(one.remedy, Remedy::None);
  const Verdict two = judged(shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(1.0, 2, {5, 0, 0})));
  EXPECT_EQ(two.kind, MeshKind::SeveralSolids);
  EXPECT_EQ(two.remedy, Remedy::None);
}

TEST(Verdict, TellsCavitiesFromSolidsInsideOut) {
  const Mesh ball = shapes::sphere(1.0, 2), cavity = turned(shapes::sphere(0.5, 2));
  const Diagnostics hollow = diagnose(shapes::joined(ball, cavity));
  EXPECT_EQ(hollow.inwardComponents, 1u);
  EXPECT_EQ(hollow.openComponents, 0u);
  EXPECT_EQ(kindOf(shapes::joined(ball, cavity)), MeshKind::CleanSolid);
  EXPECT_EQ(judged(turned(ball)).kind, MeshKind::InsideOut);
  EXPECT_EQ(judged(turned(ball)).remedy, Remedy::Repair);
  EXPECT_EQ(kindOf(turned(shapes::joined(ball, shapes::sphere(1.0, 2, {5, 0, 0})))), MeshKind::InsideOut);
}

TEST(Verdict, CountsCrossings) {
  const Mesh two = shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(1.0, 2, {1, 0.1, 0.2}));
  EXPECT_EQ(judged(two).kind, MeshKind::OverlappingSolids);
  EXPECT_EQ(judged(two).remedy, Remedy::Repair);
  EXPECT_EQ(judge(diagnose(two), std::nullopt).kind, MeshKind::SeveralSolids);
  Mesh dented = shapes::sphere(1.0, 2);
  dented.vertices[0] = dented.vertices[0] * -1.5f;  // Through the other side.
  EXPECT_EQ(kindOf(dented), MeshKind::CrossingSolid);
}

TEST(Verdict, TellsHowPartsLie) {
  const auto cube = [](double low, double high) { return shapes::box(glm::dvec3(low), glm::dvec3(high)); };
  const auto kindWith = [&](const Mesh& other) { return kindOf(shapes::joined(cube(0, 10), other)); };
  EXPECT_EQ(kindWith(shapes::box({10, 1, 1}, {20, 9, 9})), MeshKind::TouchingSolids);
  EXPECT_EQ(kindWith(cube(2, 8)), MeshKind::MisnestedSolids);
  EXPECT_EQ(kindWith(turned(cube(11, 12))), MeshKind::MisnestedSolids);
  EXPECT_EQ(kindWith(shapes::box({5, 0, 0}, {15, 10, 10})), MeshKind::OverlappingSolids);
  EXPECT_EQ(kindOf(turned(shapes::joined(cube(0, 10), cube(2, 8)))), MeshKind::InsideOut);
  Mesh dented = shapes::sphere(1.0, 2);
  dented.vertices[0] = dented.vertices[0] * -1.5f;
  EXPECT_EQ(kindWith(dented), MeshKind::OverlappingSolids);
  EXPECT_EQ(kindOf(shapes::joined(dented, cube(5, 6))), MeshKind::CrossingSolid);
  const Verdict nested = judged(shapes::joined(cube(0, 10), cube(2, 8)));
  EXPECT_EQ(nested.arrangement, Arrangement::Misnested);
  EXPECT_EQ(nested.remedy, Remedy::Repair);
}

TEST(Verdict, NamesSmallFaults) {
  // Two boxes that share an edge.
  const Mesh boxes = shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1}));
  EXPECT_EQ(kindOf(boxes), MeshKind::FlawedSolid);
  EXPECT_EQ(judged(boxes).remedy, Remedy::Repair);
  Mesh repeated = shapes::box({0, 0, 0}, {1, 1, 1});
  repeated.triangles.push_back({0, 0, 1});
  EXPECT_EQ(kindOf(repeated), MeshKind::FlawedSolid);
}

TEST(Verdict, FindsTurnedFacesOfClosedSurfacesOnly) {
  Mesh mesh = shapes::sphere(1.0, 2);
  std::swap(mesh.triangles[7].x, mesh.triangles[7].y);
  EXPECT_EQ(judged(mesh).kind, MeshKind::TurnedFaces);
  EXPECT_EQ(judged(mesh).remedy, Remedy::Repair);
  mesh.triangles.pop_back();
  EXPECT_EQ(kindOf(mesh), MeshKind::OpenSolid);
}

TEST(Verdict, TellsSheetsFromSolidsWithHoles) {
  EXPECT_EQ(kindOf(tray(0.34)), MeshKind::OpenSolid);
  EXPECT_EQ(judged(tray(0.34)).remedy, Remedy::Repair);
  EXPECT_EQ(kindOf(tray(0.33)), MeshKind::Sheet);
  EXPECT_EQ(judged(plate()).kind, MeshKind::Sheet);
  EXPECT_EQ(judged(plate()).remedy, Remedy::Thicken);
}

TEST(Verdict, JudgesByTheLargerPart) {
  const auto boxed = [](double side) { return shapes::box({5, 5, 5}, glm::dvec3(5.0 + side)); };
  const Diagnostics found = diagnose(shapes::joined(boxed(1.0), plate()));
  EXPECT_EQ(found.components, 2u);
  EXPECT_EQ(found.openComponents, 1u);
  EXPECT_EQ(found.sheets, 1u);
  EXPECT_NEAR(found.sheetShare, 1.0 / 7.0, 1e-12);
  EXPECT_EQ(kindOf(shapes::joined(boxed(0.42), plate())), MeshKind::OpenSolid);  // Its area is 1.06.
  EXPECT_EQ(kindOf(shapes::joined(boxed(0.40), plate())), MeshKind::Sheet);      // Its area is 0.96.
}

TEST(Verdict, JudgesDoubleSidedModelsByOneSide) {
  const Verdict ball = judged(doubled(shapes::sphere(1.0, 2)));
  EXPECT_EQ(ball.kind, MeshKind::DoubleSided);
  EXPECT_EQ(ball.remedy, Remedy::Repair);
  EXPECT_EQ(judged(doubled(plate())).kind, MeshKind::DoubleSided);
  EXPECT_EQ(judged(doubled(plate())).remedy, Remedy::Thicken);
  EXPECT_EQ(diagnose(doubled(plate())).openComponents, 1u);
  EXPECT_EQ(diagnose(doubled(shapes::sphere(1.0, 2))).openComponents, 0u);
}

TEST(Verdict, NeedsHalfOfTheFacesToBeDoubleSided) {
  Diagnostics found{.triangles = 100, .doubleSidedFaces = 50};
  EXPECT_TRUE(isDoubleSided(found));
  found.doubleSidedFaces = 49;
  EXPECT_FALSE(isDoubleSided(found));
  EXPECT_FALSE(isDoubleSided({}));
}

TEST(Verdict, NamesSoups) {
  EXPECT_EQ(judged(shapes::soup(100, 1)).kind, MeshKind::Soup);
  EXPECT_EQ(judged(shapes::soup(100, 1)).remedy, Remedy::Repair);
  EXPECT_EQ(kindOf(shapes::soup(1, 1)), MeshKind::Sheet);
  Diagnostics found{.triangles = 100, .boundaryEdges = 101, .components = 25, .area = 1.0};
  EXPECT_EQ(judge(found, std::nullopt).kind, MeshKind::Soup);
  found.components = 24;
  EXPECT_EQ(judge(found, std::nullopt).kind, MeshKind::OpenSolid);
  found.components = 25;
  found.boundaryEdges = 100;
  EXPECT_EQ(judge(found, std::nullopt).kind, MeshKind::OpenSolid);
}

TEST(Verdict, KnowsThatThereIsNoSurface) {
  Mesh mesh = plate();
  mesh.triangles = {{0, 0, 1}};
  EXPECT_EQ(judged(mesh).kind, MeshKind::NoSurface);
  EXPECT_EQ(judged(mesh).remedy, Remedy::None);
}

TEST(Verdict, GivesTheVoxelSizeThatKeepsTheThinnestPart) {
  const auto slab = [](double depth) {
    const Mesh mesh = shapes::box({0, 0, 0}, {10, 10, depth});
    return judge(mesh, diagnose(mesh), findSelfIntersections(mesh));
  };
  EXPECT_EQ(slab(0.25).kind, MeshKind::CleanSolid);
  EXPECT_DOUBLE_EQ(slab(0.25).sought, 0.4);
  EXPECT_NEAR(slab(0.25).thinnest.value(), 0.25, 1e-6);
  EXPECT_DOUBLE_EQ(slab(0.25).voxelSize.value(), 0.12);
  EXPECT_DOUBLE_EQ(slab(0.2).voxelSize.value(), 0.1);
  EXPECT_DOUBLE_EQ(slab(0.199).voxelSize.value(), 0.099);
  EXPECT_DOUBLE_EQ(slab(0.5).sought, 0.4);
  EXPECT_FALSE(slab(0.5).thinnest.has_value());
  EXPECT_FALSE(slab(0.5).voxelSize.has_value());
  const Verdict sheet = judge(plate(), diagnose(plate()), findSelfIntersections(plate()));
  EXPECT_EQ(sheet.kind, MeshKind::Sheet);
  EXPECT_EQ(sheet.sought, 0.0);
}

TEST(Verdict, FindsTheThinnestPart) {
  const Mesh slab = shapes::box({0, 0, 0}, {10, 10, 0.25});
  EXPECT_NEAR(findThinnest(slab, 1.0).value(), 0.25, 1e-6);
  EXPECT_FALSE(findThinnest(slab, 0.2).has_value());
  EXPECT_FALSE(findThinnest(shapes::sphere(1.0, 3), 0.5).has_value());
}

TEST(Verdict, LeavesOutTheThinnestFiveHundredthOfTheArea) {
  const Mesh cube = shapes::box({0, 0, 0}, {10, 10, 10});  // Its area is 600, and a side of a slab's is half.
  const auto withSlab = [&](double side) {
    return shapes::joined(cube, shapes::box({20, 0, 0}, {20 + side, side, 0.01}));
  };
  EXPECT_FALSE(findThinnest(withSlab(0.7), 1.0).has_value());         // 0.16 %
  EXPECT_NEAR(findThinnest(withSlab(0.9), 1.0).value(), 0.01, 1e-4);  // 0.27 %
}

TEST(Verdict, HasWords) {
  const Diagnostics found = diagnose(tray(1.0));
  EXPECT_EQ(
      describe(judge(found, {}), found, {}),
      "a solid with holes, as scans have: 1 hole, 1.41 wide. Faces that cross and parts that overlap were "
      "not looked for.");
  EXPECT_EQ(describeDefects(found, {}), "4 boundary edges");
  EXPECT_EQ(describeDefects(diagnose(shapes::sphere(1.0, 2)), SelfIntersections{}), "nothing");
  EXPECT_STREQ(describe(Arrangement::Touching), "parts of it touch");
  EXPECT_STREQ(describe(Arrangement::Nested), "");
  EXPECT_EQ(counted(1234567, "face"), "1,234,567 faces");
  EXPECT_EQ(rounded(1234.5), "1,235");
}

TEST(Verdict, SaysOfASoupWhatItsRepairDoes) {
  Mesh soup;
  for (const glm::uvec3& t : shapes::box({0, 0, 0}, {10, 10, 0.1}).triangles) {
    const Mesh box = shapes::box({0, 0, 0}, {10, 10, 0.1});
    const auto first = uint32_t(soup.vertices.size());
    const glm::vec3 shift(0.001f * float(first), 0.0f, 0.0f);
    for (int c = 0; c < 3; ++c) soup.vertices.push_back(box.vertices[t[c]] + shift);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  const Verdict verdict = judge(soup, diagnose(soup), findSelfIntersections(soup));
  ASSERT_EQ(verdict.kind, MeshKind::Soup);
  const RepairGrid grid = fitRepairGrid(soup);
  EXPECT_EQ(std::max({grid.dims.x, grid.dims.y, grid.dims.z}), 128);
  const std::string words = describeThickness(soup, verdict);
  EXPECT_NE(words.find("128 samples"), std::string::npos) << words;
  EXPECT_NE(words.find("what is thinner " + rounded(kThinnestWall * grid.spacing) + " thick"),
            std::string::npos)
      << words;
}

TEST(Verdict, HasNames) {
  EXPECT_EQ(name(MeshKind::NoSurface), "no_surface");
  EXPECT_EQ(name(MeshKind::OpenSolid), "open_solid");
  EXPECT_EQ(name(MeshKind::MisnestedSolids), "misnested_solids");
  EXPECT_EQ(name(Arrangement::Touching), "touching");
  EXPECT_EQ(name(MeshKind::CleanSolid), "clean_solid");
  EXPECT_EQ(name(Remedy::Thicken), "thicken");
}

}  // namespace
}  // namespace raymap
