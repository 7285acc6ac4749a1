#include "mesh/rim_edges.h"

#include <gtest/gtest.h>
#include <raymap/grid.h>

#include <map>
#include <utility>
#include <vector>

#include "shapes.h"

namespace raymap {
namespace {

std::vector<RimEdge> rimsOf(const Mesh& mesh) {
  return findRimEdges(mesh, fitGrid(mesh, {.resolution = 30}).spacing);
}

TEST(RimEdges, AreNotThereOnClosedMeshes) {
  Mesh split = shapes::sphere(1.0, 2);  // Faces with corners of their own still share edges.
  Mesh apart;
  for (const glm::uvec3& t : split.triangles) {
    const auto first = static_cast<uint32_t>(apart.vertices.size());
    for (int c = 0; c < 3; ++c) apart.vertices.push_back(split.vertices[t[c]]);
    apart.triangles.emplace_back(first, first + 1, first + 2);
  }
  const Mesh touching = shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1}));
  Mesh folded = split;  // An edge of no length has no direction.
  folded.triangles.emplace_back(0, 0, 1);
  for (const Mesh& mesh : {split, apart, touching, folded, shapes::torus(1.0, 0.3, 30, 15),
                           shapes::joined(split, shapes::sphere(1.0, 2))})
    EXPECT_TRUE(rimsOf(mesh).empty());
}

TEST(RimEdges, TakeZeroOfAnySign) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.origin = {};
  for (glm::vec3& v : mesh.vertices) v = glm::vec3(v.x > 0.0f, v.y > 0.0f, v.z > 0.0f);
  const uint32_t corner = mesh.triangles[0].x;
  mesh.triangles[0].x =
      static_cast<uint32_t>(mesh.vertices.size());  // One face names a corner by another vertex.
  glm::vec3 other = mesh.vertices[corner];
  for (int axis = 0; axis < 3; ++axis)
    if (other[axis] == 0.0f) other[axis] = -0.0f;
  mesh.vertices.push_back(other);
  EXPECT_TRUE(rimsOf(mesh).empty());
}

TEST(RimEdges, TellDirectionAndCount) {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}};
  // Three faces run along the edge from 0 to 1, one runs back.
  const Mesh mesh = makeMesh(corners, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {1, 0, 4}});
  const std::vector<RimEdge> rims = rimsOf(mesh);
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> times;
  for (const RimEdge& rim : rims) times[{rim.from, rim.to}] = rim.times;
  const std::map<std::pair<uint32_t, uint32_t>, uint32_t> expected{
      {{0, 1}, 2}, {{1, 2}, 1}, {{2, 0}, 1}, {{1, 3}, 1}, {{3, 0}, 1}};
  EXPECT_EQ(times, expected);
}

/// The sums of a face's corners must not cancel where they share one.
TEST(RimEdges, AreFoundOfFacesWithinACell) {
  Mesh mesh = shapes::soup(5000, 1);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c) {
      glm::vec3& vertex = mesh.vertices[mesh.triangles[f][c]];
      vertex = 0.1f * vertex + glm::vec3(3.0f * float(f), 0.0f, 0.0f);
    }
  EXPECT_EQ(findRimEdges(mesh, 1.0).size(), 3 * mesh.triangles.size());
}

}  // namespace
}  // namespace raymap
