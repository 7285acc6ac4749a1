#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include "shapes.h"

namespace raymap {
namespace {

TEST(Diagnostics, FindsNothingWrongWithABox) {
  const Diagnostics found = diagnose(shapes::box({10, 0, 0}, {12, 1, 1}));
  EXPECT_EQ(found.vertices, 8u);
  EXPECT_EQ(found.weldedVertices, 8u);
  EXPECT_EQ(found.triangles, 12u);
  EXPECT_EQ(found.components, 1u);
  EXPECT_TRUE(found.watertight);
  EXPECT_TRUE(found.consistentlyOriented);
  EXPECT_TRUE(found.balanced);
  EXPECT_EQ(found.boundaryEdges + found.nonManifoldEdges + found.flippedEdges, 0u);
  EXPECT_EQ(found.degenerateFaces + found.duplicateFaces, 0u);
  EXPECT_DOUBLE_EQ(found.signedVolume, 2.0);
  EXPECT_DOUBLE_EQ(found.area, 10.0);
  EXPECT_EQ(found.bounds.max.x, 12.0);
}

TEST(Diagnostics, WeldsASoupOfFaces) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  Mesh soup;
  for (const glm::uvec3& face : box.triangles) {
    const auto first = static_cast<uint32_t>(soup.vertices.size());
    for (int c = 0; c < 3; ++c) soup.vertices.push_back(box.vertices[face[c]]);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  const Diagnostics found = diagnose(soup);
  EXPECT_EQ(found.vertices, 36u);
  EXPECT_EQ(found.weldedVertices, 8u);
  EXPECT_TRUE(found.watertight);
}

TEST(Diagnostics, TreatsMinusZeroAsZero) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, 0}, {1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}};
  const Diagnostics found = diagnose(mesh);
  EXPECT_EQ(found.weldedVertices, 4u);
  EXPECT_EQ(found.boundaryEdges, 4u);
  EXPECT_EQ(found.components, 1u);
}

TEST(Diagnostics, CountsTheEdgesOfAHole) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  const Diagnostics found = diagnose(mesh);
  EXPECT_EQ(found.boundaryEdges, 3u);
  EXPECT_FALSE(found.watertight);
  EXPECT_FALSE(found.balanced);
  EXPECT_TRUE(found.consistentlyOriented);
}

TEST(Diagnostics, CountsFlippedEdges) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.triangles[0].x, mesh.triangles[0].y);
  const Diagnostics found = diagnose(mesh);
  EXPECT_EQ(found.flippedEdges, 3u);
  EXPECT_TRUE(found.watertight);
  EXPECT_FALSE(found.consistentlyOriented);
  EXPECT_FALSE(found.balanced);
}

TEST(Diagnostics, CallsTwoBoxesOnOneEdgeBalanced) {
  const Diagnostics found =
      diagnose(shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1})));
  EXPECT_EQ(found.nonManifoldEdges, 1u);
  EXPECT_EQ(found.components, 1u);
  EXPECT_FALSE(found.watertight);
  EXPECT_TRUE(found.balanced);
}

TEST(Diagnostics, CountsDuplicatesInEitherOrientation) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const glm::uvec3 face = mesh.triangles[0];
  mesh.triangles.push_back(face);
  mesh.triangles.emplace_back(face.z, face.y, face.x);
  EXPECT_EQ(diagnose(mesh).duplicateFaces, 2u);
}

TEST(Diagnostics, KeepsRepeatedCornersOutOfTheEdges) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.emplace_back(0, 1, 1);
  mesh.triangles.emplace_back(2, 2, 2);
  const Diagnostics found = diagnose(mesh);
  EXPECT_EQ(found.degenerateFaces, 2u);
  EXPECT_EQ(found.duplicateFaces, 0u);
  EXPECT_TRUE(found.watertight);
}

TEST(Diagnostics, FindsNeedles) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5f, 0.9e-6f, 0}, {0.5f, 1.1e-6f, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(diagnose(mesh).degenerateFaces, 1u);
}

TEST(Diagnostics, CountsComponents) {
  EXPECT_EQ(diagnose(shapes::joined(shapes::sphere(1, 1), shapes::torus(4, 1, 12, 8))).components, 2u);
  EXPECT_EQ(diagnose(shapes::soup(100, 1)).components, 100u);
}

TEST(Diagnostics, RefusesABadIndex) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles[0].x = 8;
  EXPECT_THROW(diagnose(mesh), Error);
}

}  // namespace
}  // namespace raymap
