#include "repair/topology/clean_faces.h"

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/repair.h>

#include <cmath>
#include <tuple>
#include <utility>

#include "shapes.h"

namespace raymap {
namespace {

/// A box and one of its long edges, from `a` to `b`: `face` is (a, b, apex).
struct Edge {
  Mesh mesh = shapes::box({0, 0, 0}, {4, 2, 1});
  uint32_t a = 0, b = 0, face = 0, apex = 0;

  Edge() {
    for (uint32_t f = 0; f < mesh.triangles.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const glm::uvec3& t = mesh.triangles[f];
        const glm::vec3 along = mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]];
        if (along != glm::vec3(4, 0, 0)) continue;
        std::tie(face, a, b, apex) = std::tuple(f, t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
      }
  }
  uint32_t add(const glm::vec3& p) {
    mesh.vertices.push_back(p);
    return uint32_t(mesh.vertices.size() - 1);
  }
  glm::vec3 at(float share) const { return mesh.vertices[a] + share * (mesh.vertices[b] - mesh.vertices[a]); }
};

void expectRight(const CleanedFaces& cleaned, double volume) {
  const Diagnostics found = diagnose(cleaned.mesh);
  EXPECT_TRUE(found.watertight);
  EXPECT_TRUE(found.consistentlyOriented);
  EXPECT_EQ(found.degenerateFaces + found.duplicateFaces + found.nonManifoldEdges, 0u);
  EXPECT_NEAR(found.signedVolume, volume, 1e-6 * std::abs(volume));
  EXPECT_EQ(findSelfIntersections(cleaned.mesh).pairs, 0u);
  EXPECT_EQ(cleaned.given.size(), cleaned.mesh.triangles.size());
}

TEST(CleanFaces, FlipsTheLongestEdgeOfAFlatFace) {
  Edge box;
  const uint32_t middle = box.add(box.at(0.25f));
  box.mesh.triangles[box.face] = {box.a, middle, box.apex};
  box.mesh.triangles.push_back({middle, box.b, box.apex});
  box.mesh.triangles.push_back({box.a, box.b, middle});
  ASSERT_EQ(diagnose(box.mesh).degenerateFaces, 1u);
  ASSERT_TRUE(diagnose(box.mesh).watertight);
  const CleanedFaces cleaned = cleanFaces(Model(box.mesh));
  expectRight(cleaned, 8.0);
  EXPECT_EQ(cleaned.count, 1u);
  EXPECT_EQ(cleaned.mesh.triangles.size(), box.mesh.triangles.size());
  size_t kept = 0;
  for (size_t f = 0; f < cleaned.given.size(); ++f) {
    if (f + 1 < cleaned.given.size()) {
      EXPECT_EQ(cleaned.given[f], f);
    }
    kept += cleaned.mesh.triangles[f] == box.mesh.triangles[f];
  }
  const glm::uvec3& sound = box.mesh.triangles[cleaned.given.back()];  // Beyond the edge of the flat face.
  EXPECT_NE(cleaned.given.back() + 1, cleaned.given.size());
  for (const uint32_t end : {box.a, box.b}) EXPECT_TRUE(sound.x == end || sound.y == end || sound.z == end);
  EXPECT_EQ(kept, box.mesh.triangles.size() - 2);
}

TEST(CleanFaces, FlipsOneAfterAnotherInAFan) {
  Edge box;
  std::vector<uint32_t> along{box.a};
  for (const float share : {0.125f, 0.25f, 0.5f, 0.625f}) along.push_back(box.add(box.at(share)));
  along.push_back(box.b);
  box.mesh.triangles[box.face] = {along[0], along[1], box.apex};
  for (size_t k = 1; k + 1 < along.size(); ++k) {
    box.mesh.triangles.push_back({along[k], along[k + 1], box.apex});
    box.mesh.triangles.push_back({along[0], along[k + 1], along[k]});
  }
  ASSERT_EQ(diagnose(box.mesh).degenerateFaces, 4u);
  ASSERT_TRUE(diagnose(box.mesh).watertight);
  const CleanedFaces cleaned = cleanFaces(Model(box.mesh));
  expectRight(cleaned, 8.0);
  EXPECT_EQ(cleaned.count, 4u);
  EXPECT_EQ(cleaned.mesh.vertices, box.mesh.vertices);
}

TEST(CleanFaces, WeldsTheEndsOfATinyEdge) {
  Edge box;
  const uint32_t first = box.add(box.at(0.5f)), second = box.add(box.at(std::nextafter(0.5f, 1.0f)));
  ASSERT_NE(box.mesh.vertices[first], box.mesh.vertices[second]);
  box.mesh.triangles[box.face] = {box.a, first, box.apex};
  box.mesh.triangles.push_back({first, second, box.apex});
  box.mesh.triangles.push_back({second, box.b, box.apex});
  box.mesh.triangles.push_back({box.a, box.b, second});  // Flat; its neighbour across ab is sound.
  box.mesh.triangles.push_back({box.a, second, first});
  ASSERT_TRUE(diagnose(box.mesh).watertight);
  const CleanedFaces cleaned = cleanFaces(Model(box.mesh));
  expectRight(cleaned, 8.0);
  EXPECT_EQ(cleaned.count, 3u);  // The two at the tiny edge, and the flat one.
  EXPECT_EQ(cleaned.mesh.vertices.size(), box.mesh.vertices.size() - 1);
}

TEST(CleanFaces, WeldsWhatRoundingMayJoin) {
  // A small roof whose ridge is 1.2e-7 of the mesh long, or 2e-7. Its faces are sound.
  const Mesh box = shapes::box({2, 0, 0}, {3, 1, 1});
  for (const float ridge : {3.6e-7F, 6e-7F}) {
    const Mesh roof{
        .vertices = {{-0.01F, 0, 0}, {0.01F, -0.01F, 0}, {0.01F, 0.01F, 0}, {0, 0, 0.01F}, {ridge, 0, 0.01F}},
        .triangles = {{0, 2, 1}, {0, 1, 3}, {3, 1, 4}, {4, 1, 2}, {4, 2, 3}, {3, 2, 0}}};
    ASSERT_EQ(diagnose(roof).degenerateFaces, 0u);
    const Mesh mesh = shapes::joined(box, roof);
    EXPECT_EQ(cleanFaces(Model(mesh)).count, 0u);
    const CleanedFaces cleaned = cleanFaces(Model(mesh), Cleaning::Rounded);
    EXPECT_EQ(cleaned.count, ridge < 4e-7F ? 2u : 0u);
    EXPECT_TRUE(diagnose(cleaned.mesh).watertight);
  }
}

TEST(CleanFaces, LeavesOutTheFlapThatAFlipLeaves) {
  const Mesh box = shapes::box({0, 0, 0}, {4, 2, 1});
  const Mesh flap{.vertices = {{8, 0, 0}, {12, 0, 0}, {9, 3, 0}, {10, 0, 0}},
                  .triangles = {{0, 3, 2}, {3, 1, 2}, {0, 1, 3}, {1, 0, 2}}};
  ASSERT_TRUE(diagnose(flap).watertight);
  const CleanedFaces cleaned = cleanFaces(Model(shapes::joined(box, flap)));
  expectRight(cleaned, 8.0);
  EXPECT_EQ(cleaned.mesh.triangles, box.triangles);
  EXPECT_EQ(cleaned.mesh.vertices.size(), box.vertices.size());
}

TEST(CleanFaces, LeavesOutTheOtherSideOfFacesThatCloseTheSurface) {
  const Mesh ball = shapes::sphere(1.0, 2);
  const double volume = diagnose(ball).signedVolume;
  for (const bool isFirst : {false, true}) {
    Mesh doubled = ball;
    doubled.triangles.clear();
    const auto add = [&](bool isTurned) {
      for (size_t f = 0; f < ball.triangles.size(); ++f) {
        const glm::uvec3& t = ball.triangles[f];
        const bool isDoubled = ball.vertices[t.x].z > 0.3f || f == 0;
        if (!isTurned) doubled.triangles.push_back(t);
        if (isTurned && isDoubled) doubled.triangles.emplace_back(t.x, t.z, t.y);
      }
    };
    add(isFirst);
    add(!isFirst);
    ASSERT_GT(doubled.triangles.size(), ball.triangles.size() + 20);
    const CleanedFaces cleaned = cleanFaces(Model(doubled));
    expectRight(cleaned, volume);
    EXPECT_EQ(cleaned.mesh.triangles, ball.triangles);
    EXPECT_EQ(cleaned.count, doubled.triangles.size() - ball.triangles.size());
  }
}

TEST(CleanFaces, LeavesOutAsManyAsTheSurfaceNeeds) {
  const Mesh ball = shapes::sphere(1.0, 2);
  const glm::uvec3 t = ball.triangles[5], back(t.x, t.z, t.y);
  // Two faces each way cancel. The surface needs one more outwards than back, so one goes.
  for (const std::vector<glm::uvec3>& layers : {std::vector{t, back, back}, std::vector{back, t, back}}) {
    Mesh layered = ball;
    layered.triangles.insert(layered.triangles.end(), layers.begin(), layers.end());
    const CleanedFaces cleaned = cleanFaces(Model(layered));
    EXPECT_EQ(cleaned.mesh.triangles.size(), layered.triangles.size() - 1);
    EXPECT_TRUE(diagnose(cleaned.mesh).balanced);
  }
}

TEST(CleanFaces, KeepsBothSidesOfASheetOnASolid) {
  Mesh fin = shapes::box({0, 0, 0}, {2, 2, 2});
  const auto top = uint32_t(fin.vertices.size());
  fin.vertices.emplace_back(0.0f, 0.0f, 5.0f);
  fin.triangles.emplace_back(0, 1, top);
  fin.triangles.emplace_back(1, 0, top);
  EXPECT_EQ(cleanFaces(Model(fin)).mesh.triangles, fin.triangles);
}

TEST(CleanFaces, LeavesOutRepeatedFacesAndRepeatedCorners) {
  const Mesh ball = shapes::sphere(1.0, 2);
  Mesh mesh = ball;
  mesh.triangles.insert(mesh.triangles.begin() + 5, glm::uvec3(3, 3, 8));
  mesh.triangles.push_back(ball.triangles[7]);
  const CleanedFaces cleaned = cleanFaces(Model(mesh));
  EXPECT_EQ(cleaned.mesh.triangles, ball.triangles);
  EXPECT_EQ(cleaned.count, 2u);
  for (uint32_t f = 0; f < cleaned.given.size(); ++f) EXPECT_EQ(cleaned.given[f], f < 5 ? f : f + 1);
}

TEST(CleanFaces, ChangesNothingOfASoundMesh) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 20, 10);
  const CleanedFaces cleaned = cleanFaces(Model(mesh));
  EXPECT_EQ(cleaned.count, 0u);
  EXPECT_EQ(cleaned.mesh.triangles, mesh.triangles);
  EXPECT_EQ(cleaned.mesh.vertices, mesh.vertices);
}

