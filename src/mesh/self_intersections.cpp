// Finds the faces that cross, with a tree of boxes and integer predicates.

#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/sort_keys.h"
#include "mesh/packed_mesh.h"

namespace raymap {

namespace {

using Point = glm::i64vec3;

constexpr int kBits = 29;                     // |coordinate| <= 2^29: determinants fit into 128 bits
constexpr int32_t kSmall = int32_t{1} << 19;  // determinants of faces below this that meet fit into 64 bits
constexpr uint32_t kArity = 8;                // faces per leaf, and children per node
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
    return std::max({size.x, size.y, size.z}) < kSmall;
  }
};

struct Face {
  std::array<glm::ivec3, 3> corners;
  uint32_t id;

  Box3 box() const {
    return {glm::min(glm::min(corners[0], corners[1]), corners[2]),
            glm::max(glm::max(corners[0], corners[1]), corners[2])};
  }
};

template <class Wide>
int determinantSign(const Point& a, const Point& b, const Point& c) {
  const auto minor = [](int64_t p, int64_t q, int64_t r, int64_t s) { return Wide(p) * s - Wide(q) * r; };
  const Wide value =
      minor(b.y, b.z, c.y, c.z) * a.x - minor(b.x, b.z, c.x, c.z) * a.y + minor(b.x, b.y, c.x, c.y) * a.z;
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// Returns the side of the plane abc on which p lies: -1, 0 or 1.
int side(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& c, const glm::ivec3& p) {
  __extension__ using Int128 = __int128;
  return determinantSign<Int128>(Point(b) - Point(a), Point(c) - Point(a), Point(p) - Point(a));
}

using Sides = std::array<int, 3>;

/// Plane of a face. The normal's components fit into 63 bits.
struct Plane {
  explicit Plane(const Face& face) : point(face.corners[0]) {
    const Point u = Point(face.corners[1]) - point, v = Point(face.corners[2]) - point;
    normal = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  }

  /// Returns the sides on which the corners of a face lie: -1, 0 or 1. `Wide` must hold the determinants.
  template <class Wide>
  Sides sidesOf(const Face& face) const {
    Sides sides;
    for (size_t c = 0; c < 3; ++c) {
      const Point w = Point(face.corners[c]) - point;
      const Wide value = Wide(normal.x) * w.x + Wide(normal.y) * w.y + Wide(normal.z) * w.z;
      sides[c] = int(value > 0) - int(value < 0);
    }
    return sides;
  }
  Sides sidesOf(const Face& face, bool areSmall) const {
    __extension__ using Int128 = __int128;
    return areSmall ? sidesOf<int64_t>(face) : sidesOf<Int128>(face);
  }

  Point point, normal;
};

bool areOnBoth(const Sides& sides) {
  return std::min(std::min(sides[0], sides[1]), sides[2]) < 0 &&
         std::max(std::max(sides[0], sides[1]), sides[2]) > 0;
}

/// Returns the side on which one corner is alone.
int aloneOn(const Sides& sides) {
  return sides[0] + sides[1] + sides[2] > 0 ? -1 : 1;
}

/// Returns the face's corners in order, starting with the one that is alone on its side.
std::array<glm::ivec3, 3> fromAlone(const Face& face, const Sides& sides) {
  std::array<glm::ivec3, 3> corners = face.corners;
  const auto alone = std::find(sides.begin(), sides.end(), aloneOn(sides)) - sides.begin();
  std::rotate(corners.begin(), corners.begin() + alone, corners.end());
  return corners;
}

/// Returns whether inner points of both faces coincide, except in a common plane. Each face must reach
/// through the other's plane, and their intervals on the planes' common line must overlap (Guigue & Devillers
/// 2003). Faces that share an edge do not reach through each other's planes.
bool cross(const Face& a, const Plane& planeOfA, const Face& b, bool areSmall) {
  const Sides ofB = planeOfA.sidesOf(b, areSmall);
  if (!areOnBoth(ofB)) return false;
  const Sides ofA = Plane(b).sidesOf(a, areSmall);
  if (!areOnBoth(ofA)) return false;
  auto [p, q, r] = fromAlone(a, ofA);
  auto [s, t, u] = fromAlone(b, ofB);
  if (aloneOn(ofA) < 0) std::swap(t, u);
  if (aloneOn(ofB) < 0) std::swap(q, r);
  return side(p, q, s, t) < 0 && side(p, r, u, s) < 0;
}

/// Returns what `std::round` does, without its call.
double roundFast(double x) {
  if (!(std::abs(x) < 0x1p51)) return std::round(x);
  constexpr double kWhole = 0x1.8p52;  // Numbers of this size have no fraction.
  const double even = (x + kWhole) - kWhole, rest = x - even;
  if (rest == 0.5 && x > 0.0) return even + 1.0;
  if (rest == -0.5 && x < 0.0) return even - 1.0;
  return even;
}

/// Puts faces on a lattice of 2^29 to 2^30 steps along the longest side. Steps are powers of two, so most
/// single-precision numbers lie on the lattice and faces that touch still do.
class Lattice {
 public:
  explicit Lattice(const PackedMesh& mesh) : mesh_(mesh) {
    const Box box = bounds(mesh);
    const glm::dvec3 size = box.size();
    int exponent = 0;
    std::frexp(0.5 * std::max({size.x, size.y, size.z}), &exponent);
    scale_ = std::ldexp(1.0, kBits - exponent);
    centre_ = glm::round((box.centre() - mesh.origin) * scale_);
  }

  Face face(size_t f) const {
    Face face;
    face.id = uint32_t(f);
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3 p = scale_ * glm::dvec3(mesh_.vertices[mesh_.triangles[f][c]]);
      const glm::dvec3 whole(roundFast(p.x), roundFast(p.y), roundFast(p.z));
      face.corners[size_t(c)] = glm::ivec3(whole - centre_);
    }
    return face;
  }

 private:
  const PackedMesh& mesh_;
  double scale_;
  glm::dvec3 centre_;
};

