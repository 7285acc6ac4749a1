#include "repair/topology/fill_holes.h"

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/mesh_view.h>

#include <numbers>

#include "broken_meshes.h"
#include "closed_mesh.h"
#include "mesh/triangle.h"
#include "shapes.h"

namespace raymap {
namespace {

TEST(FillHoles, GivesAHoleItsFaceBack) {
  Mesh mesh = shapes::sphere(1.0, 2);
  const glm::uvec3 lost = mesh.triangles[5];
  mesh.triangles.erase(mesh.triangles.begin() + 5);
  const size_t left = mesh.triangles.size();
  const FilledHoles filled = fillHoles(mesh);
  EXPECT_EQ(filled.holes, 1u);
  EXPECT_EQ(filled.faces, 1u);
  ASSERT_EQ(mesh.triangles.size(), left + 1);
  glm::uvec3 face = mesh.triangles.back();
  while (face.x != lost.x) face = {face.y, face.z, face.x};
  EXPECT_EQ(face, lost);
}

TEST(FillHoles, TakesTheFlatDiagonal) {
  // Both triangles of a side of a box whose diagonal is free to choose: only one is flat.
  for (const size_t side : {0, 2, 4, 6, 8, 10}) {
    Mesh mesh = shapes::box({0, 0, 0}, {1, 2, 3});
    mesh.triangles.erase(mesh.triangles.begin() + ptrdiff_t(side),
                         mesh.triangles.begin() + ptrdiff_t(side) + 2);
    const FilledHoles filled = fillHoles(mesh);
    EXPECT_EQ(filled.holes, 1u);
    EXPECT_EQ(filled.faces, 2u);
    EXPECT_TRUE(isClosed(mesh));
    EXPECT_NEAR(volumeOf(mesh), 6.0, 1e-5);
  }
}

TEST(FillHoles, FollowsTheSurface) {
  // A ridge: without the two faces between its slopes, the diagonal along the ridge is the least sharp one.
  const std::vector<glm::dvec3> p{{0, 0, 1}, {2, 0, 1}, {0, -1, 0}, {2, 1, 0}, {0, 1, 0}, {2, -1, 0}};
  const Mesh roof =
      makeMesh(p, {{0, 2, 1}, {2, 5, 1}, {0, 3, 4}, {0, 1, 3}, {2, 4, 3}, {2, 3, 5}, {0, 4, 2}, {1, 5, 3}});
  ASSERT_TRUE(isClosed(roof));
  Mesh mesh = roof;
  std::erase_if(mesh.triangles,
                [](const glm::uvec3& t) { return t == glm::uvec3(0, 2, 1) || t == glm::uvec3(0, 1, 3); });
  EXPECT_EQ(fillHoles(mesh).faces, 2u);
  EXPECT_NEAR(volumeOf(mesh), volumeOf(roof), 1e-6);
}

TEST(FillHoles, ClosesRoundHoles) {
  Mesh mesh = withHoles(shapes::sphere(1.0, 4), 5, 0.06, 2);
  const size_t left = mesh.triangles.size(), lost = 5120 - left;
  const FilledHoles filled = fillHoles(mesh);
  EXPECT_EQ(filled.holes, 5u);
  EXPECT_GT(lost, 100u);
  EXPECT_EQ(mesh.triangles.size(), left + filled.faces);
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_NEAR(volumeOf(mesh), 4.1888, 0.05);
}

Mesh cone(uint32_t rim) {
  std::vector<glm::dvec3> p{{0, 0, 1}};
  std::vector<glm::uvec3> t;
  for (uint32_t i = 0; i < rim; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / rim;
    p.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    t.emplace_back(0, 1 + i, 1 + (i + 1) % rim);
  }
  return makeMesh(p, std::move(t));
}

TEST(FillHoles, FillsRimsOfAnyLength) {
  // Rims of more than 300 edges are divided, those of more than 22,500 twice.
  for (const uint32_t edges : {299u, 300u, 301u, 450u, 451u, 3000u, 24000u}) {
    Mesh mesh = cone(edges);
    const FilledHoles filled = fillHoles(mesh);
    EXPECT_EQ(filled.holes, 1u);
    EXPECT_EQ(filled.faces, edges - 2);
    EXPECT_TRUE(isClosed(mesh));
    EXPECT_NEAR(volumeOf(mesh), std::numbers::pi / 3.0, 0.001);
    double area = 0.0;
    for (size_t f = edges; f < mesh.triangles.size(); ++f) {
      const glm::uvec3& t = mesh.triangles[f];
      const glm::dvec3 normal = doubleAreaNormal(
          glm::dvec3(mesh.vertices[t.x]), glm::dvec3(mesh.vertices[t.y]), glm::dvec3(mesh.vertices[t.z]));
      area += 0.5 * glm::length(normal);
      EXPECT_LT(normal.z, 0.0) << edges;
    }
    EXPECT_NEAR(area, std::numbers::pi, 0.001) << edges;
  }
}

/// Returns a half ball whose rim goes up and down five times.
Mesh wavyBowl(uint32_t rim) {
  constexpr uint32_t kRings = 20;
  std::vector<glm::dvec3> p{{0, 0, 1}};
  std::vector<glm::uvec3> t;
  for (uint32_t ring = 1; ring <= kRings; ++ring)
    for (uint32_t i = 0; i < rim; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / rim;
      const double down = (std::numbers::pi / 2.0 + 0.2 * std::sin(5.0 * angle)) * ring / kRings;
      p.emplace_back(std::sin(down) * std::cos(angle), std::sin(down) * std::sin(angle), std::cos(down));
      const uint32_t last = 1 + (ring - 1) * rim, next = (i + 1) % rim;
      if (ring == 1) {
        t.emplace_back(0, last + i, last + next);
        continue;
      }
      const uint32_t before = last - rim;
      t.emplace_back(before + i, last + i, last + next);
      t.emplace_back(before + i, last + next, before + next);
    }
  return makeMesh(p, std::move(t));
}

TEST(FillHoles, BendsLongRimsAsShortOnes) {
  Mesh few = wavyBowl(250), many = wavyBowl(2000);
  EXPECT_EQ(fillHoles(few).faces, 248u);
  EXPECT_EQ(fillHoles(many).faces, 1998u);
  EXPECT_TRUE(isClosed(many));
  EXPECT_NEAR(volumeOf(many), volumeOf(few), 0.03 * volumeOf(few));
  EXPECT_EQ(findSelfIntersections(many).pairs, 0u);
}

TEST(FillHoles, TakesTheSmallerOfTwoFillingsThatAreEquallySharp) {
  // The face beyond the edge from 0 to 1 has no area, so its edge counts as the sharpest in either filling.
  // With the diagonal from 0 to 2 the area is the square root of 5, with the one from 1 to 3 it is 2.
  for (uint32_t first = 0; first < 4; ++first) {
    const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 0, 0}, {1, 1, 2}, {0, 1, 0}, {-1, 0, 0}};
    const auto at = [&](uint32_t k) { return k < 4 ? (k + first) % 4 : k; };
    std::vector<glm::dvec3> turned(p);
    for (uint32_t k = 0; k < 4; ++k) turned[at(k)] = p[k];
    Mesh mesh =
        makeMesh(turned, {{at(1), at(0), 4}, {at(2), at(1), 4}, {at(3), at(2), 4}, {at(0), at(3), 4}});
    EXPECT_EQ(fillHoles(mesh).faces, 2u);
    double area = 0.0;
    for (size_t f = 4; f < mesh.triangles.size(); ++f) {
      const glm::uvec3& t = mesh.triangles[f];
      area += triangleArea(mesh.position(t.x), mesh.position(t.y), mesh.position(t.z));
    }
    EXPECT_NEAR(area, 2.0, 1e-6) << first;
  }
}

