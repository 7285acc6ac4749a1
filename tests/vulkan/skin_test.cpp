#include "vulkan/stages/skin.h"

#include <raymap/io.h>

#include <cmath>

#include "mesh_folder.h"
#include "shapes.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanSkin : public VulkanTest {};

TEST_F(VulkanSkin, MovesVerticesAsTheCpuDoes) {
  for (const uint16_t joints : {1, 2, 33})
    compareSkin(kept<Probe>(), wanderers(shapes::soup(1000, 3), joints), 0.0);
  compareSkin(kept<Probe>(), wanderers(shapes::soup(1, 3), 5), 0.0);
}

TEST_F(VulkanSkin, MovesAllByOneMatrixWithoutJoints) {
  AnimatedMesh mesh = wanderers(shapes::sphere(1.0, 3), 3);
  mesh.joints.assign(mesh.joints.size(), glm::u16vec4(0));
  mesh.weights.assign(mesh.weights.size(), glm::vec4(1, 0, 0, 0));
  const std::vector<JointMatrix> matrices = jointMatrices(mesh, 0.0);
  EXPECT_EQ(movedVertices(kept<Probe>(), mesh, matrices, false),
            movedVertices(kept<Probe>(), mesh, matrices));
}

TEST_F(VulkanSkin, MarksVerticesWhoseJointDoesNotExist) {
  AnimatedMesh mesh = wanderers(shapes::sphere(1.0, 2), 4);
  mesh.joints[5] = {0, 1, 2, 4};
  mesh.joints[6] = {65535, 1, 2, 3};
  mesh.joints[7] = {0, 65535, 0, 0};
  mesh.weights[7] = {1, 0, 0, 0};
  const std::vector<glm::vec3> moved = movedVertices(kept<Probe>(), mesh, jointMatrices(mesh, 0.0));
  for (size_t v = 0; v < moved.size(); ++v)
    EXPECT_EQ(std::isnan(moved[v].x) && std::isnan(moved[v].y) && std::isnan(moved[v].z), v == 5 || v == 6)
        << v;
}

TEST_F(VulkanSkin, RealMeshes) {
  RAYMAP_NEED_MESHES();
  for (const char* name :
       {"draco__CesiumMan.glb", "trimesh__CesiumMilkTruck.glb", "tinygltf__unassigned-skeleton.gltf"}) {
    const AnimatedMesh mesh = readAnimatedMesh(meshFolder() / name);
    for (const double share : {0.0, 0.3, 1.0})
      inCase(name, [&] { compareSkin(kept<Probe>(), mesh, share * mesh.seconds()); });
  }
}

}  // namespace
}  // namespace raymap::vulkan
