// The small tools of src/mesh: triangles, positions, edges, loops, parts and compact meshes.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/morton.h"
#include "mesh/compact.h"
#include "mesh/half_edges.h"
#include "mesh/loops.h"
#include "mesh/model.h"
#include "mesh/part_volumes.h"
#include "mesh/patches.h"
#include "mesh/position_bits.h"
#include "mesh/triangle.h"
#include "shapes.h"

namespace raymap {
namespace {

using glm::dvec3;
using glm::uvec3;
using glm::vec3;

TEST(Triangle, HasANormalAnAreaAndAVolume) {
  const dvec3 a(1, 1, 1), b(5, 1, 1), c(1, 4, 1);
  EXPECT_EQ(doubleAreaNormal(a, b, c), dvec3(0, 0, 12));
  EXPECT_EQ(triangleArea(a, b, c), 6.0);
  EXPECT_EQ(unitNormal(a, b, c), dvec3(0, 0, 1));
  EXPECT_EQ(unitNormal(a, b, b), dvec3(0, 0, 0));
  EXPECT_EQ(longestSide(a, b, c), 5.0);
  EXPECT_EQ(longestSide(c, a, b), 5.0);
  EXPECT_DOUBLE_EQ(signedVolume(a, b, c), 2.0);
  EXPECT_DOUBLE_EQ(signedVolume(a, c, b), -2.0);
}

TEST(PositionBits, AreEqualWhereCoordinatesAre) {
  EXPECT_EQ(positionBits({0.0f, 1.0f, -0.0f}), positionBits({-0.0f, 1.0f, 0.0f}));
  EXPECT_EQ(hashOf(vec3(0.0f, 1.0f, -0.0f)), hashOf(vec3(-0.0f, 1.0f, 0.0f)));
  EXPECT_NE(positionBits({0, 1, 0}), positionBits({0, std::nextafter(1.0f, 2.0f), 0}));
}

TEST(PositionBits, HashesDifferInTheirUpperHalf) {
  std::set<uint32_t> hashes;
  for (int x = -8; x < 8; ++x)
    for (int y = -8; y < 8; ++y)
      for (int z = -8; z < 8; ++z) hashes.insert(uint32_t(hashOf(vec3(x, y, z)) >> 32));
  EXPECT_GE(hashes.size(), 4094u);
}

TEST(Morton, InterleavesCoordinates) {
  EXPECT_EQ(mortonCode(1, 0, 0), 1u);
  EXPECT_EQ(mortonCode(0, 1, 0), 2u);
  EXPECT_EQ(mortonCode(0, 0, 1), 4u);
  EXPECT_EQ(mortonCode(0b101, 0b011, 0b110), 0b101'110'011u);
  EXPECT_EQ(mortonCode(0x1fffff, 0x1fffff, 0x1fffff), 0x7fffffffffffffffu);
}

TEST(HalfEdges, OfAnEdgeAreTogether) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  Buffer<SortKey> keys;
  const std::span<const SortKey> all = sortHalfEdges(mesh, unwelded(mesh.vertices.size()), keys);
  ASSERT_EQ(all.size(), 36u);
  size_t edges = 0;
  forEachEdge(all, 0, all.size(), [&](std::span<const SortKey> edge) {
    ASSERT_EQ(edge.size(), 2u);
    const HalfEdge a = halfEdgeOf(edge[0]), b = halfEdgeOf(edge[1]);
    EXPECT_EQ(a.from(), b.to());
    EXPECT_EQ(a.to(), b.from());
    const uvec3& t = mesh.triangles[a.face];
    const bool isOfFace = (t.x == a.from() && t.y == a.to()) || (t.y == a.from() && t.z == a.to()) ||
                          (t.z == a.from() && t.x == a.to());
    EXPECT_TRUE(isOfFace);
    ++edges;
  });
  EXPECT_EQ(edges, 18u);
}

TEST(HalfEdges, DoNotMeetAtVerticesThatAreNotWelded) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {4, 3, 5}};
  const auto pairs = [&](const Welding& welding) {
    Buffer<SortKey> keys;
    const std::span<const SortKey> all = sortHalfEdges(mesh, welding, keys);
    size_t found = 0;
    forEachEdge(all, 0, all.size(),
                [&](std::span<const SortKey> edge) { found += edge.size() == 2 ? 1 : 0; });
    return found;
  };
  EXPECT_EQ(pairs(unwelded(6)), 0u);
  EXPECT_EQ(pairs(weldVertices(mesh.vertices)), 1u);
}

TEST(Patches, DropTheLinkOfAMoebiusStripWithTheHighestVertices) {
  // The last square has its sides swapped, so the faces at the edge from 0 to 1 disagree.
  constexpr uint32_t kSquares = 8;
  Mesh mesh;
  for (uint32_t v = 0; v < 2 * kSquares; ++v) mesh.vertices.emplace_back(v + 1, v % 2, 0);
  for (uint32_t a = 0; a < 2 * kSquares; a += 2) {
    const bool isLast = a + 2 == 2 * kSquares;
    const uint32_t c = isLast ? 1 : a + 2, d = isLast ? 0 : a + 3;
    mesh.triangles.insert(mesh.triangles.end(), {{a, c, a + 1}, {a + 1, c, d}});
  }
  const Patches patches = findPatches(Model(mesh));
  EXPECT_EQ(patches.count, 1u);
  std::vector<uint8_t> isReversed(2 * kSquares);
  isReversed[2 * kSquares - 2] = isReversed[2 * kSquares - 1] = 1;
  EXPECT_EQ(patches.isReversed, isReversed);
}

