#include "vulkan/stages/surface_tree.h"

#include <cmath>
#include <map>
#include <random>

#include "cells.h"
#include "shaders/disc_bounds.h"
#include "shaders/disc_bounds_spv.h"
#include "shapes.h"
#include "vulkan/device/kernel.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

constexpr int32_t kRootErrors[] = {-3, 0, 3};  // Units in the last place; Vulkan allows 2.

class VulkanSurfaceTree : public VulkanTest {
 protected:
  static void expectSound(const Mesh& mesh) {
    static std::map<int32_t, SurfaceProbe> probes;
    for (const int32_t rootError : kRootErrors) {
      const ExactDistanceStage::Imitated imitated{.rootError = rootError};
      expectSound(
          checkTree(probes.try_emplace(rootError, device(), imitated).first->second, inCells(mesh), 0.0),
          mesh.triangles.size());
    }
  }

  static void expectSound(const TreeOnHost& tree, size_t triangles) {
    const auto [firstLeaf, leafCount] = tree.levels.front();
    ASSERT_EQ(leafCount, (triangles + kTreeArity - 1) / kTreeArity);
    for (size_t place = triangles; place < size_t{leafCount} * kTreeArity; ++place)
      ASSERT_EQ(tree.triangleId(place), tree.triangleId(triangles - 1));
    for (const auto& [start, nodes] : tree.levels)
      for (uint32_t node = std::max(start, 1u); node < start + nodes; ++node)
        ASSERT_TRUE(holdsDisc(tree, (node - 1) / kTreeArity, node)) << "node " << node;
    for (uint32_t leaf = leafCount; leaf % kTreeArity != 0 && firstLeaf > 0; ++leaf)
      EXPECT_LT(tree.discs[(firstLeaf + leaf) * kDiscVectors].w, 0.0f);
  }

  /// Returns whether the disc of a node contains the rims of a child's disc.
  static bool holdsDisc(const TreeOnHost& tree, uint32_t node, uint32_t child) {
    const glm::dvec4 first(tree.discs[child * kDiscVectors]), second(tree.discs[child * kDiscVectors + 1]);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(second)), up(tree.discs[node * kDiscVectors + 1]);
    const glm::dvec3 across = up - glm::dot(up, normal) * normal;  // Towards the rim's highest place.
    const glm::dvec3 x = glm::length(across) > 1e-9 ? glm::normalize(across) : glm::dvec3(0.0);
    for (const double side : {-1.0, 1.0})
      for (const double height : {-second.w, second.w})
        if (tree.distance(node, glm::dvec3(first) + side * first.w * x + height * normal) > 0.0) return false;
    return true;
  }
};

TEST_F(VulkanSurfaceTree, HoldsEveryTriangleOnceInDiscsThatHoldTheirChildren) {
  for (const int count : {1, 7, 8, 9, 64, 65, 511, 513, 4097, 5000, 8192, 8193})
    expectSound(shapes::soup(count, static_cast<unsigned>(count)));
  expectSound(shapes::sphere(1.0, 4));
  expectSound(shapes::torus(1.0, 0.3, 80, 40));
  const std::vector<glm::dvec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  expectSound(makeMesh(line, {{0, 1, 2}, {0, 0, 0}, {1, 2, 1}, {2, 2, 2}, {0, 1, 2}}));
}

/// Returns the mesh at the place and size that it has in a grid.
Mesh placed(Mesh mesh, float scale, const glm::vec3& centre) {
  for (glm::vec3& v : mesh.vertices) v = scale * v + centre;
  return mesh;
}

TEST_F(VulkanSurfaceTree, BoundsMeshesInLargeGrids) {
  expectSound(placed(shapes::sphere(1.0, 4), 90.0f, {100, 90, 110}));
  expectSound(placed(shapes::torus(1.0, 0.3, 80, 40), 300.0f, {5000, 700, -80}));
  expectSound(placed(shapes::soup(3000, 3), 200.0f, {0, 1e4, 30}));
  Mesh flat = shapes::torus(1.0, 0.3, 80, 40);  // Normals that differ little.
  for (glm::vec3& v : flat.vertices) v.z *= 1e-4f;
  expectSound(placed(flat, 200.0f, {130, 128, 127}));
}

TEST_F(VulkanSurfaceTree, BoundsTrianglesAlongTheirDiscsNormal) {
  // Triangles without area have a normal along z. Scaling by a power of two keeps them on a line.
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-2e-3f, 2e-3f);
  for (int n = 0; n < 20; ++n) {
    const glm::vec3 along(uniform(random), uniform(random), 1.0f);
    expectSound(Mesh{.vertices = {-64.0f * along, glm::vec3(0.0f), 64.0f * along}, .triangles = {{0, 1, 2}}});
  }
}

