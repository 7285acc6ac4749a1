#include <gtest/gtest.h>
#include <raymap/mesh_attributes.h>
#include <raymap/repair.h>

#include <algorithm>

#include "mesh/triangle.h"
#include "shapes.h"

namespace raymap {
namespace {

using shapes::box;
using shapes::joined;

constexpr uint32_t kNone = MeshAttributes::kNone;

Repaired repaired(const Mesh& mesh, const RepairOptions& options = {}) {
  const Grid grid = fitRepairGrid(mesh, {.voxelSize = 0.0937}, options);
  return repair(mesh, grid, {}, options, {.device = "cpu"});
}

/// Returns attributes whose colours are the positions of the corners, and whose parts are the faces.
MeshAttributes attributesOf(const Mesh& mesh) {
  MeshAttributes attributes;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    attributes.parts.push_back({std::to_string(f)});
    attributes.partOf.push_back(f);
    const auto first = uint32_t(attributes.colours.values.size());
    for (int c = 0; c < 3; ++c)
      attributes.colours.values.emplace_back(glm::vec3(mesh.position(mesh.triangles[f][c])), f);
    attributes.colours.corners.emplace_back(first, first + 1, first + 2);
  }
  return attributes;
}

/// Expects that each face of the result lies in the plane of its source, and that its colours are right.
void expectCarried(const Mesh& given, const Mesh& result, const std::vector<uint32_t>& sources) {
  ASSERT_EQ(sources.size(), result.triangles.size());
  const MeshAttributes attributes = carryAttributes(attributesOf(given), given, result, sources);
  EXPECT_TRUE(attributes.lost.empty());
  for (size_t f = 0; f < sources.size(); ++f) {
    EXPECT_EQ(attributes.partOf[f], sources[f]);
    if (sources[f] == kNone) {
      EXPECT_EQ(attributes.colours.corners[f], glm::uvec3(kNone));
      continue;
    }
    const glm::uvec3 &t = given.triangles[sources[f]], &u = result.triangles[f];
    const glm::dvec3 a = given.position(t.x),
                     normal = glm::normalize(doubleAreaNormal(a, given.position(t.y), given.position(t.z)));
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p = result.position(u[c]);
      EXPECT_NEAR(glm::dot(normal, p - a), 0.0, 1e-6) << f;
      const glm::vec4 colour = attributes.colours.values[attributes.colours.corners[f][c]];
      EXPECT_LT(glm::distance(glm::dvec3(colour), p), 1e-6) << f;
      EXPECT_EQ(colour.w, float(sources[f])) << f;  // The same at all corners.
    }
  }
}

TEST(FaceSource, IsEachFaceOfARightMesh) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  const Repaired kept = repaired(mesh);
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) ASSERT_EQ(kept.faceSource[f], f);
  expectCarried(mesh, kept.mesh, kept.faceSource);
}

TEST(FaceSource, IsNoneOfFacesThatCloseHoles) {
  Mesh mesh = shapes::sphere(1.0, 2);
  mesh.triangles.erase(mesh.triangles.begin() + 40);
  std::swap(mesh.triangles[7].x, mesh.triangles[7].y);
  mesh.triangles.push_back(mesh.triangles[9]);  // Repeated.
  const Repaired mended = repaired(mesh);
  ASSERT_EQ(mended.report.depth, RepairDepth::Mended);
  EXPECT_EQ(std::ranges::count(mended.faceSource, kNone), 1);
  EXPECT_EQ(mended.faceSource.back(), kNone);
  expectCarried(mesh, mended.mesh, mended.faceSource);
}

TEST(FaceSource, IsKnownOfFacesThatAreCut) {
  const Mesh mesh = joined(box({0, 0, 0}, {2, 2, 2}), box({1.1, 0.9, 0.8}, {3, 3, 3.1}));
  const Repaired united = repaired(mesh);
  ASSERT_GT(united.report.unitedFaces, 0u);
  EXPECT_EQ(std::ranges::count(united.faceSource, kNone), 0);
  expectCarried(mesh, united.mesh, united.faceSource);
  const Mesh edges = joined(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1}));  // They share an edge.
  const Repaired parted = repaired(edges);
  ASSERT_EQ(parted.report.depth, RepairDepth::Mended);
  ASSERT_EQ(parted.faceSource.size(), parted.mesh.triangles.size());
}

TEST(FaceSource, FollowsDroppedPartsAndCuts) {
  const Mesh mesh = joined(box({5, 5, 5}, {5.1, 5.1, 5.1}), shapes::sphere(1.0, 2));
  const Plane plane{{0, 0, 1}, 0.21};
  const Repaired cut = repaired(mesh, {.dropSmaller = 0.1, .cutPlane = plane});
  ASSERT_TRUE(cut.report.keepsFaces());
  for (const auto& [half, sources] :
       {std::pair(&cut.mesh, &cut.faceSource), {&cut.cutOff, &cut.cutOffSource}}) {
    EXPECT_GT(std::ranges::count(*sources, kNone), 0);  // Faces in the plane.
    EXPECT_GE(*std::ranges::min_element(*sources), 12u);
    expectCarried(mesh, *half, *sources);
  }
}

TEST(FaceSource, IsTheSoundFaceWhereAnEdgeIsFlipped) {
  Mesh mesh = box({0, 0, 0}, {2, 2, 2});
  const glm::uvec3 cut = mesh.triangles[0];  // A vertex on its first edge makes a face without area.
  mesh.vertices.push_back(0.5F * (mesh.vertices[cut.x] + mesh.vertices[cut.y]));
  const auto middle = uint32_t(mesh.vertices.size() - 1);
  mesh.triangles[0] = {cut.x, middle, cut.z};
  mesh.triangles.emplace_back(middle, cut.y, cut.z);
  mesh.triangles.emplace_back(cut.x, cut.y, middle);
  const Repaired cleaned = repaired(mesh);
  ASSERT_EQ(cleaned.report.cleanedFaces, 1u);
  EXPECT_EQ(std::ranges::count(cleaned.faceSource, 13u), 0);
  expectCarried(mesh, cleaned.mesh, cleaned.faceSource);
}

TEST(FaceSource, IsUnknownOfFacesFromTheField) {
  const Mesh mesh = box({0, 0, 0}, {1, 1, 1});
  const Repaired remade = repaired(mesh, {.remesh = true});
  EXPECT_TRUE(remade.faceSource.empty());
  EXPECT_TRUE(repaired(mesh, {.tolerance = 0.01}).faceSource.empty());
  MeshAttributes given = attributesOf(mesh);
  given.lost = {"odds"};
  const MeshAttributes carried = carryAttributes(given, mesh, remade.mesh, remade.faceSource);
  EXPECT_EQ(carried.lost, (std::vector<std::string>{"12 part names", "colours", "odds"}));
  EXPECT_TRUE(carried.partOf.empty() && carried.colours.corners.empty());
}

}  // namespace
}  // namespace raymap
