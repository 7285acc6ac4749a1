#include "vulkan/stages/surface_tree.h"

#include <cstring>

#include "shapes.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

/// A tree that was read back.
struct Tree {
  std::vector<glm::vec4> frames, discs;
  uint32_t firstLeaf, leafCount;

  uint32_t triangleId(size_t place) const {
    uint32_t id;
    std::memcpy(&id, &frames[place * kFrameVectors + 3].z, sizeof id);
    return id;
  }
  /// Returns how far a point lies outside the disc of a node.
  double distance(uint32_t node, const glm::dvec3& p) const {
    const glm::vec4 first = discs[node * kDiscVectors], second = discs[node * kDiscVectors + 1];
    const glm::dvec3 q = p - glm::dvec3(first), normal(second);
    const double height = glm::dot(q, normal);
    const double beside = glm::length(q - height * normal) - double(first.w);
    return std::max({beside, std::abs(height) - double(second.w), 0.0});
  }
};

class VulkanSurfaceTree : public VulkanTest {
 protected:
  static Tree build(const Mesh& mesh) {
    const DeviceBuffer vertices = upload(mesh.vertices, "vertices"),
                       triangles = upload(mesh.triangles, "triangles");
    SurfaceTreeStage tree(device());
    tree.reserve(static_cast<uint32_t>(mesh.triangles.size()) + 1000);
    run([&](Commands& commands) {
      tree.record(commands,
                  {vertices.address(), triangles.address(), static_cast<uint32_t>(mesh.vertices.size()),
                   static_cast<uint32_t>(mesh.triangles.size())},
                  {20, 20, 20});
    });
    return {download<glm::vec4>(tree.frames()), download<glm::vec4>(tree.discs()), tree.firstLeaf(),
            tree.leafCount()};
  }

  static void expectSound(const Mesh& mesh) {
    const Tree tree = build(mesh);
    const size_t count = mesh.triangles.size();
    ASSERT_EQ(tree.leafCount, (count + kArity - 1) / kArity);
    std::vector<int> seen(count);
    for (size_t place = 0; place < size_t{tree.leafCount} * kArity; ++place) {
      const uint32_t id = tree.triangleId(place);
      ASSERT_LT(id, count);
      if (place < count)
        ++seen[id];
      else
        ASSERT_EQ(id, tree.triangleId(count - 1));
      for (int corner = 0; corner < 3; ++corner)
        for (auto node = tree.firstLeaf + static_cast<uint32_t>(place / kArity);;
             node = (node - 1) / kArity) {
          ASSERT_LT(tree.distance(node, glm::dvec3(mesh.vertices[mesh.triangles[id][corner]])), 1e-6)
              << "triangle " << id << ", node " << node;
          if (node == 0) break;
        }
    }
    EXPECT_EQ(seen, std::vector<int>(count, 1));
    for (uint32_t leaf = tree.leafCount; leaf % kArity != 0 && tree.firstLeaf > 0; ++leaf)
      EXPECT_LT(tree.discs[(tree.firstLeaf + leaf) * kDiscVectors].w, 0.0f);
  }
};

TEST_F(VulkanSurfaceTree, HoldsEveryTriangleOnceInDiscsThatHoldTheirChildren) {
  for (const int count : {1, 7, 8, 9, 64, 65, 511, 513, 4097, 5000})
    expectSound(shapes::soup(count, static_cast<unsigned>(count)));
  expectSound(shapes::sphere(1.0, 4));
  expectSound(shapes::torus(1.0, 0.3, 80, 40));
  const std::vector<glm::dvec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  expectSound(makeMesh(line, {{0, 1, 2}, {0, 0, 0}, {1, 2, 1}, {2, 2, 2}, {0, 1, 2}}));
}

TEST_F(VulkanSurfaceTree, RefusesMoreTrianglesThanReserved) {
  SurfaceTreeStage tree(device());
  tree.reserve(10);
  CommandBuffer own(device());
  Commands commands = own.begin();
  EXPECT_THROW(tree.record(commands, {.triangleCount = 11}, {1, 1, 1}), std::logic_error);
  EXPECT_THROW(tree.record(commands, {}, {1, 1, 1}), std::logic_error);
  EXPECT_THROW(tree.reserve(0), std::logic_error);
}

}  // namespace
}  // namespace raymap::vulkan
