#include "cpu/distance/surface_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "broken_meshes.h"
#include "cells.h"
#include "cpu/backend.h"
#include "mesh/double_sided.h"
#include "method/pipeline.h"
#include "method/turns.h"
#include "shapes.h"

namespace raymap {

using namespace cpu;
namespace {

constexpr double kAllowed = 1e-6;  // The meshes are about 1 large.

OwnCellMesh cellsOf(const Mesh& mesh) {
  return {mesh, Grid{{20, 20, 20}, glm::dvec3(0.0), 1.0}};
}

glm::dvec3 vectorOf(const float* x, const float* y, const float* z, uint32_t lane) {
  return {x[lane], y[lane], z[lane]};
}

/// A mesh, and the same converted to cell units as a run does it.
struct CellMeshOf {
  Mesh mesh;
  CellMesh cells = {};

  explicit CellMeshOf(Mesh given) : mesh(std::move(given)) {
    toCellUnits(mesh, Grid{{20, 20, 20}, glm::dvec3(-0.3, 0.1, 0.7), 0.13}, cells);
  }
};

/// Returns the distance of a point from the disc of a node; 0 inside.
double discDistance(const SurfaceTree& tree, uint32_t node, const glm::dvec3& p) {
  const DiscPacket& discs = tree.discs(node / kPacket);
  const uint32_t lane = node % kPacket;
  const glm::dvec3 q = p - vectorOf(discs.cx, discs.cy, discs.cz, lane),
                   normal = vectorOf(discs.nx, discs.ny, discs.nz, lane);
  const double height = glm::dot(q, normal);
  const double beside = glm::length(q - height * normal) - double(discs.radius[lane]);
  return std::max({beside, std::abs(height) - double(discs.halfThickness[lane]), 0.0});
}

glm::dvec3 normalOf(const SurfaceTree& tree, uint32_t t) {
  const TrianglePacket& packet = tree.triangles(t / kPacket);
  return vectorOf(packet.zx, packet.zy, packet.zz, t % kPacket);
}

/// Returns the corners a, b and c of triangle `t` of the tree, computed from its frame.
std::vector<glm::dvec3> cornersOf(const SurfaceTree& tree, uint32_t t) {
  const TrianglePacket& packet = tree.triangles(t / kPacket);
  const uint32_t lane = t % kPacket;
  const glm::dvec3 a = vectorOf(packet.ax, packet.ay, packet.az, lane),
                   x = vectorOf(packet.xx, packet.xy, packet.xz, lane),
                   y = vectorOf(packet.yx, packet.yy, packet.yz, lane);
  return {a, a + double(packet.bx[lane]) * x, a + double(packet.cx[lane]) * x + double(packet.cy[lane]) * y};
}

/// Visits the tree from its root to its triangles and checks every node on the way.
class Walk {
 public:
  Walk(const SurfaceTree& tree, const CellMesh& mesh, const std::vector<uint32_t>& removed = {})
      : tree_(tree), mesh_(mesh), seen_(mesh.triangles.size()) {
    visit(tree.root(), tree.levels().size() - 1);
    std::vector<int> expected(mesh.triangles.size(), 1);
    for (const uint32_t triangle : removed) expected[triangle] = 0;
    EXPECT_EQ(seen_, expected) << "each triangle is in one leaf";
  }

 private:
  void visit(uint32_t node, size_t level) {
    path_.push_back(node);
    ASSERT_EQ(tree_.isLeaf(node), level == 0);
    if (level == 0) {
      visitLeaf(node);
    } else {
      const SurfaceTree::Level below = tree_.levels()[level - 1];
      const uint32_t first = tree_.childPacket(node) * kPacket;
      for (uint32_t child = first; child < first + kPacket; ++child)
        if (child < below.start + below.count)
          visit(child, level - 1);
        else
          EXPECT_GT(discDistance(tree_, child, glm::dvec3(0.0)), 1e10) << "no node is there";
    }
    path_.pop_back();
  }

