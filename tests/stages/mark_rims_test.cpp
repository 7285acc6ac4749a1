#include "cpu/points/mark_rims.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "broken_meshes.h"
#include "shapes.h"
#include "sign_scene.h"

namespace raymap::cpu {
namespace {

Grid gridOf(const Mesh& mesh) {
  return fitGrid(mesh, {.resolution = 30});
}

std::vector<RimEdge> rimsOf(const Mesh& mesh) {
  return findRimEdges(mesh, gridOf(mesh).spacing);
}

TEST(MarkRims, AreMarkedWithinACell) {
  for (const Mesh& mesh :
       {withHoles(shapes::sphere(1.0, 3), 3, 0.08, 1), shapes::soup(20, 1),
        makeMesh(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.3}}, {{0, 1, 2}})}) {
    const CellMesh cells = cellMesh(mesh, gridOf(mesh));
    const Buffer<uint8_t> marks = markRims(mesh, rimsOf(mesh), gridOf(mesh));
    const glm::ivec3 d = cells.dims;
    ASSERT_EQ(marks.size(), size_t(d.x) * d.y * d.z);
    // All directed edges without their opposite, which these meshes have once at most.
    std::vector<std::pair<glm::vec3, glm::vec3>> edges, rims;
    for (size_t t = 0; t < cells.triangles.size(); ++t)
      for (int c = 0; c < 3; ++c) edges.emplace_back(cells.corner(t, c), cells.corner(t, (c + 1) % 3));
    for (const auto& [a, b] : edges)
      if (std::ranges::find(edges, std::pair(b, a)) == edges.end()) rims.emplace_back(a, b);
    ASSERT_FALSE(rims.empty());
    size_t marked = 0;
    for (int z = 0; z < d.z; ++z)
      for (int y = 0; y < d.y; ++y)
        for (int x = 0; x < d.x; ++x) {
          const glm::dvec3 low(x, y, z);
          double distance =
              INFINITY;  // from the cube between the sample and the next ones, at points of the rims
          for (const auto& [a, b] : rims)
            for (int s = 0; s <= 40; ++s) {
              const glm::dvec3 p = glm::dvec3(a) + (s / 40.0) * glm::dvec3(b - a);
              distance = std::min(distance, glm::distance(p, glm::clamp(p, low, low + 1.0)));
            }
          const bool isMarked = marks[(size_t(z) * d.y + y) * d.x + x] != 0;
          marked += isMarked;
          if (distance < 0.5) {
            ASSERT_TRUE(isMarked) << x << ' ' << y << ' ' << z;
          }
          if (distance > 2.0) {
            ASSERT_FALSE(isMarked) << x << ' ' << y << ' ' << z;
          }
        }
    EXPECT_GT(marked, 10u);
  }
}

TEST(MarkRims, AreFacesThatPointTheOtherWay) {
  Mesh mesh = shapes::sphere(1.0, 2);
  std::swap(mesh.triangles[7].x, mesh.triangles[7].y);
  EXPECT_EQ(rimsOf(mesh).size(), 3u);
}

}  // namespace
}  // namespace raymap::cpu
