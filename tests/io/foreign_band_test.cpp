// Narrow bands that OpenVDB made and wrote, against its own accessor.

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "bands.h"
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;
using openvdb::Coord;
using openvdb::FloatGrid;

constexpr double kSpacing = 0.03;

/// Returns OpenVDB's level set of a torus, whose samples lie on both sides of 0.
FloatGrid::Ptr torusGrid(float outside, float inside) {
  openvdb::initialize();
  const Mesh mesh = shapes::torus(1.0, 0.4, 40, 20);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& vertex : mesh.vertices) points.emplace_back(vertex.x, vertex.y, vertex.z);
  for (const auto& triangle : mesh.triangles) triangles.emplace_back(triangle.x, triangle.y, triangle.z);
  auto transform = openvdb::math::Transform::createLinearTransform(kSpacing);
  transform->postTranslate({0.5, -3.0, 7.0});
  for (auto& point : points) point += openvdb::Vec3s(0.5F, -3.0F, 7.0F);
  return openvdb::tools::meshToSignedDistanceField<FloatGrid>(*transform, points, triangles, {}, outside,
                                                              inside);
}

void write(const fs::path& path, const openvdb::GridPtrVec& grids) {
  openvdb::io::File(path.string()).write(grids);
}

/// Returns the sample of a band where a voxel of a grid lies.
glm::ivec3 sampleOf(const FloatGrid& grid, const Field& band, const Coord& voxel) {
  const openvdb::Vec3d at = grid.transform().indexToWorld(voxel);
  return glm::ivec3(glm::round((glm::dvec3(at.x(), at.y(), at.z()) - band.grid.origin) / band.grid.spacing));
}

void expectSameValues(const Field& band, const FloatGrid& grid) {
  validate(band);
  EXPECT_NEAR(band.grid.spacing, kSpacing, 1e-12);
  EXPECT_EQ(float(band.narrow->outside), grid.background());
  const auto accessor = grid.getConstAccessor();
  for (auto value = grid.cbeginValueOn(); value; ++value)
    ASSERT_EQ(band.distanceAt(sampleOf(grid, band, value.getCoord())), *value) << value.getCoord();
  std::mt19937 random(1);
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const auto among = [&](int axis) {
    return int(random() % unsigned(box.dim()[axis] + 8)) + box.min()[axis] - 4;
  };
  for (int i = 0; i < 10'000; ++i) {
    const Coord voxel(among(0), among(1), among(2));
    ASSERT_EQ(band.distanceAt(sampleOf(grid, band, voxel)), accessor.getValue(voxel)) << voxel;
  }
}

TEST(ForeignBand, HasOpenVDBsValues) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "torus.vdb";
  for (const auto& [outside, inside] : {std::pair{3.0F, 3.0F}, {2.0F, 5.0F}, {3.0F, 1000.0F}}) {
    const FloatGrid::Ptr grid = torusGrid(outside, inside);
    write(path, {grid});
    const Field band = readBand(path);
    expectSameValues(band, *grid);
    if (inside == 1000.0F)
      EXPECT_EQ(band.narrow->inside, INFINITY);
    else
      EXPECT_FLOAT_EQ(float(band.narrow->inside), float(inside * kSpacing));
    EXPECT_TRUE(band.surfaceBounds.isEmpty());
    if (inside == outside) {
      EXPECT_EQ(band.activeCount(), grid->activeVoxelCount());
    }
    // The field of all samples has the box of the active ones.
    const Field dense = readField(path);
    const glm::ivec3 first(glm::round((dense.grid.origin - band.grid.origin) / band.grid.spacing));
    const glm::ivec3 more = band.grid.dims - first - dense.grid.dims;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_TRUE(first[axis] >= 0 && first[axis] < 8) << first[axis];
      EXPECT_TRUE(more[axis] >= 0 && more[axis] < 8) << more[axis];
    }
  }
}

