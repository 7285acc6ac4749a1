// Diagnostics of meshes large enough for several tasks: the same for any number of threads, and as simple
// code finds them.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "mesh/patches.h"
#include "mesh/weld.h"
#include "shapes.h"

namespace raymap {
namespace {

/// A ball with reversed and missing faces, a torus through it, loose triangles and a doubled face, as soup.
Mesh brokenSoup() {
  Mesh ball = shapes::sphere(1.0, 6);
  for (size_t f = 0; f < ball.triangles.size(); f += 1001)
    std::swap(ball.triangles[f].x, ball.triangles[f].y);
  ball.triangles.resize(ball.triangles.size() - 9);
  ball.triangles.push_back(ball.triangles[70000]);
  const Mesh mesh =
      shapes::joined(shapes::joined(ball, shapes::torus(1.0, 0.3, 200, 100)), shapes::soup(300, 4));
  Mesh soup{.origin = mesh.origin};
  for (const glm::uvec3& face : mesh.triangles) {
    const auto first = uint32_t(soup.vertices.size());
    for (int c = 0; c < 3; ++c) soup.vertices.push_back(mesh.vertices[face[c]]);
    soup.triangles.emplace_back(first, first + 1, first + 2);
  }
  return soup;
}

auto figures(const Diagnostics& d) {
  return std::tuple(d.vertices, d.weldedVertices, d.triangles, d.boundaryEdges, d.nonManifoldEdges,
                    d.flippedEdges, d.flippedFaces, d.components, d.degenerateFaces, d.duplicateFaces,
                    d.watertight, d.consistentlyOriented, d.balanced, d.signedVolume, d.area);
}

TEST(DiagnosticsThreads, CountTheSame) {
  const Mesh mesh = brokenSoup();
  Diagnostics one, many;
  withThreads(1, [&] { one = diagnose(mesh); });
  withThreads(4, [&] { many = diagnose(mesh); });
  EXPECT_EQ(figures(one), figures(many));
  EXPECT_EQ(one.bounds.min, many.bounds.min);
  EXPECT_EQ(one.bounds.max, many.bounds.max);
  EXPECT_EQ(one.duplicateFaces, 1u);
  EXPECT_EQ(one.flippedFaces, 82u);
  ASSERT_EQ(one.holes.size(), many.holes.size());
  for (size_t h = 0; h < one.holes.size(); ++h) {
    EXPECT_EQ(one.holes[h].length, many.holes[h].length);
    EXPECT_EQ(one.holes[h].centre, many.holes[h].centre);
  }
}

TEST(DiagnosticsThreads, SumAreasInTheOrderOfFaces) {
  const Mesh mesh = brokenSoup();
  double area = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.vertices[t.x]);
    area +=
        glm::length(glm::cross(glm::dvec3(mesh.vertices[t.y]) - a, glm::dvec3(mesh.vertices[t.z]) - a)) / 2.0;
  }
  EXPECT_EQ(diagnose(mesh).area, area);
}

TEST(DiagnosticsThreads, LeaveOutWhatABriefDiagnosisDoesNotNeed) {
  const Mesh mesh = brokenSoup();
  const Diagnostics brief = diagnose(mesh, {.brief = true});
  Diagnostics expected = diagnose(mesh);
  EXPECT_GT(expected.holes.size(), 0u);
  EXPECT_GT(expected.components, 1u);
  expected.components = expected.flippedFaces = 0;
  EXPECT_EQ(figures(brief), figures(expected));
  EXPECT_TRUE(brief.holes.empty());
}

TEST(DiagnosticsThreads, FindTheSameCrossings) {
  const Mesh mesh = brokenSoup();
  SelfIntersections one, many;
  withThreads(1, [&] { one = findSelfIntersections(mesh); });
  withThreads(4, [&] { many = findSelfIntersections(mesh); });
  EXPECT_GT(one.pairs, 1000u);
  EXPECT_EQ(one.pairs, many.pairs);
  EXPECT_EQ(one.faces, many.faces);
  EXPECT_TRUE(one.complete && many.complete);
}

TEST(DiagnosticsThreads, StopOnRequest) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  const ProgressCallback stop = [](std::string_view, double) { return false; };
  EXPECT_THROW(diagnose(mesh, {}, {.progress = stop}), Error);
  EXPECT_THROW(findSelfIntersections(mesh, {.progress = stop}), Error);
}

TEST(DiagnosticsThreads, ReportTheirStages) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  std::map<std::string, std::vector<double>> shares;
  const ProgressCallback note = [&](std::string_view stage, double share) {
    shares[std::string(stage)].push_back(share);
    return true;
  };
  diagnose(mesh, {}, {.progress = note});
  findSelfIntersections(mesh, {.progress = note});
  ASSERT_EQ(shares.size(), 2u);
  for (const char* stage : {"diagnose", "crossing pairs"}) {
    EXPECT_GT(shares[stage].size(), 2u) << stage;
    EXPECT_TRUE(std::is_sorted(shares[stage].begin(), shares[stage].end())) << stage;
  }
  EXPECT_EQ(shares["crossing pairs"].back(), 1.0);
}