TEST(FillHoles, TakesNoFaceWithoutArea) {
  // Corner 1 is in the middle of a side. The faces beyond that side fold sharply, those beyond the others
  // less.
  for (uint32_t first = 0; first < 4; ++first) {
    const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0.875, -0.5}};
    const auto at = [&](uint32_t k) { return k < 4 ? (k + first) % 4 : k; };
    std::vector<glm::dvec3> turned(p);
    for (uint32_t k = 0; k < 4; ++k) turned[at(k)] = p[k];
    Mesh mesh =
        makeMesh(turned, {{at(1), at(0), 4}, {at(2), at(1), 4}, {at(3), at(2), 4}, {at(0), at(3), 4}});
    EXPECT_EQ(fillHoles(mesh).faces, 2u);
    for (size_t f = 4; f < mesh.triangles.size(); ++f) {
      const glm::uvec3& t = mesh.triangles[f];
      EXPECT_EQ(triangleArea(mesh.position(t.x), mesh.position(t.y), mesh.position(t.z)), 0.5) << first;
    }
  }
}

TEST(FillHoles, PartsRimsThatMeet) {
  const Mesh whole = shapes::sphere(1.0, 2);
  for (const uint32_t centre : {0u, 12u, 40u}) {  // Of five faces and of six.
    Mesh mesh = whole;
    size_t around = 0;
    std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
      const bool isAround = t.x == centre || t.y == centre || t.z == centre;
      return isAround && around++ % 2 == 0;
    });
    const size_t lost = whole.triangles.size() - mesh.triangles.size();
    const FilledHoles filled = fillHoles(mesh);
    EXPECT_EQ(filled.faces, lost);
    EXPECT_GT(filled.holes, 0u);
    EXPECT_EQ(mesh.triangles.size(), whole.triangles.size());
    EXPECT_TRUE(isClosed(mesh));
    EXPECT_NEAR(volumeOf(mesh), volumeOf(whole), 0.01);
  }
}

}  // namespace
}  // namespace raymap
