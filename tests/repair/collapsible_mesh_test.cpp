#include "simplify/collapsible_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "shapes.h"

namespace raymap {
namespace {

/// Expects the faces of a given mesh, and rings around its vertices that belong to it.
void expectGiven(const CollapsibleMesh& mesh, const Mesh& given) {
  ASSERT_EQ(mesh.faceCount(), given.triangles.size());
  for (uint32_t f = 0; f < mesh.faceCount(); ++f) {
    EXPECT_TRUE(mesh.hasFace(f));
    ASSERT_EQ(mesh.face(f), given.triangles[f]) << f;
  }
  for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
    CollapsibleMesh::Ring ring;
    ASSERT_TRUE(mesh.hasVertex(v) && mesh.findRing(v, ring)) << v;
    size_t around = 0;
    for (const glm::uvec3& t : given.triangles) around += t.x == v || t.y == v || t.z == v ? 1 : 0;
    EXPECT_EQ(ring.count, around) << v;
    for (const uint32_t h : ring.edges()) {
      EXPECT_EQ(mesh.from(h), v);
      EXPECT_EQ(mesh.twin(mesh.twin(h)), h);
      EXPECT_EQ(mesh.from(mesh.twin(h)), mesh.to(h));
    }
  }
  for (uint32_t f = 0; f < mesh.faceCount(); ++f) EXPECT_EQ(mesh.lastCollapse(f), UINT32_MAX);
}

TEST(CollapsibleMesh, IsTheGivenOneAfterItsCollapsesAreUndone) {
  const Mesh given = shapes::sphere(1.0, 2);
  for (unsigned seed = 0; seed < 20; ++seed) {
    CollapsibleMesh mesh(given);
    const uint32_t record = mesh.addRecords(1);
    std::mt19937 random(seed);
    std::vector<uint32_t> removed;
    for (int tries = 0; tries < 300; ++tries) {
      const uint32_t v = random() % mesh.vertexCount();
      CollapsibleMesh::Ring ring, other;
      if (!mesh.hasVertex(v) || !mesh.findRing(v, ring)) continue;
      const uint32_t k = random() % ring.count, end = mesh.to(ring.all[k]);
      if (!mesh.findRing(end, other) || !mesh.canCollapse(ring, other)) continue;
      mesh.collapse(ring, k, record);
      EXPECT_FALSE(mesh.hasVertex(v));
      removed.push_back(v);
    }
    EXPECT_GT(removed.size(), 50u);
    // Undoes one in the middle first, and with it the later ones around it.
    std::shuffle(removed.begin(), removed.end(), random);
    for (const uint32_t v : removed)
      if (!mesh.hasVertex(v)) mesh.undo(v, [&](uint32_t restored) { EXPECT_TRUE(mesh.hasVertex(restored)); });
    expectGiven(mesh, given);
  }
}

}  // namespace
}  // namespace raymap