TEST(Welding, NumbersPositions) {
  const std::vector<vec3> vertices{{5, 0, 0}, {1, 0, 0}, {5, 0, -0.0f}};
  const std::vector<uvec3> faces{{0, 1, 2}};
  const Welding welding = weldVertices(vertices);
  ASSERT_EQ(welding.count, 2u);
  EXPECT_EQ(welding.ids[0], welding.ids[2]);
  EXPECT_EQ(welding.vertices()[welding.ids[0]], 2u);
  EXPECT_EQ(welding.vertices()[welding.ids[1]], 1u);
  EXPECT_EQ(weldedFace({vertices, faces, dvec3(0.0)}, welding, 0),
            uvec3(welding.ids[0], welding.ids[1], welding.ids[0]));
  EXPECT_EQ(unwelded(3).vertices(), (std::vector<uint32_t>{0, 1, 2}));
}

/// Traces directed edges. Returns the places of each loop, with its end.
std::vector<std::vector<uint32_t>> traced(const std::vector<std::pair<uint32_t, uint32_t>>& edges,
                                          const std::vector<uint32_t>& starts) {
  std::vector<bool> isUsed(edges.size());
  const auto take = [&](uint32_t& place) {
    for (uint32_t e = 0; e < edges.size(); ++e)
      if (!isUsed[e] && edges[e].first == place) {
        isUsed[e] = true;
        place = edges[e].second;
        return e;
      }
    return kNoEdge;
  };
  std::vector<std::vector<uint32_t>> loops;
  traceLoops(10, starts, take, [&](std::span<const LoopStep> steps, uint32_t end) {
    std::vector<uint32_t>& loop = loops.emplace_back();
    for (const LoopStep& step : steps) {
      EXPECT_EQ(edges[step.edge].first, step.from);
      loop.push_back(step.from);
    }
    loop.push_back(end);
  });
  return loops;
}

TEST(Loops, AreSplitOffAsSoonAsTheyClose) {
  using Loops = std::vector<std::vector<uint32_t>>;
  EXPECT_EQ(traced({{0, 1}, {1, 2}, {2, 0}}, {0, 1, 2}), (Loops{{0, 1, 2, 0}}));
  // Two loops that meet in 2.
  EXPECT_EQ(traced({{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 2}, {2, 0}}, {0}),
            (Loops{{2, 3, 4, 2}, {0, 1, 2, 0}}));
  // Two loops from one start.
  EXPECT_EQ(traced({{0, 1}, {1, 0}, {0, 2}, {2, 0}}, {0}), (Loops{{0, 1, 0}, {0, 2, 0}}));
  // A loop in a chain.
  EXPECT_EQ(traced({{0, 1}, {1, 2}, {2, 1}, {1, 3}}, {0}), (Loops{{1, 2, 1}, {0, 1, 3}}));
  EXPECT_EQ(traced({{0, 1}}, {5, 1}), Loops{});
}

TEST(PartVolumes, AreSignedAndApart) {
  const Mesh cubes = shapes::joined(shapes::box({0, 0, 0}, {2, 2, 2}),
                                    shapes::inverted(shapes::box({9, 9, 9}, {10, 10, 13})));
  std::vector<uint32_t> parts(24, 2);
  std::fill(parts.begin() + 12, parts.end(), 0);
  const std::vector<double> volumes = partVolumes(cubes, parts, 3);
  ASSERT_EQ(volumes.size(), 3u);
  EXPECT_NEAR(volumes[0], -4.0, 1e-5);
  EXPECT_EQ(volumes[1], 0.0);
  EXPECT_NEAR(volumes[2], 8.0, 1e-5);
}

TEST(Compact, RemovesVerticesThatNoFaceUses) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  mesh.triangles = {{4, 1, 3}, {3, 1, 4}};
  removeUnusedVertices(mesh);
  EXPECT_EQ(mesh.vertices, (std::vector<vec3>{{1, 0, 0}, {3, 0, 0}, {4, 0, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<uvec3>{{2, 0, 1}, {1, 0, 2}}));
}

TEST(Compact, WeldsVerticesAtOnePosition) {
  Mesh mesh;
  mesh.vertices = {{5, 0, 0}, {1, 0, 0}, {5, 0, -0.0f}, {7, 0, 0}, {2, 0, 0}, {1, 0, 0}};
  mesh.triangles = {{0, 1, 4}, {2, 4, 5}};
  mesh.origin = {1, 2, 3};
  const Mesh welded = weldedCopy(Model(mesh));
  EXPECT_EQ(welded.vertices, (std::vector<vec3>{{5, 0, 0}, {1, 0, 0}, {7, 0, 0}, {2, 0, 0}}));
  EXPECT_EQ(welded.triangles, (std::vector<uvec3>{{0, 1, 3}, {0, 3, 1}}));
  EXPECT_EQ(welded.origin, mesh.origin);
}

}  // namespace
}  // namespace raymap
