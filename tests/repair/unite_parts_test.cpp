#include "repair/topology/unite_parts.h"

#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <utility>

#include "mesh/diagnostics.h"
#include "repair/topology/mend.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::joined;

Mesh join(std::initializer_list<Mesh> parts) {
  Mesh mesh = *parts.begin();
  for (auto part = parts.begin() + 1; part != parts.end(); ++part) mesh = joined(mesh, *part);
  return mesh;
}

/// Expects a union with nothing wrong, and this volume and area.
void expectUnion(const Mesh& mesh, double volume, double area, double tolerance = 1e-6) {
  const UnitedParts united = uniteParts(Model(mesh), true);
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
  EXPECT_EQ(uniteParts(Model(mesh), true).inverted.faces.size(), 12u);
}

TEST(UniteParts, PartsSolidsAtACommonEdge) {
  // The edge's middle moves by a thousandth of its length into each box.
  expectUnion(join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, 2, 0}, {4, 4, 2})}), 16.0, 48.0, 1e-3);
}

TEST(UniteParts, KeepsFacesThatNothingMeets) {
  const glm::dvec3 aside(1.61, 0.13, 0.07);
  const Mesh mesh = join({shapes::sphere(1.0, 3), shapes::sphere(1.0, 3, aside)});
  const UnitedParts united = uniteParts(Model(mesh), true);
  ASSERT_EQ(united.failure, FieldReason::None);
  const auto cornersOf = [](const Mesh& m, const glm::uvec3& t) {
    return std::array{glm::vec3(m.position(t.x)), glm::vec3(m.position(t.y)), glm::vec3(m.position(t.z))};
  };
  size_t kept = 0;
  for (const glm::uvec3& t : united.mesh.triangles)
    kept += std::ranges::any_of(mesh.triangles, [&](const glm::uvec3& given) {
      const auto a = cornersOf(mesh, given), b = cornersOf(united.mesh, t);
      return std::memcmp(a.data(), b.data(), sizeof a) == 0;
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

TEST(UniteParts, LeavesOpenMeshesAndLonePartsInsideOutToTheField) {
  Mesh open = join({shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({1, 1, 1}, {3, 3, 3})});
  open.triangles.pop_back();
  EXPECT_EQ(uniteParts(Model(open), true).failure, FieldReason::Open);
  const Mesh lone = shapes::inverted(shapes::box({5, 5, 5}, {6, 6, 6}));
  EXPECT_EQ(uniteParts(Model(join({shapes::box({0, 0, 0}, {2, 2, 2}), lone})), true).failure,
            FieldReason::InsideOut);
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