TEST_F(VulkanSurfaceTree, BoundsDistancesToDiscsFromBelow) {
  constexpr uint32_t kCount = 20000;
  constexpr double kShare = 2e-6;  // Discs are this much larger than what they bound.
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto vector = [&] { return glm::dvec3(normal(random), normal(random), normal(random)); };
  const auto size = [&](double least, double most) {
    return least * std::pow(most / least, uniform(random));
  };
  std::vector<glm::vec4> discs, points;
  for (uint32_t i = 0; i < kCount; ++i) {
    const double radius = size(1e-2, 100.0);
    discs.emplace_back(glm::vec3(100.0 * vector()), radius);
    discs.emplace_back(glm::vec3(glm::normalize(vector())), radius * size(1e-6, 1.0));
    points.emplace_back(glm::vec3(discs[2 * i]) + glm::vec3(radius * size(0.1, 1e4) * vector()), 0.0f);
  }
  const DeviceBuffer discBuffer = upload(discs), pointBuffer = upload(points),
                     planes = upload(std::vector<glm::vec4>(kCount)),
                     squares = upload(std::vector<float>(kCount));
  for (const int32_t rootError : kRootErrors) {
    Kernel<DiscBoundsPush> kernel(device(), shaders::kDiscBounds, 128, {0, static_cast<uint32_t>(rootError)});
    run([&](Commands& commands) {
      commands.dispatch(kernel,
                        DiscBoundsPush{.discs = discBuffer.address(),
                                       .points = pointBuffer.address(),
                                       .planes = planes.address(),
                                       .squared = squares.address(),
                                       .count = kCount},
                        kCount);
    });
    const auto plane = download<glm::vec4>(planes);
    const auto squared = download<float>(squares);
    for (uint32_t i = 0; i < kCount; ++i) {
      glm::dvec4 first(discs[2 * i]), second(discs[2 * i + 1]);
      const double slack = kShare * (first.w + second.w),
                   distance = TreeOnHost::distance(first, second, points[i]);
      first.w -= slack, second.w -= slack;
      const double bounded = TreeOnHost::distance(first, second, points[i]);
      ASSERT_LE(std::sqrt(double(squared[i])), bounded) << i << ", " << rootError;
      ASSERT_GE(std::sqrt(double(squared[i])), (1.0 - 1e-5) * distance - slack) << i;
      for (int n = 0; n < 8; ++n) {  // Samples of a block. The gradient is rounded: hence 1e-6 cells.
        const glm::dvec3 offset(n & 1 ? 1.5 : -1.5, n & 2 ? 1.5 : -1.5, n & 4 ? 1.5 : -1.5);
        ASSERT_LE(plane[i].w + glm::dot(glm::dvec3(plane[i]), offset),
                  TreeOnHost::distance(first, second, glm::dvec3(points[i]) + offset) + 1e-6)
            << i << ", " << rootError;
      }
    }
  }
}

/// Returns triangles with edges of about `size`, most of which are slivers, and some without area.
Mesh slivers(float size) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> number(0.0f, 1.0f);
  const auto point = [&] { return glm::vec3(number(random), number(random), number(random)); };
  Mesh mesh;
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 a = 20.0f * point(), edge = size * (point() - 0.5f);
    const float height = size * std::pow(10.0f, -9.0f * number(random));
    const glm::vec3 c = a + number(random) * edge + height * (point() - 0.5f);
    for (const glm::vec3& corner : {a, a + edge, i % 10 == 0 ? a : c}) mesh.vertices.push_back(corner);
    const auto first = static_cast<uint32_t>(3 * i);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return mesh;
}

TEST_F(VulkanSurfaceTree, GivesSliversSoundFrames) {
  for (const float size : {20.0f, 1.0f, 1e-3f}) {
    const Mesh mesh = slivers(size);
    const TreeOnHost tree = kept<SurfaceProbe>().tree(inCells(mesh));
    for (size_t place = 0; place < mesh.triangles.size(); ++place) {
      const glm::vec4* frame = &tree.frames[place * kFrameVectors];
      const glm::dvec3 a(frame[0]), x(frame[1]), y(frame[2]);
      ASSERT_NEAR(glm::length(x), 1.0, 2e-7);
      ASSERT_NEAR(glm::length(y), 1.0, 2e-7);
      ASSERT_NEAR(glm::dot(x, y), 0.0, 2e-7);
      const glm::uvec3 corners = mesh.triangles[tree.triangleId(place)];
      int start = 0;
      while (start < 2 && glm::dvec3(mesh.vertices[corners[start]]) != a) ++start;
      const glm::dvec3 b(mesh.vertices[corners[(start + 1) % 3]]), c(mesh.vertices[corners[(start + 2) % 3]]);
      if (c == a || b == a) continue;  // The frame may begin at the other one.
      const double allowed = 3e-7 * size;
      ASSERT_LT(glm::length(a + double(frame[0].w) * x - b), allowed) << place;
      ASSERT_LT(glm::length(a + double(frame[1].w) * x + double(frame[2].w) * y - c), allowed) << place;
    }
  }
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

TEST_F(VulkanSurfaceTree, KnowsWhatItWillHold) {
  constexpr uint32_t kTriangles = 1 << 18;
  SurfaceTreeStage tree(device());
  const uint64_t before = device().heldMemory();
  tree.reserve(kTriangles);
  const auto held = double(device().heldMemory() - before);
  EXPECT_NEAR(double(SurfaceTreeStage::bytesNeeded(kTriangles)) / held, 1.0, 0.02);
}

}  // namespace
}  // namespace raymap::vulkan
