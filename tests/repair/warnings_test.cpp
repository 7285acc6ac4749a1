#include <gtest/gtest.h>
#include <raymap/repair.h>

#include <algorithm>

#include "broken_meshes.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::inverted;
using shapes::joined;

/// Returns the only warning with a code; nothing if there is none.
std::optional<Warning> onlyWarning(WarningCode code, const Mesh& mesh, const RepairOptions& options,
                                   const GridOptions& grid) {
  const Repaired made = repair(mesh, fitRepairGrid(mesh, grid, options), {}, options, {.device = "cpu"});
  std::optional<Warning> found;
  for (const Warning& warning : made.report.warnings)
    if (warning.code == code) {
      EXPECT_FALSE(found.has_value());
      found = warning;
    }
  return found;
}

/// A square of faces with a bump in the middle.
Mesh bumpySheet(double side, double bump) {
  const std::vector<glm::dvec3> p{
      {0, 0, 0}, {side, 0, 0}, {side, side, 0.1}, {0, side, 0}, {side / 2, side / 2, bump}};
  return makeMesh(p, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
}

TEST(RepairWarnings, TellOfSheets) {
  const Mesh mesh = bumpySheet(10.0, 1.0);
  const GridOptions grid{.resolution = 24};
  const auto warning = onlyWarning(WarningCode::Sheet, mesh, {}, grid);
  ASSERT_TRUE(warning.has_value());
  EXPECT_EQ(warning->fields.length, 0.2);
  EXPECT_NE(warning->message.find(
                "its thickness is a guess; give it one, such as 0.2, or join its rim to a flat base"),
            std::string::npos);
  EXPECT_FALSE(onlyWarning(WarningCode::Sheet, mesh, {.minThickness = 1.2}, grid));
  EXPECT_FALSE(onlyWarning(WarningCode::Sheet, mesh, {.base = -1.0}, grid));
  EXPECT_TRUE(onlyWarning(WarningCode::Sheet, mesh, {.offset = 1.0}, grid));
  EXPECT_FALSE(onlyWarning(WarningCode::Sheet, box({0, 0, 0}, {1, 1, 1}), {}, grid));
}

/// Two boxes without floors that cross. No plane closes them.
Mesh bentBoxes() {
  const Mesh boxes = joined(box({0, 0, 0}, {20, 20, 15}), box({12, 3, 0}, {32, 17, 30}));
  Mesh mesh = keepTriangles(boxes, [&](const glm::uvec3& t) {
    return boxes.position(t.x).z != 0.0 || boxes.position(t.y).z != 0.0 || boxes.position(t.z).z != 0.0;
  });
  for (const size_t part : {0, 8}) {
    const auto low =
        std::min_element(mesh.vertices.begin() + ptrdiff_t(part), mesh.vertices.begin() + ptrdiff_t(part) + 8,
                         [](const glm::vec3& a, const glm::vec3& b) { return a.z < b.z; });
    low->z += 0.5f;
  }
  return mesh;
}

TEST(RepairWarnings, TellHowFarTheResultLeavesTheBounds) {
  const Mesh mesh = bentBoxes();
  const GridOptions fine{.resolution = 48, .padding = 0.25};
  const auto warning = onlyWarning(WarningCode::BoundsLeft, mesh, {.remesh = true}, fine);
  ASSERT_TRUE(warning.has_value());
  EXPECT_GT(warning->fields.length, 2.0 * fitRepairGrid(mesh, fine).spacing);
  EXPECT_LT(warning->fields.length, 9.0);
  EXPECT_NE(warning->message.find("beyond the mesh's lowest z, at ("), std::string::npos) << warning->message;
  EXPECT_EQ(warning->message.find("cut off"), std::string::npos);
  EXPECT_EQ(warning->message.find("box"), std::string::npos);
  EXPECT_FALSE(
      onlyWarning(WarningCode::BoundsLeft, box({0, 0, 0}, {9, 9, 9}), {.offset = 2.0}, {.resolution = 32}));
  // The box of the samples cuts it off.
  const auto cut =
      onlyWarning(WarningCode::BoundsLeft, mesh, {.remesh = true}, {.resolution = 48, .padding = 0.03});
  ASSERT_TRUE(cut.has_value());
  EXPECT_NE(cut->message.find("would reach farther"), std::string::npos) << cut->message;
  EXPECT_FALSE(
      onlyWarning(WarningCode::BoxReached, mesh, {.remesh = true}, {.resolution = 48, .padding = 0.03}));
}

TEST(RepairWarnings, TellOfWallsThatGrow) {
  const auto walls = [](double thickness) {
    return joined(box({0, 0, 0}, {10, 10, 2}), box({1, 4, 1}, {9, 4.0 + thickness, 8}));
  };
  const GridOptions grid{.resolution = 40};
  const double spacing = fitRepairGrid(walls(0.1), grid).spacing;  // 0.28, so that plates are 0.48 thick.
  const auto warning = onlyWarning(WarningCode::PartsThickened, walls(0.1), {.remesh = true}, grid);
  ASSERT_TRUE(warning.has_value());
  EXPECT_NEAR(warning->fields.share, 2.0 * 8.0 * 7.0 / (200.0 + 80.0 + 112.0), 0.05);
  EXPECT_EQ(warning->fields.length, 1.75 * spacing);
  EXPECT_NEAR(warning->fields.voxelSize, 0.05, 0.0011);
  EXPECT_NE(warning->message.find("walls about 0.1 thick"), std::string::npos) << warning->message;
  EXPECT_FALSE(
      onlyWarning(WarningCode::PartsThickened, walls(0.5 * 1.75 * spacing + 0.01), {.remesh = true}, grid));
  EXPECT_TRUE(
      onlyWarning(WarningCode::PartsThickened, walls(0.5 * 1.75 * spacing - 0.01), {.remesh = true}, grid));
  EXPECT_FALSE(
      onlyWarning(WarningCode::PartsThickened, walls(0.1), {.minThickness = 0.7, .remesh = true}, grid));
  const auto thin = onlyWarning(WarningCode::PartsThickened, walls(0.01), {.remesh = true}, grid);
  ASSERT_TRUE(thin.has_value());
  EXPECT_EQ(thin->fields.voxelSize, 0.0);
  EXPECT_NE(thin->message.find("too many"), std::string::npos);
}

TEST(RepairWarnings, TellOfLooseBodies) {
  const Mesh hollow = joined(box({0, 0, 0}, {10, 10, 10}), inverted(box({4, 4, 4}, {6, 6, 6})));
  const GridOptions grid{.resolution = 40};
  const auto warning =
      onlyWarning(WarningCode::LooseBodies, hollow, {.shell = 1.0, .keepCavities = true}, grid);
  ASSERT_TRUE(warning.has_value());
  EXPECT_EQ(warning->fields.count, 1u);
  EXPECT_FALSE(onlyWarning(WarningCode::LooseBodies, hollow, {.shell = 1.0}, grid));
  EXPECT_FALSE(onlyWarning(WarningCode::LooseBodies, hollow, {.keepCavities = true, .remesh = true}, grid));
  // The walls of the box and of the cavity are one.
  EXPECT_FALSE(onlyWarning(WarningCode::LooseBodies, hollow, {.shell = 2.5, .keepCavities = true}, grid));
  // One body was in the cavity before.
  const Mesh full = joined(joined(box({0, 0, 0}, {20, 20, 20}), inverted(box({5, 5, 5}, {15, 15, 15}))),
                           box({7, 7, 7}, {13, 13, 13}));
  const auto more = onlyWarning(WarningCode::LooseBodies, full, {.shell = 1.5, .keepCavities = true}, grid);
  ASSERT_TRUE(more.has_value());
  EXPECT_EQ(more->fields.count, 1u);
}

}  // namespace
}  // namespace raymap
