// Finds the faces that cross, with a tree of boxes and integer predicates.

#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "mesh/packed_mesh.h"

namespace raymap {

namespace {

using Point = glm::i64vec3;

constexpr int kBits = 29;                    // |coordinate| <= 2^29: determinants fit into 128 bits
constexpr int64_t kNear = int64_t{1} << 20;  // determinants of differences below this fit into 64 bits
constexpr uint32_t kArity = 8;               // faces per leaf, and children per node
constexpr size_t kLeavesPerRound = 64;
// Limits on the work: in a mesh whose faces all lie on each other, every pair must be tested.
constexpr size_t kMostTestsOfLeaf = size_t{1} << 18, kMostTests = size_t{1} << 25, kMostTestsPerFace = 64;

struct Box3 {
  glm::ivec3 low{INT32_MAX}, high{INT32_MIN};

  void add(const Box3& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool meets(const Box3& other) const {
    return (low.x <= other.high.x) & (other.low.x <= high.x) & (low.y <= other.high.y) &
           (other.low.y <= high.y) & (low.z <= other.high.z) & (other.low.z <= high.z);
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
  const Point u = Point(b) - Point(a), v = Point(c) - Point(a), w = Point(p) - Point(a);
  const Point most = glm::max(glm::max(glm::abs(u), glm::abs(v)), glm::abs(w));
  __extension__ using Int128 = __int128;
  return std::max({most.x, most.y, most.z}) < kNear ? determinantSign<int64_t>(u, v, w)
                                                    : determinantSign<Int128>(u, v, w);
}

using Sides = std::array<int, 3>;

/// Returns the sides of the plane of `b` on which the corners of `a` lie.
Sides sidesOf(const Face& a, const Face& b) {
  const auto& [p, q, r] = b.corners;
  return {side(p, q, r, a.corners[0]), side(p, q, r, a.corners[1]), side(p, q, r, a.corners[2])};
}

bool areOnBoth(const Sides& sides) {
  const auto [least, most] = std::minmax({sides[0], sides[1], sides[2]});
  return least < 0 && most > 0;
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

bool shareAnEdge(const Face& a, const Face& b) {
  int shared = 0;
  for (const glm::ivec3& corner : a.corners)
    shared += std::find(b.corners.begin(), b.corners.end(), corner) != b.corners.end() ? 1 : 0;
  return shared >= 2;
}

/// Returns whether inner points of both faces coincide, except in a common plane. Each face must reach
/// through the other's plane, and their intervals on the planes' common line must overlap (Guigue & Devillers
/// 2003).
bool cross(const Face& a, const Face& b) {
  if (shareAnEdge(a, b)) return false;
  const Sides ofA = sidesOf(a, b);
  if (!areOnBoth(ofA)) return false;
  const Sides ofB = sidesOf(b, a);
  if (!areOnBoth(ofB)) return false;
  auto [p, q, r] = fromAlone(a, ofA);
  auto [s, t, u] = fromAlone(b, ofB);
  if (aloneOn(ofA) < 0) std::swap(t, u);
  if (aloneOn(ofB) < 0) std::swap(q, r);
  return side(p, q, s, t) < 0 && side(p, r, u, s) < 0;
}

/// Returns the faces with their corners on a lattice of 2^29 to 2^30 steps along the longest side. Steps are
/// powers of two, so most single-precision numbers lie on the lattice and faces that touch still do.
std::vector<Face> snapFaces(const PackedMesh& mesh) {
  const Box box = bounds(mesh);
  const glm::dvec3 size = box.size();
  int exponent = 0;
  std::frexp(0.5 * std::max({size.x, size.y, size.z}), &exponent);
  const double scale = std::ldexp(1.0, kBits - exponent);
  const glm::dvec3 centre = glm::round((box.centre() - mesh.origin) * scale);
  std::vector<Face> faces(mesh.triangles.size());
  parallelFor(faces.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      faces[f].id = uint32_t(f);
      for (int c = 0; c < 3; ++c) {
        const glm::dvec3 p = scale * glm::dvec3(mesh.vertices[mesh.triangles[f][c]]);
        faces[f].corners[size_t(c)] = glm::ivec3(glm::round(p) - centre);
      }
    }
  });
  return faces;
}

/// Spreads 21 bits, with two zeros between each.
uint64_t spread(uint32_t v) {
  uint64_t x = v & 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Sorts faces along a space-filling curve through their middles.
void sortFaces(std::vector<Face>& faces) {
  std::vector<std::pair<uint64_t, uint32_t>> order(faces.size());
  parallelFor(faces.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const Box3 box = faces[f].box();
      const glm::uvec3 middle((Point(box.low) + Point(box.high) + Point(int64_t{2} << kBits)) >>
                              int64_t{kBits + 2 - 21});
      order[f] = {spread(middle.x) | spread(middle.y) << 1 | spread(middle.z) << 2, uint32_t(f)};
    }
  });
  parallelSort(order.begin(), order.end());
  std::vector<Face> sorted(faces.size());
  for (size_t f = 0; f < faces.size(); ++f) sorted[f] = faces[order[f].second];
  faces.swap(sorted);
}

/// Tree of bounding boxes: each leaf's box holds eight faces, each node's box holds eight boxes.
class BoxTree {
 public:
  explicit BoxTree(std::span<const Face> faces) {
    std::vector<Box3> boxes(faces.size());
    parallelFor(faces.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) boxes[f] = faces[f].box();
    });
    levels_.push_back(std::move(boxes));
    while (levels_.back().size() > 1) levels_.push_back(around(levels_.back()));
  }

