// Finds the faces that cross or overlap in one plane, with a tree of boxes and exact predicates.

#include "mesh/self_intersections.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "base/morton.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/sort_keys.h"
#include "mesh/model.h"
#include "mesh/vertex_lattice.h"
#include "predicates/triangle_triangle.h"

namespace raymap {

namespace {

using Point = glm::i64vec3;

constexpr uint32_t kArity = 8;  // Faces per leaf, and children per node.
constexpr size_t kLeavesPerRound = 64, kLeavesPerTask = 16;
constexpr size_t kMostRoundsPerBatch = 256;
constexpr size_t kFacesPerTask = 4096;
// Limits on the work: in a mesh whose faces all lie on each other, every pair must be tested.
constexpr size_t kMostTestsOfLeaf = size_t{1} << 18, kMostTests = size_t{1} << 25, kMostTestsPerFace = 64;

struct Box3 {
  glm::ivec3 low{INT32_MAX}, high{INT32_MIN};

  void add(const Box3& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool isSmall() const {
    const glm::ivec3 size = high - low;
    return std::max({size.x, size.y, size.z}) < kSmallExtent;
  }
};

struct Face {
  WholeTriangle corners;
  uint32_t id;
};

Box3 boxOf(const WholeTriangle& t) {
  return {glm::min(glm::min(t[0], t[1]), t[2]), glm::max(glm::max(t[0], t[1]), t[2])};
}

/// Returns the faces along a space-filling curve through their middles.
Buffer<Face> sortedFaces(const PackedMesh& mesh) {
  const VertexLattice lattice(mesh);
  const auto make = [&](size_t begin, size_t end, SortKey* to) {
    for (size_t f = begin; f < end; ++f) {
      const Box3 box = boxOf(lattice.face(f));
      const glm::uvec3 middle((Point(box.low) + Point(box.high) + Point(int64_t{2} << kTriangleBits)) >>
                              int64_t{kTriangleBits + 2 - 21});
      *to++ = {f, mortonCode(middle.x, middle.y, middle.z)};
    }
  };
  Buffer<SortKey> order;
  sortKeys(mesh.triangles.size(), make, order);
  Buffer<Face> faces(order.size());
  parallelFor(faces.size(), kFacesPerTask, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) faces[f] = {lattice.face(order[f].low), uint32_t(order[f].low)};
  });
  return faces;
}

/// The boxes of a node's children, laid out for SIMD.
struct BoxPacket {
  std::array<std::array<int32_t, kArity>, 3> low, high;

  void set(size_t child, const Box3& box) {
    for (int c = 0; c < 3; ++c) {
      low[size_t(c)][child] = box.low[c];
      high[size_t(c)][child] = box.high[c];
    }
  }
  Box3 box(size_t child) const {
    return {{low[0][child], low[1][child], low[2][child]}, {high[0][child], high[1][child], high[2][child]}};
  }
  Box3 boxOfAll() const {
    Box3 all;
    for (size_t child = 0; child < kArity; ++child) all.add(box(child));
    return all;
  }
  /// Returns a bit for each child whose box meets this one.
  uint32_t meeting(const Box3& box) const {
    constexpr Lanes kFirst{1, 2, 4, 8}, kSecond{16, 32, 64, 128};
    const Lanes bits = (~missing(box, 0) & kFirst) | (~missing(box, 4) & kSecond);
    return uint32_t(bits[0] | bits[1] | bits[2] | bits[3]);
  }

 private:
  using Lanes [[gnu::vector_size(16)]] = int32_t;

  Lanes missing(const Box3& box, size_t child) const {
    Lanes miss{};
    for (size_t c = 0; c < 3; ++c) {
      Lanes least, most;
      std::memcpy(&least, low[c].data() + child, sizeof least);
      std::memcpy(&most, high[c].data() + child, sizeof most);
      miss |= (least > box.high[int(c)]) | (most < box.low[int(c)]);
    }
    return miss;
  }
};
static_assert(kArity == 8);

/// Tree of bounding boxes: each leaf has eight faces, each node has eight leaves or nodes.
class BoxTree {
 public:
  explicit BoxTree(std::span<const Face> faces) {
    levels_.push_back(packets(faces.size(), [&](size_t f) { return boxOf(faces[f].corners); }));
    while (levels_.back().size() > 1) {
      const Buffer<BoxPacket>& below = levels_.back();
      levels_.push_back(packets(below.size(), [&](size_t node) { return below[node].boxOfAll(); }));
    }
  }

