#include "vulkan/stages/winding_rims.h"

#include <cmath>

#include "broken_meshes.h"
#include "shapes.h"
#include "sign_scene.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanWindingRims : public VulkanTest {};

TEST_F(VulkanWindingRims, MatchTheCpu) {
  for (const Mesh& mesh : {withHoles(shapes::sphere(1.0, 3), 3, 0.08, 1),
                           shapes::joined(shapes::soup(30, 4), shapes::sphere(0.5, 3))})
    for (const int resolution : {24, 41}) {
      const Grid grid = fitGrid(mesh, {.resolution = resolution});
      RimLattices lattices = findRimLattices(mesh, grid);
      lattices.computed.clear();
      compareRims(kept<Probe>(), kept<WindingRimsStage>(), grid.dims, crossingsOf(mesh, grid), lattices);
    }
}

TEST_F(VulkanWindingRims, MatchTheCpuBetweenLattices) {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {1, 0.1, 0.2}, {0.2, 1, 0.1}, {0.9, 0.8, 0.5}};
  const Mesh mesh = makeMesh(corners, {{0, 1, 2}, {2, 1, 3}});
  for (const int resolution : {9, 30, 45}) {
    const Grid grid = fitGrid(mesh, {.resolution = resolution});
    const RimLattices lattices = findRimLattices(mesh, grid);
    ASSERT_TRUE(lattices.haveAll());
    compareRims(kept<Probe>(), kept<WindingRimsStage>(), grid.dims, crossingsOf(mesh, grid), lattices);
  }
}

}  // namespace
}  // namespace raymap::vulkan
