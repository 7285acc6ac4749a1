#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "mesh_folder.h"
#include "steepest.h"

namespace raymap {
namespace {

TEST(CloseHoles, MakesDistanceFieldsOfRealMeshes) {
  const std::vector<MeshRow> rows = meshRows();
  RAYMAP_NEED_MESHES();
  size_t holed = 0, closed = 0;
  for (const MeshRow& row : rows) {
    if (row.at("kind") == "malformed" || row.at("boundary_edges") == "0") continue;
    SCOPED_TRACE(row.at("file"));
    const Mesh mesh = readMesh(meshFolder() / row.at("file"));
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    if (steepest(generate(mesh, grid, {}, {.device = "cpu"}).field) < 1.01) continue;
    const double after = steepest(generate(mesh, grid, {.closeHoles = true}, {.device = "cpu"}).field);
    EXPECT_LT(after, 2.0);
    ++holed;
    closed += after < 1.01 ? 1 : 0;
  }
  EXPECT_GT(holed, 15u);
  EXPECT_GT(closed, holed * 6 / 10);
}

}  // namespace
}  // namespace raymap
