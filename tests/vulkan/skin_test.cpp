#include "vulkan/stages/skin.h"

#include <raymap/animation.h>
#include <raymap/io.h>

#include <cmath>
#include <random>

#include "mesh_folder.h"
#include "shapes.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

/// Returns a mesh whose vertices follow up to four of `joints` joints each, with random rotations, scales and
/// positions.
AnimatedMesh wanderers(Mesh rest, uint16_t joints) {
  std::mt19937 random(7);
  const auto real = [&](double low, double high) {
    return low + (high - low) * double(random()) / double(std::mt19937::max());
  };
  AnimatedMesh mesh{.rest = std::move(rest)};
  for (uint16_t j = 0; j < joints; ++j) {
    mesh.nodes.push_back({.parent = int(j) - 1,
                          .translation = {real(-1, 1), real(-1, 1), real(-1, 1)},
                          .rotation = {real(-1, 1), real(-1, 1), real(-1, 1), 1.0},
                          .scale = glm::dvec3(real(0.9, 1.1))});
    mesh.skeleton.push_back({.node = j});
  }
  for (size_t v = 0; v < mesh.rest.vertices.size(); ++v) {
    glm::vec4 weights(real(0, 1), v % 2 ? real(0, 1) : 0.0, v % 3 ? real(0, 1) : 0.0, 0.1);
    mesh.weights.push_back(weights / (weights.x + weights.y + weights.z + weights.w));
    mesh.joints.emplace_back(random() % joints, random() % joints, random() % joints, random() % joints);
  }
  mesh.origin = {1.0, -2.0, 3.0};
  return mesh;
}

class VulkanSkin : public VulkanTest {
 protected:
  static std::vector<glm::vec3> onDevice(const AnimatedMesh& mesh, const std::vector<JointMatrix>& matrices,
                                         bool hasJoints = true) {
    const DeviceBuffer rest = upload(mesh.rest.vertices, "rest"), palette = upload(matrices, "matrices");
    const DeviceBuffer joints = upload(mesh.joints, "joints"), weights = upload(mesh.weights, "weights");
    DeviceBuffer moved(device(), "moved");
    moved.resize<glm::vec3>(mesh.rest.vertices.size());
    SkinStage skin(device());
    run([&](Commands& commands) {
      skin.record(commands,
                  {.rest = rest.address(),
                   .joints = hasJoints ? joints.address() : 0,
                   .weights = hasJoints ? weights.address() : 0,
                   .matrices = palette.address(),
                   .vertexCount = uint32_t(mesh.rest.vertices.size()),
                   .jointCount = uint32_t(matrices.size())},
                  moved.address());
    });
    return download<glm::vec3>(moved);
  }

  static void expectAsOnTheCpu(const AnimatedMesh& mesh, double seconds) {
    const Mesh theirs = posed(mesh, seconds);
    const std::vector<glm::vec3> ours = onDevice(mesh, jointMatrices(mesh, seconds));
    ASSERT_EQ(ours.size(), theirs.vertices.size());
    EXPECT_EQ(ours, onDevice(mesh, jointMatrices(mesh, seconds)));
    const double size = glm::length(bounds(theirs).size());
    for (size_t v = 0; v < ours.size(); ++v)
      ASSERT_LE(glm::distance(ours[v], theirs.vertices[v]), 1e-6 * size) << "vertex " << v;
  }
};

TEST_F(VulkanSkin, MovesVerticesAsTheCpuDoes) {
  for (const uint16_t joints : {1, 2, 33}) expectAsOnTheCpu(wanderers(shapes::soup(1000, 3), joints), 0.0);
  expectAsOnTheCpu(wanderers(shapes::soup(1, 3), 5), 0.0);
}

TEST_F(VulkanSkin, MovesAllByOneMatrixWithoutJoints) {
  AnimatedMesh mesh = wanderers(shapes::sphere(1.0, 3), 3);
  mesh.joints.assign(mesh.joints.size(), glm::u16vec4(0));
  mesh.weights.assign(mesh.weights.size(), glm::vec4(1, 0, 0, 0));
  const std::vector<JointMatrix> matrices = jointMatrices(mesh, 0.0);
  EXPECT_EQ(onDevice(mesh, matrices, false), onDevice(mesh, matrices));
}

TEST_F(VulkanSkin, MarksVerticesWhoseJointDoesNotExist) {
  AnimatedMesh mesh = wanderers(shapes::sphere(1.0, 2), 4);
  mesh.joints[5] = {0, 1, 2, 4};
  mesh.joints[6] = {65535, 1, 2, 3};
  mesh.joints[7] = {0, 65535, 0, 0};
  mesh.weights[7] = {1, 0, 0, 0};
  const std::vector<glm::vec3> moved = onDevice(mesh, jointMatrices(mesh, 0.0));
  for (size_t v = 0; v < moved.size(); ++v)
    EXPECT_EQ(std::isnan(moved[v].x) && std::isnan(moved[v].y) && std::isnan(moved[v].z), v == 5 || v == 6)
        << v;
}

TEST_F(VulkanSkin, RealMeshes) {
  RAYMAP_NEED_MESHES();
  for (const char* name :
       {"draco__CesiumMan.glb", "trimesh__CesiumMilkTruck.glb", "tinygltf__unassigned-skeleton.gltf"}) {
    SCOPED_TRACE(name);
    const AnimatedMesh mesh = readAnimatedMesh(meshFolder() / name);
    for (const double share : {0.0, 0.3, 1.0}) expectAsOnTheCpu(mesh, share * mesh.seconds());
  }
}

}  // namespace
}  // namespace raymap::vulkan