  size_t leafCount() const { return levels_[0].size(); }
  const BoxPacket& leaf(size_t l) const { return levels_[0][l]; }

  /// Appends the leaves from `first` on whose boxes meet `box`, ascending.
  void findLeaves(const Box3& box, size_t first, std::vector<uint32_t>& leaves) const {
    if (leafCount() == 1)
      leaves.push_back(0);
    else
      descend(levels_.size() - 1, 0, box, first, leaves);
  }

 private:
  template <class BoxOf>
  static Buffer<BoxPacket> packets(size_t count, const BoxOf& boxOf) {
    Buffer<BoxPacket> all((count + kArity - 1) / kArity);
    parallelFor(all.size(), kFacesPerTask / kArity, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p)
        for (size_t child = 0; child < kArity; ++child)
          all[p].set(child, p * kArity + child < count ? boxOf(p * kArity + child) : Box3{});
    });
    return all;
  }

  void descend(size_t level, size_t node, const Box3& box, size_t first,
               std::vector<uint32_t>& leaves) const {
    const size_t skipped = first >> 3 * (level - 1);  // Lower children hold only leaves before `first`.
    for (uint32_t bits = levels_[level][node].meeting(box); bits != 0; bits &= bits - 1) {
      const size_t child = node * kArity + size_t(std::countr_zero(bits));
      if (child < skipped) continue;
      if (level == 1)
        leaves.push_back(uint32_t(child));
      else
        descend(level - 1, child, box, first, leaves);
    }
  }

  std::vector<Buffer<BoxPacket>> levels_;  // leaves, ..., root
};

/// Pairs found for the faces of some leaves. Each pair is found at its first face.
struct LeafResult {
  std::vector<FacePair> pairs;
  size_t tests = 0;
  bool isComplete = true;
};

/// Returns whether two triangles have the same corners, in any order.
bool areRepeated(const WholeTriangle& a, const WholeTriangle& b) {
  return std::ranges::all_of(a, [&](const glm::ivec3& p) { return std::ranges::find(b, p) != b.end(); });
}

/// Tests the faces of one leaf against later faces. Returns the number of tests.
template <bool kTouching>
size_t searchLeaf(std::span<const Face> faces, const BoxTree& tree, size_t leaf, std::vector<uint32_t>& near,
                  std::vector<FacePair>& pairs) {
  near.clear();
  tree.findLeaves(tree.leaf(leaf).boxOfAll(), leaf, near);
  size_t tests = 0;
  for (size_t f = leaf * kArity; f < std::min((leaf + 1) * kArity, faces.size()); ++f) {
    const Box3 box = tree.leaf(leaf).box(f % kArity);
    const WholePlane plane(faces[f].corners);
    const bool isSmall = box.isSmall();
    for (const size_t other : near) {
      uint32_t bits = tree.leaf(other).meeting(box);
      if (other == leaf) bits &= ~1u << f % kArity;
      for (; bits != 0; bits &= bits - 1) {
        if (tests == kMostTestsOfLeaf) return tests;
        ++tests;
        const size_t g = other * kArity + size_t(std::countr_zero(bits));
        const bool areSmall = isSmall && tree.leaf(other).box(g % kArity).isSmall();
        const Meeting meeting = kTouching ? mayTouch(faces[f].corners, plane, faces[g].corners, areSmall)
                                          : meet(faces[f].corners, plane, faces[g].corners, areSmall);
        if (meeting == Meeting::Cross ||
            (meeting == Meeting::InPlane && (kTouching || !areRepeated(faces[f].corners, faces[g].corners))))
          pairs.push_back({faces[f].id, faces[g].id, meeting == Meeting::InPlane});
      }
    }
  }
  return tests;
}

