#include "vulkan/stages/face_search.h"

#include "broken_meshes.h"
#include "mesh/rim_edges.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

class VulkanFaceSearch : public VulkanTest {
 protected:
  static void search(FaceSearchStage& stage, const Mesh& mesh) { searchFaces(kept<Probe>(), stage, mesh); }

  static void expectTheSame(FaceSearchStage& stage, const Mesh& mesh) {
    compareFaceSearch(kept<Probe>(), stage, mesh);
  }

  static Mesh cap() { return withoutCap(shapes::sphere(1.0, 4), 0.8); }
};

TEST_F(VulkanFaceSearch, LetsTheHostFindTheSame) {
  FaceSearchStage stage(device());
  Mesh doubled = cap();
  const size_t faces = doubled.triangles.size();
  for (size_t f = 0; f < faces; f += 3) {
    const glm::uvec3 t = doubled.triangles[f];
    doubled.triangles.emplace_back(t.y, t.x, t.z);
  }
  Mesh thrice = doubled;
  thrice.triangles.insert(thrice.triangles.end(), faces / 4, doubled.triangles[0]);
  Mesh apart;  // Faces with corners of their own, where zero has either sign.
  const Mesh whole = cap();
  for (const glm::uvec3& t : whole.triangles) {
    const auto first = static_cast<uint32_t>(apart.vertices.size());
    for (int c = 0; c < 3; ++c) apart.vertices.push_back(whole.vertices[t[c]]);
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  for (size_t v = 0; v < apart.vertices.size(); v += 2)
    for (int axis = 0; axis < 3; ++axis)
      if (apart.vertices[v][axis] == 0.0f) apart.vertices[v][axis] = -0.0f;
  for (const Mesh& mesh :
       {shapes::sphere(1.0, 5), cap(), doubled, thrice, apart, shapes::soup(40, 3), shapes::soup(1, 3)})
    expectTheSame(stage, mesh);
}

TEST_F(VulkanFaceSearch, ListsHardlyMoreThanThereIs) {
  FaceSearchStage stage(device());
  search(stage, shapes::sphere(1.0, 5));
  EXPECT_TRUE(stage.edges()->empty());
  EXPECT_LT(stage.faces()->size(), 4u);
  const size_t rims = findRimEdges(cap(), 0.1).size();
  search(stage, cap());
  EXPECT_GE(stage.edges()->size(), rims);
  EXPECT_LE(stage.edges()->size(), 8 * rims);
}

TEST_F(VulkanFaceSearch, SkipsEdgesAndFacesOfNoSize) {
  FaceSearchStage stage(device());
  Mesh mesh = shapes::sphere(1.0, 3);
  mesh.triangles.emplace_back(0, 0, 1);  // An edge of no length, and one back and forth.
  mesh.triangles.emplace_back(2, 2, 2);
  expectTheSame(stage, mesh);
  EXPECT_TRUE(stage.edges()->empty());
}

TEST_F(VulkanFaceSearch, LeavesTooManyToTheHost) {
  FaceSearchStage stage(device());
  constexpr uint32_t kMost = FaceSearchStage::kMostListed / 3;
  const Mesh most = shapes::soup(kMost, 3), more = shapes::soup(kMost + 1, 3);
  expectTheSame(stage, most);
  EXPECT_EQ(stage.edges()->size(), 3 * kMost);
  search(stage, more);
  EXPECT_FALSE(stage.edges());
  EXPECT_TRUE(stage.faces());
  search(stage, most);
  EXPECT_TRUE(stage.edges()) << "counts begin at zero again";
}

}  // namespace
}  // namespace raymap::vulkan
