// The sign of every mesh of the folder whose winding number is a whole number everywhere.

#include <gtest/gtest.h>
#include <raymap/io.h>

#include <random>

#include "mesh_folder.h"
#include "sign_scene.h"

namespace raymap {
namespace {

/// Returns the names of the well-formed meshes that are listed as balanced.
std::vector<std::string> balancedMeshes() {
  std::vector<std::string> names;
  for (MeshRow& row : meshRows())
    if (row["balanced"] == "yes" && row["kind"] != "malformed") names.push_back(row["file"]);
  return names;
}

/// Counts wrong signs at random samples, fewer on larger meshes.
size_t countWrongSigns(const Mesh& mesh, const Grid& grid, const std::vector<Buffer<float>>& windings) {
  constexpr size_t kTriangleTests = 3'000'000;
  const size_t samples = std::clamp<size_t>(kTriangleTests / mesh.triangles.size(), 4, 300);
  std::mt19937 random(17);
  size_t wrong = 0;
  for (size_t n = 0; n < samples; ++n) {
    const glm::ivec3 s(int(random() % uint32_t(grid.dims.x)), int(random() % uint32_t(grid.dims.y)),
                       int(random() % uint32_t(grid.dims.z)));
    const glm::dvec3 p = grid.position(glm::dvec3(s));
    const bool inside = std::abs(reference::windingNumber(mesh, p)) > 0.5;
    for (const Buffer<float>& winding : windings)
      if (inside != (std::abs(winding[grid.index(s)]) > 0.5f) &&
          reference::distance(mesh, p) > 1e-6 * diagonal(mesh))
        ++wrong;
  }
  return wrong;
}

TEST(Sign, NoBalancedMeshHasAWrongSign) {
  RAYMAP_NEED_MESHES();
  size_t tried = 0;
  for (const std::string& name : balancedMeshes()) {
    SCOPED_TRACE(name);
    const Mesh mesh = readMesh(meshFolder() / name);
    const Grid grid = fitGrid(mesh, {.resolution = 64});
    std::vector<Buffer<float>> windings;
    for (const SignMode mode : {SignMode::Rays, SignMode::Paths, SignMode::Evolution, SignMode::Harmonic}) {
      WindingResult result = windingOf(mesh, grid, mode);
      EXPECT_EQ(result.doubtfulShare, 0.0);
      windings.push_back(std::move(result.winding));
    }
    EXPECT_EQ(countWrongSigns(mesh, grid, windings), 0u);
    ++tried;
  }
  EXPECT_GT(tried, 0u);
}

}  // namespace
}  // namespace raymap
