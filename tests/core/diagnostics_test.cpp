#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "mesh/defects.h"
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

TEST(Defects, NameTheFurtherFacesOnTheSameCorners) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const glm::uvec3 face = mesh.triangles[3];
  mesh.triangles.push_back(face);                             // 12
  mesh.triangles.emplace_back(face.y, face.x, face.z);        // 13
  mesh.triangles.insert(mesh.triangles.end(), 2, {0, 1, 1});  // Without three corners, they are no faces.
  mesh.triangles.insert(mesh.triangles.end(), 2, {0, 0, 1});
  EXPECT_EQ(findDefects(Model(mesh)).duplicateFaces, (std::vector<uint32_t>{12, 13}));
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

TEST(Diagnostics, CountsFlippedFaces) {
  Mesh mesh = shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(1.0, 2, {5, 0, 0}));
  EXPECT_EQ(diagnose(mesh).flippedFaces, 0u);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    if (f % 7 == 0) std::swap(mesh.triangles[f].x, mesh.triangles[f].y);
  EXPECT_EQ(diagnose(mesh).flippedFaces, (mesh.triangles.size() + 6) / 7);
}

TEST(Diagnostics, TracesHoles) {
  // A grid of 10 x 10 squares without 2 x 3 of them and one that touches their corner.
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (int y = 0; y <= 10; ++y)
    for (int x = 0; x <= 10; ++x) p.emplace_back(x, y, 5.0);
  for (uint32_t y = 0; y < 10; ++y)
    for (uint32_t x = 0; x < 10; ++x) {
      if ((x >= 2 && x < 4 && y >= 2 && y < 5) || (x == 4 && y == 5)) continue;
      const uint32_t a = y * 11 + x;
      t.insert(t.end(), {{a, a + 1, a + 12}, {a, a + 12, a + 11}});
    }
  const std::vector<Hole> holes = diagnose(makeMesh(p, t)).holes;
  ASSERT_EQ(holes.size(), 3u);
  const size_t edges[] = {40, 10, 4};
  const double areas[] = {100.0, 6.0, 1.0};
  const double diameters[] = {std::sqrt(200.0), std::sqrt(13.0), std::sqrt(2.0)};
  const glm::dvec3 centres[] = {{5, 5, 5}, {3, 3.5, 5}, {4.5, 5.5, 5}};
  for (size_t h = 0; h < 3; ++h) {
    EXPECT_EQ(holes[h].edges, edges[h]);
    EXPECT_DOUBLE_EQ(holes[h].length, double(edges[h]));
    EXPECT_NEAR(holes[h].area, areas[h], 1e-9);
    EXPECT_NEAR(holes[h].diameter, diameters[h], 1e-6);
    EXPECT_LT(glm::distance(holes[h].centre, centres[h]), 1e-6);
  }
}

TEST(Diagnostics, CountsEveryBoundaryEdgeInOneHole) {
  // The boundary around an edge with three faces does not close.
  Mesh fan;
  fan.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  for (const Mesh& mesh : {fan, shapes::soup(50, 4)}) {
    const Diagnostics found = diagnose(mesh);
    size_t edges = 0;
    for (const Hole& hole : found.holes) edges += hole.edges;
    EXPECT_EQ(edges, found.boundaryEdges);
  }
  EXPECT_TRUE(diagnose(shapes::sphere(1.0, 2)).holes.empty());
}

TEST(Diagnostics, CountsCrossingFaces) {
  EXPECT_EQ(findSelfIntersections(shapes::sphere(1.0, 3)).pairs, 0u);
  EXPECT_EQ(findSelfIntersections(shapes::torus(1.0, 0.4, 40, 20)).pairs, 0u);
  const SelfIntersections apart = findSelfIntersections(
      shapes::joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 0, 0}, {2, 1, 1})));
  EXPECT_EQ(apart.pairs, 0u);  // They touch.
  Mesh two;
  two.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {9, 9, 0}};
  two.triangles = {{0, 1, 2}, {3, 4, 5}};
  const SelfIntersections crossing = findSelfIntersections(two);
  EXPECT_EQ(crossing.pairs, 1u);
  EXPECT_EQ(crossing.faces, (std::vector<uint32_t>{0, 1}));
}

TEST(Diagnostics, CountsFacesThatOverlapInOnePlane) {
  // The diagonals of the sides where the boxes touch are parallel: one half lies on one half.
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto beside = [&](double x, double y) {
    return findSelfIntersections(shapes::joined(box, shapes::box({x, y, 0}, {x + 1.0, y + 1.0, 1})));
  };
  const SelfIntersections touching = beside(1.0, 0.5);
  EXPECT_EQ(touching.pairs, 0u);
  EXPECT_EQ(touching.coplanarPairs, 3u);
  EXPECT_EQ(touching.coplanarFaces.size(), 4u);
  EXPECT_TRUE(std::ranges::is_sorted(touching.coplanarFaces));
  EXPECT_TRUE(touching.faces.empty());
  EXPECT_EQ(beside(1.25, 0.5).coplanarPairs, 0u);
  EXPECT_EQ(beside(1.0, 1.0).coplanarPairs, 0u) << "They share an edge.";
  EXPECT_EQ(findSelfIntersections(shapes::joined(box, box)).coplanarPairs, 0u) << "These are duplicates.";
  EXPECT_EQ(findSelfIntersections(box).coplanarPairs, 0u);
}