  void visitLeaf(uint32_t leaf) {
    const uint32_t first = tree_.childPacket(leaf) * kPacket;
    for (uint32_t t = first; t < first + kPacket; ++t) {
      const uint32_t id = tree_.triangleId(t);
      ASSERT_LT(id, seen_.size());
      if (t < tree_.triangleCount()) ++seen_[id];  // The others repeat a triangle to fill the last leaf.
      expectSameTriangle(t, id);
      for (int corner = 0; corner < 3; ++corner)
        for (const uint32_t node : path_)
          EXPECT_LT(discDistance(tree_, node, glm::dvec3(mesh_.corner(id, corner))), kAllowed)
              << "triangle " << id << ", node " << node;
    }
  }

  /// Checks for the same corners in the same winding order, whichever comes first.
  void expectSameTriangle(uint32_t t, uint32_t id) {
    const std::vector<glm::dvec3> corners = cornersOf(tree_, t);
    double closest = INFINITY;
    for (int first = 0; first < 3; ++first) {
      double farthest = 0.0;
      for (int c = 0; c < 3; ++c)
        farthest = std::max(farthest,
                            glm::distance(corners[size_t(c)], glm::dvec3(mesh_.corner(id, (first + c) % 3))));
      closest = std::min(closest, farthest);
    }
    EXPECT_LT(closest, kAllowed) << "triangle " << id;
  }

