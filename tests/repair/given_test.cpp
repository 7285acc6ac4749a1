// What the stages of a repair share.

#include <gtest/gtest.h>
#include <raymap/generate.h>
#include <raymap/isosurface.h>
#include <raymap/repair.h>

#include <algorithm>

#include "broken_meshes.h"
#include "shapes.h"

namespace raymap {
namespace {

Mesh isosurfaceOf(const Mesh& mesh, const Grid& grid, double offset) {
  Field field = generate(mesh, grid, {.closeHoles = true}, {.device = "cpu"}).field;
  for (float& d : field.distance) d = static_cast<float>(double(d) - offset);
  return isosurface(field);
}

TEST(Given, KnowsTheFieldAsFarAsTheIsosurfaceReads) {
  for (const Mesh& mesh : {shapes::torus(2.0, 0.7, 40, 24), withHoles(shapes::sphere(1.0, 3), 3, 0.3, 1)})
    for (const double samples : {-3.0, 0.0, 9.0}) {
      const Grid coarse = fitGrid(mesh, {.resolution = 40});
      const RepairOptions changes{.offset = samples * coarse.spacing,
                                  .minThickness = 0.0,
                                  .dropSmaller = 0.0,
                                  .keepCavities = true,
                                  .remesh = true,
                                  .tolerance = 0.0,
                                  .measure = false};
      const Grid grid = fitRepairGrid(mesh, {.voxelSize = coarse.spacing}, changes);
      const Mesh expected = isosurfaceOf(mesh, grid, changes.offset);
      const Mesh made = repair(mesh, grid, {}, changes, {.device = "cpu"}).mesh;
      ASSERT_FALSE(expected.triangles.empty());
      // What closes holes is found in a band, with other roundings.
      ASSERT_EQ(made.vertices.size(), expected.vertices.size()) << samples;
      double farthest = 0.0;
      for (uint32_t v = 0; v < made.vertices.size(); ++v)
        farthest = std::max(farthest, glm::distance(made.position(v), expected.position(v)));
      EXPECT_LE(farthest, 1e-4 * grid.spacing) << samples;
      EXPECT_EQ(made.triangles, expected.triangles) << samples;
    }
}

}  // namespace
}  // namespace raymap
