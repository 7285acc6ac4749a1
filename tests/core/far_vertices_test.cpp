#include "mesh/far_vertices.h"

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/mesh_view.h>

#include "shapes.h"

namespace raymap {
namespace {

/// Returns what is found in a sphere of radius 1 with a vertex moved.
FarVertices found(const glm::vec3& place, uint32_t moved = 5) {
  Mesh mesh = shapes::sphere(1.0, 2);
  mesh.vertices[moved] = place;
  return findFarVertices(bounds(MeshView(mesh.vertices, mesh.triangles)), mesh.vertices, mesh.triangles);
}

TEST(FarVertices, NamesTheOneThatAWrongBitMoved) {
  const FarVertices far = found({0, 0, 1e30F});
  EXPECT_EQ(far.count, 1u);
  EXPECT_EQ(far.vertex, 5u);
  EXPECT_NEAR(far.size, 2.0, 0.1);
  EXPECT_NEAR(far.distance, 1e30, 1e24);
  EXPECT_LT(far.others.max.z, 1.01);
  const Mesh mesh = shapes::sphere(1.0, 2);
  for (size_t t = 0; t < far.face; ++t)
    for (int c = 0; c < 3; ++c) ASSERT_NE(mesh.triangles[t][c], 5u);
}

TEST(FarVertices, LieABillionSizesAway) {
  const double size = found({0, 0, 1e30F}).size;
  EXPECT_EQ(found({-float(1.001e9 * size), 0, 0}).count, 1u);
  const FarVertices none = found({0, float(0.999e9 * size), 0});
  EXPECT_EQ(none.count, 0u);
  EXPECT_GT(none.others.max.y, 1e9) << "then all are counted";
}

TEST(FarVertices, AreCountedByPosition) {
  Mesh mesh = shapes::sphere(1.0, 2);
  mesh.vertices[3] = mesh.vertices[4] = {2e20F, 0, 0};
  mesh.vertices[9] = {0, -3e20F, 0};
  const FarVertices far = findFarVertices(bounds(mesh), mesh.vertices, mesh.triangles);
  EXPECT_EQ(far.count, 2u);
  EXPECT_EQ(far.vertex, 9u);
  EXPECT_EQ(diagnose(mesh).farVertices, 2u);
}

TEST(FarVertices, AreFoundInMeshesOfFewFaces) {
  std::vector<glm::dvec3> cube;
  for (int v = 0; v < 8; ++v) cube.emplace_back(v & 1, v >> 1 & 1, v >> 2);
  cube[7].z = 1e19;
  const std::vector<glm::uvec3> faces{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const FarVertices far = findFarVertices({{0, 0, 0}, {1, 1, 1e19}}, cube, faces);
  EXPECT_EQ(far.count, 1u);
  EXPECT_EQ(far.vertex, 7u);
  EXPECT_EQ(far.size, 1.0);
  EXPECT_EQ(far.others.max, glm::dvec3(1.0));
}

TEST(FarVertices, AreNoneOfAPointALineOrNothing) {
  const std::vector<glm::vec3> point(3, glm::vec3(1)), line{{0, 0, 0}, {1e20F, 0, 0}, {1, 0, 0}};
  const std::vector<glm::uvec3> face{{0, 1, 2}};
  EXPECT_EQ(findFarVertices({glm::dvec3(1), glm::dvec3(1)}, point, face).count, 0u);
  EXPECT_EQ(findFarVertices({{0, 0, 0}, {1e20, 0, 0}}, line, face).count, 0u);
  EXPECT_EQ(findFarVertices(Box{}, point, {}).count, 0u);
  EXPECT_EQ(diagnose(shapes::torus(2.0, 0.7, 20, 10)).farVertices, 0u);
}

}  // namespace
}  // namespace raymap