  const SurfaceTree& tree_;
  const CellMesh& mesh_;
  std::vector<int> seen_;
  std::vector<uint32_t> path_;  ///< Nodes from the root to the current one.
};

void expectSound(const Mesh& mesh) {
  SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles");
  const OwnCellMesh cells = cellsOf(mesh);
  SurfaceTree tree;
  tree.build(cells);
  ASSERT_EQ(tree.triangleCount(), mesh.triangles.size());
  ASSERT_EQ(tree.leafCount(), (mesh.triangles.size() + kPacket - 1) / kPacket);
  for (const SurfaceTree::Level& level : tree.levels()) ASSERT_EQ(level.start % kPacket, 0u);
  ASSERT_EQ(tree.levels().back().count, 1u);
  Walk(tree, cells);
}

TEST(SurfaceTree, HoldsEveryTriangleOnceInDiscsThatBoundIt) {
  for (const int count : {1, 7, 8, 9, 64, 65, 511, 513, 4097, 5000})
    expectSound(shapes::soup(count, static_cast<unsigned>(count)));
  expectSound(shapes::sphere(1.0, 4));
  expectSound(shapes::torus(1.0, 0.3, 80, 40));
}

TEST(SurfaceTree, HoldsDegenerateAndEqualTriangles) {
  const std::vector<glm::dvec3> line{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
  expectSound(makeMesh(line, {{0, 1, 2}, {0, 0, 0}, {1, 2, 1}, {2, 2, 2}, {0, 1, 2}}));
  expectSound(makeMesh(line, std::vector<glm::uvec3>(100, {0, 1, 2})));
}

TEST(SurfaceTree, HoldsOneFaceOfEachDoubleSidedGroup) {
  Mesh mesh = withDoubledFaces(shapes::sphere(1.0, 5), 0.3, 1);
  for (glm::uvec3& t : mesh.triangles)  // The corners begin anywhere.
    if (t.x % 3 == 0) t = {t.y, t.z, t.x};
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(2));
  SurfaceTree tree;
  CellMesh cells;
  toCellUnits(mesh, Grid{{20, 20, 20}, glm::dvec3(0.0), 1.0}, cells);
  const DoubleSidedFaces found = tree.buildSingleSided(cells);
  const DoubleSidedFaces expected = findDoubleSidedFaces(mesh);
  EXPECT_GT(expected.firsts.size(), 5000u);
  EXPECT_EQ(found.firsts, expected.firsts);
  EXPECT_EQ(found.others, expected.others);
  EXPECT_EQ(found.groupOf, expected.groupOf);
  ASSERT_EQ(tree.triangleCount(), mesh.triangles.size() - expected.others.size());
  ASSERT_EQ(tree.leafCount(), (tree.triangleCount() + kPacket - 1) / kPacket);
  Walk(tree, cells, expected.others);
}

TEST(SurfaceTree, IsBuiltAnewForAnotherMesh) {
  SurfaceTree tree;
  tree.build(cellsOf(shapes::soup(5000, 1)));
  const OwnCellMesh cells = cellsOf(shapes::soup(70, 2));
  tree.build(cells);
  Walk(tree, cells);
}

TEST(SurfaceTree, TurnsTheNormalsOfSomeFaces) {
  const Mesh mesh = shapes::soup(100, 3);
  SurfaceTree tree;
  tree.build(cellsOf(mesh));
  std::vector<glm::dvec3> before;
  for (uint32_t t = 0; t < tree.triangleCount(); ++t) {
    before.push_back(normalOf(tree, t));
    const std::vector<glm::dvec3> p = cornersOf(tree, t);
    EXPECT_GT(glm::dot(before[t], glm::cross(p[1] - p[0], p[2] - p[0])), 0.0) << "as the corners turn";
  }
  std::vector<uint8_t> faces(mesh.triangles.size());
  for (size_t f = 0; f < faces.size(); f += 3) faces[f] = kReversed;
  tree.turn(faces);
  for (uint32_t t = 0; t < tree.triangleCount(); ++t)
    EXPECT_EQ(normalOf(tree, t), faces[tree.triangleId(t)] ? -before[t] : before[t]) << t;
  tree.turn({});
  tree.turn(faces);
  for (uint32_t t = 0; t < tree.triangleCount(); ++t) EXPECT_EQ(normalOf(tree, t), before[t]) << t;
  for (size_t f = 0; f < faces.size(); f += 3) faces[f] = kLeftOut;
  tree.turn(faces);
  for (uint32_t t = 0; t < tree.triangleCount(); ++t)
    EXPECT_EQ(normalOf(tree, t), faces[tree.triangleId(t)] ? glm::dvec3(0.0) : before[t]) << t;
}

TEST(SurfaceTree, KnowsWhatItWillHold) {
  for (const int count : {1, 8, 9, 64, 65, 513, 5000})
    for (const Frames frames : {Frames::Stored, Frames::Made}) {
      const CellMeshOf cells(shapes::soup(count, 1));
      SurfaceTree tree;
      tree.build(cells.cells, frames);
      // It frees the keys itself if frames are made.
      const size_t freed = frames == Frames::Made ? tree.leafCount() * kPacket * sizeof(uint64_t) : 0;
      EXPECT_EQ(tree.bytes() + freed, SurfaceTree::bytesNeeded(size_t(count), frames)) << count;
    }
  EXPECT_EQ(SurfaceTree::bytesNeeded(8000) - SurfaceTree::bytesNeeded(8000, Frames::Made), 8000u * 68);
}

/// Checks that two trees have the same triangles, to the last bit.
void expectSameFrames(const SurfaceTree& made, const SurfaceTree& stored) {
  ASSERT_EQ(made.triangleCount(), stored.triangleCount());
  ASSERT_EQ(made.leafCount(), stored.leafCount());
  const auto bitsOf = [](const TrianglePacket& packet, uint32_t lane) {
    std::vector<uint32_t> bits;
    for (const auto* field : {packet.ax, packet.ay, packet.az, packet.xx, packet.xy, packet.xz, packet.yx,
                              packet.yy, packet.yz, packet.zx, packet.zy, packet.zz, packet.bx, packet.cx,
                              packet.cy, packet.inverseBc2, packet.inverseCa2})
      bits.push_back(std::bit_cast<uint32_t>(field[lane]));
    bits.push_back(packet.id[lane]);
    return bits;
  };
  for (uint32_t t = 0; t < stored.triangleCount(); ++t) {
    ASSERT_EQ(bitsOf(made.triangles(t / kPacket), t % kPacket),
              bitsOf(stored.triangles(t / kPacket), t % kPacket))
        << t;
    ASSERT_EQ(made.triangleId(t), stored.triangleId(t)) << t;
  }
}

TEST(SurfaceTree, MakesTheFramesThatItDoesNotStore) {
  // The large mesh has more leaves than a thread keeps frames of.
  std::vector<std::unique_ptr<CellMeshOf>> meshes;
  for (const int count : {1, 9, 500, 20000})
    meshes.push_back(std::make_unique<CellMeshOf>(shapes::soup(count, unsigned(count))));
  std::vector<SurfaceTree> made(meshes.size()), stored(meshes.size());
  for (size_t m = 0; m < meshes.size(); ++m) {
    made[m].build(meshes[m]->cells, Frames::Made);
    stored[m].build(meshes[m]->cells);
    EXPECT_LT(made[m].bytes(), stored[m].bytes());
  }
  for (size_t m = 0; m < meshes.size(); ++m) expectSameFrames(made[m], stored[m]);  // Mixed with each other.
  for (size_t m = meshes.size(); m-- > 0;) expectSameFrames(made[m], stored[m]);

  std::vector<uint8_t> turns(20000);
  for (size_t f = 0; f < turns.size(); ++f) turns[f] = std::array{kAsGiven, kReversed, kLeftOut}[f % 3];
  made[3].turn(turns);
  stored[3].turn(turns);
  expectSameFrames(made[3], stored[3]);

  const SurfaceTree moved = std::move(made[2]);
  made[2].build(meshes[3]->cells, Frames::Made);  // Its leaves have the numbers of the moved ones.
  stored[3].build(meshes[3]->cells);
  expectSameFrames(made[2], stored[3]);
  expectSameFrames(moved, stored[2]);
}

struct RunResult {
  Field field;
  size_t bytes;
};

RunResult run(const Mesh& mesh, const Grid& grid, std::optional<Frames> frames) {
  const FieldOptions options{.triangle = true, .winding = true, .confidence = true};
  Progress progress;
  RunResult result;
  const Model model(mesh);
  cpu::Backend backend;
  backend.setJob({model, grid, options, progress, result.field}, frames);
  runPipeline(backend);
  result.bytes = backend.bytes();
  return result;
}

TEST(SurfaceTree, ChangesNoFieldByWhereItHasItsFrames) {
  const Mesh large = shapes::sphere(1.0, 5), ball = shapes::sphere(1.0, 4);
  for (const Mesh& mesh : {large, withHoles(ball, 5, 0.2, 1), withFlippedFaces(ball, 0.3, 1),
                           withDoubledFaces(ball, 1.0, 2), shapes::soup(3000, 1)}) {
    SCOPED_TRACE(testing::Message() << mesh.triangles.size() << " triangles");
    for (const int resolution : {8, 40}) {
      const Grid grid = fitGrid(mesh, {.resolution = resolution});
      const RunResult made = run(mesh, grid, Frames::Made), stored = run(mesh, grid, Frames::Stored),
                      chosen = run(mesh, grid, {});
      for (const RunResult* other : {&stored, &chosen}) {
        EXPECT_TRUE(std::ranges::equal(made.field.distance, other->field.distance));
        EXPECT_TRUE(std::ranges::equal(made.field.triangle, other->field.triangle));
        EXPECT_TRUE(std::ranges::equal(made.field.winding, other->field.winding));
        EXPECT_TRUE(std::ranges::equal(made.field.confidence, other->field.confidence));
      }
      EXPECT_LT(made.bytes, stored.bytes);
      EXPECT_EQ(chosen.bytes, resolution == 8 ? made.bytes : stored.bytes) << "few samples read few frames";
    }
  }
}

TEST(SurfaceTree, MakesTheFramesOfOneFaceOfEachGroup) {
  const CellMeshOf mesh(withDoubledFaces(shapes::sphere(1.0, 4), 0.3, 1));
  SurfaceTree made, stored;
  made.buildSingleSided(mesh.cells, Frames::Made);
  stored.buildSingleSided(mesh.cells);
  EXPECT_LT(made.triangleCount(), mesh.mesh.triangles.size());
  expectSameFrames(made, stored);
}

}  // namespace
}  // namespace raymap