TEST(Weld, NumbersPositionsInTheirOrder) {
  std::mt19937 random(3);
  const auto coordinate = [&] { return float(int(random() % 41) - 20) / 4.0f; };
  std::vector<glm::vec3> vertices(150000);
  for (glm::vec3& v : vertices) v = {coordinate(), coordinate(), random() % 2 ? 0.0f : -0.0f};
  const auto key = [](const glm::vec3& v) {
    const glm::vec3 p = v + 0.0f;
    return std::array{std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y),
                      std::bit_cast<uint32_t>(p.z)};
  };
  std::map<std::array<uint32_t, 3>, uint32_t> numbers;
  for (const glm::vec3& v : vertices) numbers[key(v)] = 0;
  uint32_t next = 0;
  for (auto& [position, number] : numbers) number = next++;
  const Welding welding = weldVertices(vertices);
  EXPECT_EQ(welding.count, numbers.size());
  for (size_t v = 0; v < vertices.size(); ++v) ASSERT_EQ(welding.ids[v], numbers[key(vertices[v])]) << v;
}

/// Links faces one after the other, in the order of their edges.
Patches patchesInOrder(const Mesh& mesh) {
  const Welding welding = weldVertices(mesh.vertices);
  std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<uint32_t, bool>>> edges;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = welding.ids[mesh.triangles[f][c]], b = welding.ids[mesh.triangles[f][(c + 1) % 3]];
      edges[std::minmax(a, b)].emplace_back(f, a < b);
    }
  // Members of each patch with their bits; the patch of each face.
  std::vector<std::vector<std::pair<uint32_t, bool>>> members;
  std::vector<std::pair<uint32_t, bool>> placeOf;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    members.push_back({{f, false}});
    placeOf.emplace_back(f, false);
  }
  for (const auto& [edge, faces] : edges) {
    if (faces.size() != 2) continue;
    auto [p, pBit] = placeOf[faces[0].first];
    auto [q, qBit] = placeOf[faces[1].first];
    if (p == q) continue;
    const bool isReversed = pBit ^ qBit ^ (faces[0].second == faces[1].second);
    if (p > q) std::swap(p, q);
    for (const auto& [face, bit] : members[q]) {
      placeOf[face] = {p, bit ^ isReversed};
      members[p].emplace_back(face, bit ^ isReversed);
    }
    members[q].clear();
  }
  Patches patches;
  std::map<uint32_t, uint32_t> numbers;
  for (const auto& [patch, bit] : placeOf) {
    patches.ids.push_back(numbers.try_emplace(patch, uint32_t(numbers.size())).first->second);
    patches.isReversed.push_back(bit);
  }
  patches.count = numbers.size();
  return patches;
}

/// A band of `n` quads, twisted by half turns.
Mesh band(int n, int halfTurns) {
  std::vector<glm::dvec3> p;
  for (int k = 0; k < n; ++k)
    for (const double side : {-0.3, 0.3}) {
      const double turn = 6.283185307179586 * k / n, twist = 0.5 * turn * halfTurns;
      const double radius = 1.0 + side * std::cos(twist);
      p.emplace_back(radius * std::cos(turn), radius * std::sin(turn), side * std::sin(twist));
    }
  std::vector<glm::uvec3> t;
  for (uint32_t k = 0; k < uint32_t(n); ++k) {
    const uint32_t a = 2 * k, b = a + 1;
    const bool isLast = k + 1 == uint32_t(n), isCrossed = isLast && halfTurns % 2 != 0;
    const uint32_t c = isLast ? (isCrossed ? 1 : 0) : a + 2, d = isLast ? (isCrossed ? 0 : 1) : a + 3;
    t.emplace_back(a, b, c);
    t.emplace_back(b, d, c);
  }
  return makeMesh(p, t);
}

TEST(Patches, LinkInTheOrderOfEdges) {
  std::mt19937 random(5);
  for (const int halfTurns : {0, 1, 2, 3}) {
    Mesh mesh = shapes::joined(shapes::sphere(1.0, 4), band(500, halfTurns));
    for (glm::uvec3& t : mesh.triangles)
      if (random() % 3 == 0) std::swap(t.x, t.y);
    const Patches expected = patchesInOrder(mesh), found = findPatches(Model(mesh));
    EXPECT_EQ(found.count, 2u);
    EXPECT_EQ(found.count, expected.count) << halfTurns;
    EXPECT_EQ(found.ids, expected.ids) << halfTurns;
    EXPECT_EQ(found.isReversed, expected.isReversed) << halfTurns;
  }
}

}  // namespace
}  // namespace raymap
