// The level sets of .vdb and .nvdb files, as OpenVDB's own checks see them.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/Diagnostics.h>
#include <raymap/raymap.h>

#include <cmath>
#include <string>

#include "bands.h"
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

using openvdb::FloatGrid;

class LevelSet : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name = "a.vdb") const { return folder_.path() / name; }

  FloatGrid::Ptr load(const std::string& name = "a.vdb") const {
    openvdb::initialize();
    openvdb::io::File file(path(name).string());
    file.open(false);
    return openvdb::gridPtrCast<FloatGrid>(file.readGrid("distance"));
  }

 private:
  TemporaryFolder folder_;
};

/// Returns what OpenVDB finds wrong with a level set, but for its slope, and whether active values reach the
/// background.
std::string faultsOf(const FloatGrid& grid, double band) {
  openvdb::tools::CheckLevelSet<FloatGrid> check(grid);
  std::string faults = check.checkBackground(band);
  for (const std::string& fault : {check.checkClassType(), check.checkTransform(), check.checkTiles(),
                                   check.checkFinite(), check.checkRange(), check.checkInactiveValues()})
    faults += fault;
  for (auto value = grid.cbeginValueOn(); value; ++value)
    if (std::abs(*value) >= grid.background()) return faults + "An active value reaches the background";
  return faults;
}

Field ball(double spacing, double band, bool align = false) {
  const Mesh mesh = shapes::sphere(20.0 * spacing, 2);
  const Grid grid = fitGrid(mesh, {.voxelSize = spacing, .align = align});
  return generate(mesh, grid, {.band = band}, {.device = "cpu"}).field;
}

TEST_F(LevelSet, HasABackgroundOfTheWholeBand) {
  for (const double spacing : {0.02, 0.0144193, 0.01, 0.1, 1.0 / 3.0, 0.0625, 7.77, 1234.567})
    for (const bool half : {false, true}) {
      const Field field = ball(spacing, 3.0);
      writeField(path(), field, {.half = half});
      EXPECT_EQ(faultsOf(*load(), 3.0), "") << spacing << half;
      writeField(path(), toSparse(field), {.half = half});
      EXPECT_EQ(faultsOf(*load(), 3.0), "") << spacing << half;
    }
}

TEST_F(LevelSet, KeepsItsWidthsWithHalfFloats) {
  const Field field = ball(0.0144193, 3.0);
  float clamped = 0.0F;
  for (const float distance : field.distance) clamped = std::max(clamped, distance);
  for (const char* name : {"a.vdb", "a.nvdb"}) {
    writeField(path(name), field, {.half = true});
    const Field again = readField(path(name));
    for (size_t s = 0; s < field.distance.size(); ++s)
      if (std::abs(field.distance[s]) == clamped) {
        ASSERT_EQ(again.distance[s], field.distance[s]);
      } else {
        ASSERT_NEAR(again.distance[s], field.distance[s], clamped / 2000.0);
        ASSERT_LE(std::abs(again.distance[s]), clamped);
      }
    writeField(path("again.vdb"), again, {.half = true});
    EXPECT_EQ(faultsOf(*load("again.vdb"), 3.0), "");
  }
}

TEST_F(LevelSet, OfBothWidthsHasEachInFull) {
  const Field field = ball(0.02, 6.0);
  const Field band = toSparse(field, {.outside = 3.0, .inside = 5.0});
  writeField(path(), band, {.half = true});
  const FloatGrid::Ptr grid = load();
  EXPECT_GE(grid->background(), band.narrow->outside);
  float least = 0.0F;
  for (auto value = grid->cbeginValueOff(); value; ++value) least = std::min(least, *value);
  EXPECT_LE(double(least), -band.narrow->inside);
  EXPECT_NEAR(least, -band.narrow->inside, 1e-3 * band.narrow->inside);
  EXPECT_EQ(readBand(path()).narrow->inside, band.narrow->inside);
}

TEST_F(LevelSet, WithoutABandIsActiveEverywhere) {
  const Field field = ball(0.02, 0.0);
  for (const bool half : {false, true}) {
    writeField(path(), field, {.half = half});
    const FloatGrid::Ptr grid = load();
    EXPECT_EQ(grid->activeVoxelCount(), field.grid.sampleCount());
    EXPECT_EQ(faultsOf(*grid, 0.0), "") << half;
  }
}

TEST_F(LevelSet, OfAlignedGridsCombines) {
  const auto write = [&](const char* name, const glm::dvec3& centre, bool isSparse) {
    Mesh mesh = shapes::sphere(0.3, 2);
    mesh.origin += centre;
    const Grid grid = fitGrid(mesh, {.voxelSize = 0.02, .align = true});
    const Field field = generate(mesh, grid, {.band = 3.0}, {.device = "cpu"}).field;
    if (isSparse)
      writeField(path(name), toSparse(field));
    else
      writeField(path(name), field);
    const Field again = readField(path(name));
    EXPECT_EQ(again.grid, grid);
    EXPECT_TRUE(std::ranges::equal(again.distance, field.distance));
  };
  write("a.vdb", {-0.5, 1.0, 3.0}, false);
  write("b.vdb", {-0.3, 1.1, 3.05}, true);
  const FloatGrid::Ptr a = load("a.vdb"), b = load("b.vdb");
  ASSERT_TRUE(a->transform() == b->transform());
  EXPECT_EQ(a->transform().indexToWorld(openvdb::Vec3d(0.0)), openvdb::Vec3d(0.0));
  openvdb::tools::csgUnion(*a, *b);
  const auto at = [&](double x, double y, double z) {
    return a->tree().getValue(a->transform().worldToIndexCellCentered({x, y, z}));
  };
  EXPECT_LT(at(-0.5, 1.0, 3.0), 0.0F);
  EXPECT_LT(at(-0.1, 1.1, 3.05), 0.0F);
  EXPECT_GT(at(-0.9, 1.0, 3.0), 0.0F);
  EXPECT_NEAR(at(-0.8, 1.0, 3.0), 0.0, 0.02);
}

TEST_F(LevelSet, IsShiftedByWholeLeavesAlone) {
  const auto transformOf = [&](const glm::dvec3& origin) {
    Field field{.grid = {glm::ivec3(4), origin, 0.5}, .distance = Buffer<float>(64)};
    for (size_t s = 0; s < 64; ++s) field.distance[s] = float(s) - 20.0F;
    writeField(path(), field);
    EXPECT_EQ(readField(path()).grid, field.grid);
    return load()->transform().indexToWorld(openvdb::Vec3d(0.0));
  };
  EXPECT_EQ(transformOf({4, -8, 0}), openvdb::Vec3d(0.0));
  EXPECT_EQ(transformOf({4, -8, 0.5}), openvdb::Vec3d(4, -8, 0.5)) << "no whole leaf";
  EXPECT_EQ(transformOf({4, -8, 0.001}), openvdb::Vec3d(4, -8, 0.001));
  EXPECT_EQ(transformOf({0, 0, 4e9}), openvdb::Vec3d(0, 0, 4e9)) << "too far for 32 bits";
}

}  // namespace
}  // namespace raymap