/// Spreads 21 bits, with two zeros between each.
uint64_t spread(uint32_t v) {
  uint64_t x = v & 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Returns the faces along a space-filling curve through their middles.
Buffer<Face> sortedFaces(const PackedMesh& mesh) {
  const Lattice lattice(mesh);
  const auto make = [&](size_t begin, size_t end, SortKey* to) {
    for (size_t f = begin; f < end; ++f) {
      const Box3 box = lattice.face(f).box();
      const glm::uvec3 middle((Point(box.low) + Point(box.high) + Point(int64_t{2} << kBits)) >>
                              int64_t{kBits + 2 - 21});
      *to++ = {f, spread(middle.x) | spread(middle.y) << 1 | spread(middle.z) << 2};
    }
  };
  Buffer<SortKey> order;
  sortKeys(mesh.triangles.size(), make, order);
  Buffer<Face> faces(order.size());
  parallelFor(faces.size(), kFacesPerTask, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) faces[f] = lattice.face(order[f].low);
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
    levels_.push_back(packets(faces.size(), [&](size_t f) { return faces[f].box(); }));
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

/// Crossings found for the faces of some leaves. Each pair is found at its first face.
struct LeafResult {
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  size_t tests = 0;
  bool isComplete = true;
};

/// Tests the faces of one leaf against later faces. Returns the number of tests.
size_t searchLeaf(std::span<const Face> faces, const BoxTree& tree, size_t leaf, std::vector<uint32_t>& near,
                  std::vector<std::pair<uint32_t, uint32_t>>& pairs) {
  near.clear();
  tree.findLeaves(tree.leaf(leaf).boxOfAll(), leaf, near);
  size_t tests = 0;
  for (size_t f = leaf * kArity; f < std::min((leaf + 1) * kArity, faces.size()); ++f) {
    const Box3 box = tree.leaf(leaf).box(f % kArity);
    const Plane plane(faces[f]);
    const bool isSmall = box.isSmall();
    for (const size_t other : near) {
      uint32_t bits = tree.leaf(other).meeting(box);
      if (other == leaf) bits &= ~1u << f % kArity;
      for (; bits != 0; bits &= bits - 1) {
        if (tests == kMostTestsOfLeaf) return tests;
        ++tests;
        const size_t g = other * kArity + size_t(std::countr_zero(bits));
        const bool areSmall = isSmall && tree.leaf(other).box(g % kArity).isSmall();
        if (cross(faces[f], plane, faces[g], areSmall)) pairs.emplace_back(faces[f].id, faces[g].id);
      }
    }
  }
  return tests;
}

LeafResult searchLeaves(std::span<const Face> faces, const BoxTree& tree, size_t begin, size_t end) {
  LeafResult result;
  std::vector<uint32_t> near;
  for (size_t leaf = begin; leaf < end; ++leaf) {
    const size_t tests = searchLeaf(faces, tree, leaf, near, result.pairs);
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
/// not on the number of threads.
SelfIntersections searchAll(std::span<const Face> faces, const BoxTree& tree, Progress& progress) {
  SelfIntersections found;
  std::vector<bool> isCrossed(faces.size());
  const size_t most = std::max(kMostTests, kMostTestsPerFace * faces.size());
  size_t tests = 0;
  for (size_t first = 0; first < tree.leafCount();) {
    if (tests >= most) {
      found.isComplete = false;
      break;
    }
    const size_t count = std::min(roundsLeft(most - tests) * kLeavesPerRound, tree.leafCount() - first);
    std::vector<LeafResult> results((count + kLeavesPerTask - 1) / kLeavesPerTask);
    parallelFor(results.size(), 1, [&](size_t task, size_t) {
      const size_t begin = task * kLeavesPerTask, end = std::min(begin + kLeavesPerTask, count);
      results[task] = searchLeaves(faces, tree, first + begin, first + end);
    });
    for (const LeafResult& result : results) {
      tests += result.tests;
      found.isComplete = found.isComplete && result.isComplete;
      found.pairs += result.pairs.size();
      for (const auto& [a, b] : result.pairs) isCrossed[a] = isCrossed[b] = true;
    }
    first += count;
    progress.report(0.2 + 0.8 * double(first) / double(tree.leafCount()));
  }
  for (uint32_t face = 0; face < isCrossed.size(); ++face)
    if (isCrossed[face]) found.faces.push_back(face);
  return found;
}

}  // namespace

SelfIntersections findSelfIntersections(const MeshView& view, const ProgressCallback& callback) {
  validate(view);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  Progress progress(callback);
  SelfIntersections found;
  progress.stage("crossing pairs", [&] {
    const Buffer<Face> faces = sortedFaces(mesh);
    progress.report(0.15);
    const BoxTree tree(faces);
    found = searchAll(faces, tree, progress);
  });
  return found;
}

}  // namespace raymap