TEST(ForeignBand, HasTilesOfAllKinds) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "tiles.vdb";
  const FloatGrid::Ptr grid = torusGrid(3.0F, 3.0F);
  // Off the lattice of larger tiles, as the lattice begins at the first leaf.
  grid->tree().addTile(2, Coord(128, 128, 0), -grid->background(), false);
  grid->tree().addTile(2, Coord(-128, -128, 0), 0.5F * grid->background(), true);
  grid->tree().addTile(1, Coord(64, -8, 8), -0.25F * grid->background(), false);
  write(path, {grid});
  const Field band = readBand(path);
  expectSameValues(band, *grid);
  EXPECT_LT(band.narrow->tiles.size(), 2000u);
}

TEST(ForeignBand, ComesFromTheLevelSetAmongOthers) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "several.vdb";
  const FloatGrid::Ptr grid = torusGrid(2.0F, 2.0F), other = torusGrid(3.0F, 2.0F);
  grid->setName("surface");
  other->setName("wider");
  grid->setSaveFloatAsHalf(true);
  const FloatGrid::Ptr fog = FloatGrid::create(0.0F);
  fog->setName("density");
  fog->tree().setValueOn(Coord(1, 2, 3), 1.0F);
  write(path, {fog, grid, other});
  std::string warning;
  const Field band = readBand(path, {.warn = [&](const Warning& each) { warning = each.message; }});
  EXPECT_NE(warning.find("'density' and 'wider'"), std::string::npos) << warning;
  openvdb::io::File file(path.string());
  file.open();
  expectSameValues(band, *openvdb::gridPtrCast<FloatGrid>(file.readGrid("surface")));
  expectSameValues(readBand(path, {.gridName = "wider"}), *other);
  EXPECT_THROW(readBand(path, {.gridName = "density"}), Error);
  EXPECT_EQ(readField(path, {.gridName = "density"}).distance.size(), 1u);
}

TEST(ForeignBand, RefusesGridsThatItHasNoPlaceFor) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "refused.vdb";
  const auto refusal = [&](const FloatGrid& grid) -> std::string {
    write(path, {grid.deepCopyGrid()});
    try {
      readBand(path);
    } catch (const Error& e) {
      EXPECT_TRUE(e.code() == ErrorCode::Unsupported || e.code() == ErrorCode::Input);
      return e.what();
    }
    return "";
  };
  const FloatGrid::Ptr grid = torusGrid(2.0F, 2.0F);
  FloatGrid turned(*grid), wide(*grid), fog(*grid), empty(*grid);
  turned.setTransform(grid->transform().copy());
  turned.transform().preRotate(0.1, openvdb::math::X_AXIS);
  EXPECT_NE(refusal(turned).find("turned"), std::string::npos);
  wide.setTree(grid->tree().copy());
  wide.tree().setValueOn(Coord(1 << 25, 0, 0), 0.0F);
  EXPECT_NE(refusal(wide).find("16777216"), std::string::npos);
  fog.setGridClass(openvdb::GRID_FOG_VOLUME);
  EXPECT_NE(refusal(fog).find("no level set"), std::string::npos);
  empty.setTree(openvdb::FloatTree::Ptr(new openvdb::FloatTree(1.0F)));
  EXPECT_NE(refusal(empty).find("no active voxel"), std::string::npos);
  const FloatGrid::Ptr flat = FloatGrid::create(0.0F);
  flat->setGridClass(openvdb::GRID_LEVEL_SET);
  flat->tree().setValueOn(Coord(0, 0, 0), 1.0F);
  EXPECT_NE(refusal(*flat).find("background"), std::string::npos);
  // A tile of 4096 samples along a side has more leaves than its bytes can hold.
  const FloatGrid::Ptr dense = FloatGrid::create(1.0F);
  dense->setGridClass(openvdb::GRID_LEVEL_SET);
  dense->tree().addTile(3, Coord(0, 0, 0), 0.5F, true);
  EXPECT_NE(refusal(*dense).find("more"), std::string::npos);
}

}  // namespace
}  // namespace raymap