TEST(Diagnostics, CountsFacesThatCrossFromEdgeToEdge) {
  // They share a segment whose ends lie on edges of both, and no edge passes through a face.
  Mesh mesh;
  mesh.vertices = {{-1, 0, 0}, {1, 0, 0}, {0, 2, 0}, {-0.5f, 0, -1}, {0.5f, 0, 1}, {0, 2, 0}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  EXPECT_EQ(findSelfIntersections(mesh).pairs, 1u);
  // Rotated about the same edge, or with one corner on the other's plane, they only touch.
  mesh.vertices[3] = {1, 0, 0};
  EXPECT_EQ(findSelfIntersections(mesh).pairs, 0u);
  mesh.vertices[3] = {0, 0, 1};
  EXPECT_EQ(findSelfIntersections(mesh).pairs, 0u);
}

bool segmentCrosses(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3 (&t)[3]) {
  const auto side = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r, const glm::dvec3& s) {
    return glm::dot(glm::cross(q - p, r - p), s - p) > 0.0;
  };
  if (side(t[0], t[1], t[2], a) == side(t[0], t[1], t[2], b)) return false;
  const bool first = side(a, b, t[0], t[1]);
  return side(a, b, t[1], t[2]) == first && side(a, b, t[2], t[0]) == first;
}

TEST(Diagnostics, FindsTheCrossingsOfASoup) {
  const Mesh mesh = shapes::soup(200, 9);
  size_t expected = 0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (size_t j = i + 1; j < mesh.triangles.size(); ++j) {
      glm::dvec3 a[3], b[3];
      for (int c = 0; c < 3; ++c) {
        a[c] = mesh.position(mesh.triangles[i][c]);
        b[c] = mesh.position(mesh.triangles[j][c]);
      }
      bool cross = false;
      for (int c = 0; c < 3; ++c)
        cross = cross || segmentCrosses(a[c], a[(c + 1) % 3], b) || segmentCrosses(b[c], b[(c + 1) % 3], a);
      expected += cross ? 1 : 0;
    }
  EXPECT_GT(expected, 1000u);
  EXPECT_EQ(findSelfIntersections(mesh).pairs, expected);
}

TEST(Diagnostics, StopsCountingWhereAllFacesCross) {
  // Triangles around one axis intersect each other.
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (uint32_t i = 0; i < 60000; ++i) {
    const double turn = 3.0 * unit(random);
    const glm::dvec3 side(std::cos(turn), std::sin(turn), 0.0);
    for (const glm::dvec3& corner :
         {side + glm::dvec3(0, 0, unit(random)), -side + glm::dvec3(0, 0, unit(random)), glm::dvec3(0, 0, 3)})
      p.push_back(corner);
    t.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  const SelfIntersections found = findSelfIntersections(makeMesh(p, t));
  EXPECT_FALSE(found.complete);
  EXPECT_GT(found.pairs, 1000000u);
}

TEST(Diagnostics, FindsInwardComponentsOfAnySize) {
  const Mesh box = shapes::box({-20, 0, 0}, {-19, 1, 1});
  for (const double size : {1e-3, 1.0, 1e3}) {
    const Mesh inward = shapes::inverted(shapes::box({0, 0, 0}, {size, size, size}));
    EXPECT_EQ(diagnose(inward).inwardComponents, 1u) << size;
    EXPECT_EQ(diagnose(shapes::joined(box, inward)).inwardComponents, 1u) << size;
    // What is so flat that its volume may be a rounding error points neither way.
    const Mesh flat = shapes::inverted(shapes::box({0, 0, 0}, {size, size, 1e-10 * size}));
    EXPECT_EQ(diagnose(flat).inwardComponents, 0u) << size;
  }
}

TEST(Diagnostics, RefusesABadIndex) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  mesh.triangles[0].x = 8;
  EXPECT_THROW(diagnose(mesh), Error);
}

TEST(Diagnostics, CountsDoubleSidedFaces) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(diagnose(mesh).doubleSidedFaces, 0u);
  const glm::uvec3 first = mesh.triangles[0], second = mesh.triangles[1];
  mesh.triangles.push_back(first);
  EXPECT_EQ(diagnose(mesh).duplicateFaces, 1u);
  EXPECT_EQ(diagnose(mesh).doubleSidedFaces, 0u);
  mesh.triangles.emplace_back(second.y, second.x, second.z);
  EXPECT_EQ(diagnose(mesh).duplicateFaces, 2u);
  EXPECT_EQ(diagnose(mesh).doubleSidedFaces, 2u);
  mesh.triangles.emplace_back(first.x, first.z, first.y);
  mesh.triangles.emplace_back(first.z, first.y, first.x);
  EXPECT_EQ(diagnose(mesh).duplicateFaces, 4u);
  EXPECT_EQ(diagnose(mesh).doubleSidedFaces, 6u);
  EXPECT_EQ(diagnose(mesh, {.brief = true}).doubleSidedFaces, 6u);
}

TEST(RemoveFaces, KeepsTheOthersInOrder) {
  Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const Mesh whole = mesh;
  removeFaces(mesh, std::vector<uint32_t>{11, 3, 3, 0});
  ASSERT_EQ(mesh.triangles.size(), 9u);
  EXPECT_EQ(mesh.triangles[0], whole.triangles[1]);
  EXPECT_EQ(mesh.triangles[2], whole.triangles[4]);
  EXPECT_EQ(mesh.triangles[8], whole.triangles[10]);
  EXPECT_EQ(mesh.vertices, whole.vertices);
  EXPECT_THROW(removeFaces(mesh, std::vector<uint32_t>{0, 9}), Error);
  EXPECT_EQ(mesh.triangles.size(), 9u);
  removeFaces(mesh, {});
  EXPECT_EQ(mesh.triangles.size(), 9u);
}

}  // namespace
}  // namespace raymap