Repaired repaired(const Mesh& mesh, const RepairOptions& options = {}) {
  return repair(mesh, fitRepairGrid(mesh, {.resolution = 24}, options), {}, options, {.device = "cpu"});
}

TEST(CleanFaces, LetsARepairKeepTheOtherFaces) {
  const Mesh ball = shapes::sphere(1.0, 3);
  Mesh mesh = ball;
  mesh.triangles.insert(mesh.triangles.begin() + 2, glm::uvec3(0, 0, 11));
  mesh.triangles.push_back(ball.triangles[9]);
  const Repaired made = repaired(mesh);
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_EQ(made.report.cleanedFaces, 2u);
  EXPECT_EQ(made.mesh.triangles, ball.triangles);
  EXPECT_EQ(made.mesh.vertices, ball.vertices);
  EXPECT_EQ(made.report.before.degenerateFaces + made.report.before.duplicateFaces, 2u);
  EXPECT_FALSE(repaired(mesh, {.remesh = true}).report.keepsFaces());
  EXPECT_EQ(repaired(ball).report.cleanedFaces, 0u);
}

TEST(CleanFaces, LetsARepairCloseHolesAndTurnFacesToo) {
  const Mesh ball = shapes::sphere(1.0, 3);
  Mesh mesh = ball;
  mesh.triangles.erase(mesh.triangles.begin() + 40);
  mesh.triangles.insert(mesh.triangles.begin(), glm::uvec3(0, 0, 11));
  std::swap(mesh.triangles[100].x, mesh.triangles[100].y);
  const Repaired made = repaired(mesh);
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_EQ(made.report.cleanedFaces, 1u);
  EXPECT_EQ(made.report.closedHoles, 1u);
  EXPECT_EQ(made.report.stats.turnedFaces, std::vector<uint32_t>{100});
  EXPECT_EQ(made.mesh.triangles.size(), ball.triangles.size());
  EXPECT_DOUBLE_EQ(made.report.after.signedVolume, diagnose(ball).signedVolume);
}

TEST(CleanFaces, LetsPartsThatCrossBeUnited) {
  Mesh mesh = shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(1.0, 2, {1.0, 0.1, 0.2}));
  const double volume = repaired(mesh).report.after.signedVolume;
  mesh.triangles.push_back(mesh.triangles[0]);
  const Repaired made = repaired(mesh);
  EXPECT_TRUE(made.report.keepsFaces());
  EXPECT_EQ(made.report.cleanedFaces, 1u);
  EXPECT_GT(made.report.unitedFaces, 0u);
  EXPECT_DOUBLE_EQ(made.report.after.signedVolume, volume);
}

}  // namespace
}  // namespace raymap