  size_t leafCount() const { return levels_.size() > 1 ? levels_[1].size() : 0; }
  const Box3& face(size_t f) const { return levels_[0][f]; }

  /// Calls `work(face)` for the faces from `first` on whose boxes meet `box`.
  template <class Work>
  void forEachMeeting(const Box3& box, size_t first, Work&& work) const {
    descend(levels_.size() - 1, 0, box, first, work);
  }

 private:
  static std::vector<Box3> around(const std::vector<Box3>& below) {
    std::vector<Box3> boxes((below.size() + kArity - 1) / kArity);
    for (size_t b = 0; b < below.size(); ++b) boxes[b / kArity].add(below[b]);
    return boxes;
  }

  template <class Work>
  void descend(size_t level, size_t node, const Box3& box, size_t first, Work& work) const {
    if (!levels_[level][node].meets(box)) return;
    if (level == 0) {
      if (node >= first) work(node);
      return;
    }
    const size_t end = std::min((node + 1) * kArity, levels_[level - 1].size());
    const size_t skipped = first >> 3 * (level - 1);  // Lower children hold only faces before `first`.
    for (size_t child = std::max(node * kArity, skipped); child < end; ++child)
      descend(level - 1, child, box, first, work);
  }

  std::vector<std::vector<Box3>> levels_;  // faces, leaves, ..., root
};
static_assert(kArity == 8);

/// Crossings found for the faces of one leaf. Each pair is found at its first face.
struct LeafResult {
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  size_t tests = 0;
};

void searchLeaf(std::span<const Face> faces, const BoxTree& tree, size_t leaf, LeafResult& result) {
  for (size_t f = leaf * kArity; f < std::min((leaf + 1) * kArity, faces.size()); ++f)
    tree.forEachMeeting(tree.face(f), f + 1, [&](size_t other) {
      if (result.tests >= kMostTestsOfLeaf) return;
      ++result.tests;
      if (cross(faces[f], faces[other])) result.pairs.emplace_back(faces[f].id, faces[other].id);
    });
}

}  // namespace

SelfIntersections findSelfIntersections(const MeshView& view) {
  validate(view);
  MeshPacker packer;
  std::vector<Face> faces = snapFaces(packer.pack(view));
  sortFaces(faces);
  const BoxTree tree(faces);
  SelfIntersections found;
  std::vector<bool> isCrossed(faces.size());
  const size_t most = std::max(kMostTests, kMostTestsPerFace * faces.size());
  size_t tests = 0;
  for (size_t first = 0; first < tree.leafCount(); first += kLeavesPerRound) {
    if (tests >= most) {
      found.isComplete = false;
      break;
    }
    std::vector<LeafResult> results(std::min(kLeavesPerRound, tree.leafCount() - first));
    parallelFor(results.size(), 4, [&](size_t begin, size_t end) {
      for (size_t r = begin; r < end; ++r) searchLeaf(faces, tree, first + r, results[r]);
    });
    for (const LeafResult& result : results) {
      tests += result.tests;
      found.isComplete = found.isComplete && result.tests < kMostTestsOfLeaf;
      found.pairs += result.pairs.size();
      for (const auto& [a, b] : result.pairs) isCrossed[a] = isCrossed[b] = true;
    }
  }
  for (uint32_t face = 0; face < isCrossed.size(); ++face)
    if (isCrossed[face]) found.faces.push_back(face);
  return found;
}

}  // namespace raymap
