#include "cpu/points/near_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap::cpu {
namespace {

TEST(NearSurface, IsWhereTheDistanceIsSmaller) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (const Mesh& mesh : {shapes::soup(300, 1), shapes::sphere(1.0, 3), shapes::soup(3, 1)}) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    const CellMesh cells = cellMesh(mesh, grid);
    SurfaceTree tree;
    tree.build(cells);
    for (int i = 0; i < 300; ++i) {
      const glm::vec3 p =
          (3.0f * glm::vec3(unit(random), unit(random), unit(random)) - 1.0f) * glm::vec3(grid.dims);
      const auto distance = static_cast<float>(reference::distance(mesh, grid.position(p)) / grid.spacing);
      EXPECT_TRUE(isNearSurface(tree, p, distance * 1.0001f + 1e-3f)) << i;
      EXPECT_TRUE(isNearSurface(tree, p, distance * 3.0f + 1e-3f)) << i;
      EXPECT_TRUE(isNearSurface(tree, p, 1e6f)) << i;
      EXPECT_FALSE(isNearSurface(tree, p, distance * 0.9999f - 1e-3f)) << i;
      EXPECT_FALSE(isNearSurface(tree, p, distance * 0.5f)) << i;
    }
  }
}

TEST(NearSurface, HoldsAtExactlyTheRadius) {
  const Mesh mesh = makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{0, 1, 2}});
  const Grid grid{glm::ivec3(9), glm::dvec3(0.0), 1.0};
  const CellMesh cells = cellMesh(mesh, grid);
  SurfaceTree tree;
  tree.build(cells);
  EXPECT_TRUE(isNearSurface(tree, {2, 2, 3}, 3.0f));
  EXPECT_FALSE(isNearSurface(tree, {2, 2, 3}, 2.9999f));
}

}  // namespace
}  // namespace raymap::cpu