template <bool kTouching>
LeafResult searchLeaves(std::span<const Face> faces, const BoxTree& tree, size_t begin, size_t end) {
  LeafResult result;
  std::vector<uint32_t> near;
  for (size_t leaf = begin; leaf < end; ++leaf) {
    const size_t tests = searchLeaf<kTouching>(faces, tree, leaf, near, result.pairs);
    result.tests += tests;
    result.isComplete = result.isComplete && tests < kMostTestsOfLeaf;
  }
  return result;
}

/// Returns the number of rounds that run whatever they find, and at least 1.
size_t roundsLeft(size_t testsLeft) {
  return std::clamp(testsLeft / (kLeavesPerRound * kMostTestsOfLeaf), size_t{1}, kMostRoundsPerBatch);
}

/// Searches all leaves in rounds. Whether there is another round depends on the number of tests so far, but
/// not on the number of threads. Visits all pairs in an order that does not depend on it, either. Returns
/// whether the search is complete.
template <bool kTouching>
bool searchAll(std::span<const Face> faces, const BoxTree& tree, const VisitPair& visit, Progress& progress) {
  bool isComplete = true;
  const size_t most = std::max(kMostTests, kMostTestsPerFace * faces.size());
  size_t tests = 0;
  for (size_t first = 0; first < tree.leafCount();) {
    if (tests >= most) return false;
    const size_t count = std::min(roundsLeft(most - tests) * kLeavesPerRound, tree.leafCount() - first);
    std::vector<LeafResult> results((count + kLeavesPerTask - 1) / kLeavesPerTask);
    parallelFor(results.size(), 1, [&](size_t task, size_t) {
      const size_t begin = task * kLeavesPerTask, end = std::min(begin + kLeavesPerTask, count);
      results[task] = searchLeaves<kTouching>(faces, tree, first + begin, first + end);
    });
    for (const LeafResult& result : results) {
      tests += result.tests;
      isComplete = isComplete && result.isComplete;
      for (const FacePair& pair : result.pairs) visit(pair);
    }
    first += count;
    progress.report(0.2 + 0.8 * double(first) / double(tree.leafCount()));
  }
  return isComplete;
}

std::vector<uint32_t> facesIn(const std::vector<bool>& isIn) {
  std::vector<uint32_t> faces;
  for (uint32_t face = 0; face < isIn.size(); ++face)
    if (isIn[face]) faces.push_back(face);
  return faces;
}

}  // namespace

bool forEachMeetingPair(const PackedMesh& mesh, const VisitPair& visit, Progress& progress) {
  const Buffer<Face> faces = sortedFaces(mesh);
  progress.report(0.15);
  return searchAll<false>(faces, BoxTree(faces), visit, progress);
}

bool forEachTouchingPair(const PackedMesh& mesh, const VisitPair& visit, Progress& progress) {
  const Buffer<Face> faces = sortedFaces(mesh);
  return searchAll<true>(faces, BoxTree(faces), visit, progress);
}

SelfIntersections findSelfIntersections(const MeshView& view, const MachineOptions& machine) {
  validate(view);
  const Model mesh(view);
  Progress progress(machine.progress);
  SelfIntersections found;
  std::vector<bool> isCrossed(mesh.triangles.size()), isCoplanar(mesh.triangles.size());
  const auto visit = [&](const FacePair& pair) {
    ++(pair.isInPlane ? found.coplanarPairs : found.pairs);
    std::vector<bool>& isIn = pair.isInPlane ? isCoplanar : isCrossed;
    isIn[pair.a] = isIn[pair.b] = true;
  };
  progress.stage("crossing pairs", [&] {
    withThreads(machine.threads, [&] { found.complete = forEachMeetingPair(mesh, visit, progress); });
  });
  found.faces = facesIn(isCrossed);
  found.coplanarFaces = facesIn(isCoplanar);
  return found;
}

}  // namespace raymap
