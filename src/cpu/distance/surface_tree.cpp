// Ours (the paper's future work names a hierarchy): the tree behind exact_distance.

#include "cpu/distance/surface_tree.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "cpu/distance/surface_leaves.h"
#include "method/turns.h"

namespace raymap::cpu {

/// Lattice on which centroids get their places.
class PlaceLattice {
 public:
  explicit PlaceLattice(const CellMesh& mesh) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const glm::vec3& v : mesh.vertices) {
      low = glm::min(low, v);
      high = glm::max(high, v);
    }
    // Triangles far from the grid need no fine order.
    const glm::vec3 dims(mesh.dims), nearLow = glm::max(low, -dims), nearHigh = glm::min(high, 2.0f * dims);
    if (glm::all(glm::lessThan(nearLow, nearHigh))) low = nearLow, high = nearHigh;
    const glm::vec3 size = high - low;
    scale_ = kMost / (3.0f * std::max({size.x, size.y, size.z, 1e-20f}));
    shift_ = -3.0f * low * scale_;
  }

  /// Returns the place of a triangle's centroid. It does not depend on the order of the corners.
  Place operator()(const CellMesh& mesh, size_t t) const {
    const glm::vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    const glm::vec3 low = glm::min(a, b), high = glm::max(a, b);
    const glm::vec3 thrice = glm::min(low, c) + glm::max(low, glm::min(high, c)) + glm::max(high, c);
    const glm::uvec3 p(glm::clamp(thrice * scale_ + shift_, 0.0f, kMost));
    return Place{p.x} << 48 | Place{p.y} << 32 | Place{p.z} << 16;
  }

 private:
  static constexpr float kMost = 65535.0f;
  float scale_;
  glm::vec3 shift_;
};

namespace {

constexpr size_t kGrain = 2048;
constexpr size_t kRunLeaves = kRun / kPacket;

/// Returns the position of a place along the Morton curve, with 10 bits of each axis.
uint32_t mortonIndex(Place place) {
  const auto spread = [place](int shift) {
    auto v = static_cast<uint32_t>(place >> (shift + 6)) & 0x3ffu;
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
  };
  return spread(48) << 2 | spread(32) << 1 | spread(16);
}

struct Disc {
  glm::vec3 centre, normal;
  float radius, halfThickness;
};

void writeDisc(const Disc& disc, DiscPacket& packet, uint32_t lane) {
  packet.cx[lane] = disc.centre.x, packet.cy[lane] = disc.centre.y, packet.cz[lane] = disc.centre.z;
  packet.nx[lane] = disc.normal.x, packet.ny[lane] = disc.normal.y, packet.nz[lane] = disc.normal.z;
  packet.radius[lane] = disc.radius;
  packet.halfThickness[lane] = disc.halfThickness;
}

Disc readDisc(const DiscPacket& packet, uint32_t lane) {
  return {{packet.cx[lane], packet.cy[lane], packet.cz[lane]},
          {packet.nx[lane], packet.ny[lane], packet.nz[lane]},
          packet.radius[lane],
          packet.halfThickness[lane]};
}

/// Disc that no point comes near. It fills the lanes of a packet that hold no node.
const Disc kNowhere{glm::vec3(1e15f), {0, 0, 1}, 0.0f, 0.0f};

/// Returns the corners of a leaf's triangles. `cornerOf(lane, c)` returns one in cell units.
template <class CornerOf>
CornerPacket packCorners(CornerOf&& cornerOf) {
  CornerPacket corners;
  for (uint32_t lane = 0; lane < kPacket; ++lane)
    for (int c = 0; c < 3; ++c) {
      const glm::vec3 v = cornerOf(lane, c);
      for (int axis = 0; axis < 3; ++axis) corners.v[c][axis][lane] = v[axis];
    }
  return corners;
}

/// Reverses a triangle's normal, or sets it to 0 if the face is left out.
void turnNormal(TrianglePacket& packet, uint32_t lane, uint8_t turn) {
  if (turn == kAsGiven) return;
  for (auto* normal : {packet.zx, packet.zy, packet.zz}) normal[lane] *= turn == kReversed ? -1.0f : 0.0f;
}

/// The frames that a thread made last, of any trees. Each leaf has one place.
struct MadeFrames {
  static constexpr uint32_t kPlaces = 1024;
  struct Name {
    uint64_t version;
    uint32_t leaf;
    bool operator==(const Name&) const = default;
  };
  Name names[kPlaces];
  TrianglePacket triangles[kPlaces];
};

/// Sorts the keys of a run into the order of its leaves.
void orderRun(const CellMesh& mesh, const PlaceLattice& lattice, uint64_t* keys, size_t count) {
  Place run[kRun];
  uint64_t before[kRun];
  for (size_t t = 0; t < count; ++t) {
    run[t] = lattice(mesh, static_cast<uint32_t>(keys[t])) | t;
    before[t] = keys[t];
  }
  sortRun(run, count);
  for (size_t t = 0; t < count; ++t) keys[t] = before[run[t] % kRun];
}

/// Returns the disc around points, with its normal along `normalSum`.
Disc boundPoints(const glm::vec3* points, size_t count, const glm::vec3& normalSum) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (size_t p = 0; p < count; ++p) {
    low = glm::min(low, points[p]);
    high = glm::max(high, points[p]);
  }
  const float length = glm::length(normalSum);
  const glm::vec3 normal = length > 1e-12f ? normalSum / length : glm::vec3(0, 0, 1);
  glm::vec3 centre = 0.5f * (low + high);
  float front = -INFINITY, back = INFINITY, radius2 = 0.0f;
  for (size_t p = 0; p < count; ++p) {
    const glm::vec3 q = points[p] - centre;
    const float height = glm::dot(q, normal);
    front = std::max(front, height);
    back = std::min(back, height);
    radius2 = std::max(radius2, glm::dot(q, q) - height * height);
  }
  centre += 0.5f * (front + back) * normal;
  return {centre, normal, std::sqrt(std::max(radius2, 0.0f)), 0.5f * (front - back)};
}

}  // namespace

void SurfaceTree::build(const CellMesh& mesh, Frames frames) {
  start(mesh, frames);
  const PlaceLattice lattice(mesh);
  sortTriangles(mesh, lattice);
  buildNodes(mesh, lattice);
}

DoubleSidedFaces SurfaceTree::buildSingleSided(const CellMesh& mesh, Frames frames) {
  start(mesh, frames);
  const PlaceLattice lattice(mesh);
  const std::vector<uint64_t> candidates = sortTriangles(mesh, lattice);
  DoubleSidedFaces doubleSided = findDoubleSidedFaces({mesh.given.vertices, mesh.triangles, {}}, candidates);
  if (!doubleSided.empty()) removeTriangles(doubleSided.others, mesh.triangles.size());
  buildNodes(mesh, lattice);
  return doubleSided;
}

void SurfaceTree::start(const CellMesh& mesh, Frames frames) {
  frames_ = frames;
  turns_.clear();
  changeVersion();
  if (frames == Frames::Stored) return;
  given_ = {mesh.given.vertices, mesh.triangles, mesh.given.origin};
  units_ = mesh.units;
}

void SurfaceTree::changeVersion() {
  static std::atomic<uint64_t> last{0};
  version_ = ++last;
}

const TrianglePacket& SurfaceTree::made(uint32_t leaf) const {
  thread_local const auto kept = std::make_unique<MadeFrames>();
  const uint32_t place = leaf % MadeFrames::kPlaces;
  TrianglePacket& triangles = kept->triangles[place];
  const MadeFrames::Name name{version_, leaf};
  if (kept->names[place] == name) return triangles;
  kept->names[place] = name;
  const uint32_t* ids = &ids_[size_t{leaf} * kPacket];
  makeFrames(packCorners([&](uint32_t lane, int c) {
               return units_(given_.vertices[given_.triangles[ids[lane]][c]]);
             }),
             triangles);
  for (uint32_t lane = 0; lane < kPacket; ++lane) {
    triangles.id[lane] = ids[lane];
    if (!turns_.empty()) turnNormal(triangles, lane, turns_[ids[lane]]);
  }
  return triangles;
}

void SurfaceTree::removeTriangles(std::span<const uint32_t> triangles, size_t meshTriangles) {
  std::vector<uint8_t> isRemoved(meshTriangles);
  for (const uint32_t triangle : triangles) isRemoved[triangle] = 1;
  triangleCount_ = 0;
  for (size_t k = 0; k < meshTriangles; ++k)
    if (!isRemoved[uint32_t(keys_[k])]) keys_[triangleCount_++] = keys_[k];
}

void SurfaceTree::buildNodes(const CellMesh& mesh, const PlaceLattice& lattice) {
  placeLevels();
  buildLeaves(mesh, lattice);
  for (uint32_t level = 1; level < levels_.size(); ++level) buildLevel(level);
  if (frames_ == Frames::Made) releaseScratch();
}

void SurfaceTree::placeLevels() {
  const auto packets = [](uint32_t n) { return (n + kPacket - 1) / kPacket; };
  levels_.clear();
  uint32_t start = 0;
  for (uint32_t nodes = packets(triangleCount_);; nodes = packets(nodes)) {
    levels_.push_back({start, nodes});
    start += packets(nodes) * kPacket;
    if (nodes == 1) break;
  }
  const bool areStored = frames_ == Frames::Stored;
  triangles_.resizeUninitialized(areStored ? leafCount() : 0);
  ids_.resizeUninitialized(areStored ? 0 : size_t{leafCount()} * kPacket);
  discs_.resizeUninitialized(start / kPacket);
}

size_t SurfaceTree::bytesNeeded(size_t triangles, Frames frames) {
  const auto packets = [](size_t n) { return (n + kPacket - 1) / kPacket; };
  const size_t leaves = packets(triangles);
  size_t discs = 1;  // The root's.
  for (size_t nodes = leaves; nodes > 1; nodes = packets(nodes)) discs += packets(nodes);
  const size_t ofLeaf = frames == Frames::Stored ? sizeof(TrianglePacket) : kPacket * sizeof(uint32_t);
  return leaves * (ofLeaf + kPacket * sizeof(uint64_t)) + discs * sizeof(DiscPacket);
}

void SurfaceTree::turn(std::span<const uint8_t> turns) {
  if (turns.empty()) return;
  if (frames_ == Frames::Made) {
    turns_.assign(turns.begin(), turns.end());
    changeVersion();
    return;
  }
  parallelFor(triangleCount_, size_t{1} << 14, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t)
      turnNormal(triangles_[t / kPacket], uint32_t(t % kPacket), turns[triangleId(uint32_t(t))]);
  });
}

namespace {

/// Returns what remains of a key above the triangle: its position along the curve, and below that as many
/// bits as are left of a hash of its place.
uint64_t tagOf(Place place) {
  return uint64_t{mortonIndex(place)} << 34 | (place * uint64_t{0x9E3779B97F4A7C15}) >> 30;
}

/// Removes the tags of sorted keys. Returns the triangles that share their tag with another, and so perhaps
/// their corners, each below the index of the first key with this tag.
std::vector<uint64_t> takeTags(std::span<uint64_t> keys, uint64_t tagMask) {
  std::vector<uint64_t> sameTag;
  const auto tag = [&](size_t k) { return keys[k] & tagMask; };
  size_t first = 0;
  for (size_t k = 1; k < keys.size(); ++k) {
    if (tag(k) != tag(k - 1)) {
      first = k;
      continue;
    }
    if (k == first + 1) sameTag.push_back(uint64_t{first} << 32 | (keys[first] & ~tagMask));
    sameTag.push_back(uint64_t{first} << 32 | (keys[k] & ~tagMask));
  }
  for (uint64_t& key : keys) key &= ~tagMask;
  return sameTag;
}

}  // namespace

std::vector<uint64_t> SurfaceTree::sortTriangles(const CellMesh& mesh, const PlaceLattice& lattice) {
  const size_t count = mesh.triangles.size();
  const uint64_t tagMask = ~uint64_t{0} << std::bit_width(count - 1);
  triangleCount_ = static_cast<uint32_t>(count);
  keys_.resizeUninitialized((count + kPacket - 1) / kPacket * kPacket);
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) keys_[t] = (tagOf(lattice(mesh, t)) & tagMask) | t;
  });
  hwy::Sorter()(keys_.data(), count, hwy::SortAscending());
  return takeTags({keys_.data(), count}, tagMask);
}

void SurfaceTree::buildLeaves(const CellMesh& mesh, const PlaceLattice& lattice) {
  const size_t count = triangleCount_;
  std::fill(keys_.begin() + count, keys_.begin() + size_t{leafCount()} * kPacket, keys_[count - 1]);
  parallelFor((leafCount() + kRunLeaves - 1) / kRunLeaves, 4, [&](size_t begin, size_t end) {
    for (size_t run = begin; run < end; ++run) {
      uint64_t* keys = keys_.data() + run * kRun;
      orderRun(mesh, lattice, keys, std::min(kRun, count - run * kRun));
      for (auto leaf = static_cast<uint32_t>(run * kRunLeaves); leaf < (run + 1) * kRunLeaves; ++leaf) {
        if (leaf < leafCount())
          buildLeaf(mesh, leaf);
        else if (leaf / kPacket * kPacket < leafCount())
          writeDisc(kNowhere, discs_[leaf / kPacket], leaf % kPacket);
      }
    }
  });
}

void SurfaceTree::buildLeaf(const CellMesh& mesh, uint32_t leaf) {
  const uint64_t* keys = keys_.data() + size_t{leaf} * kPacket;
  const CornerPacket corners =
      packCorners([&](uint32_t lane, int c) { return mesh.corner(static_cast<uint32_t>(keys[lane]), c); });
  boundLeaf(corners, leaf % kPacket, discs_[leaf / kPacket]);
  const bool areStored = frames_ == Frames::Stored;
  if (areStored) makeFrames(corners, triangles_[leaf]);
  uint32_t* ids = areStored ? triangles_[leaf].id : &ids_[size_t{leaf} * kPacket];
  for (uint32_t lane = 0; lane < kPacket; ++lane) ids[lane] = static_cast<uint32_t>(keys[lane]);
}

namespace {

/// Returns the disc around the discs of a packet.
Disc boundDiscs(const DiscPacket& packet, uint32_t count) {
  glm::vec3 centres[kPacket], normal(0.0f);
  for (uint32_t lane = 0; lane < count; ++lane) {
    const Disc disc = readDisc(packet, lane);
    centres[lane] = disc.centre;
    normal += disc.normal * (disc.radius * disc.radius);
  }
  Disc bound = boundPoints(centres, count, normal);
  // The discs reach beyond their centres: by this much along the common normal and across it.
  float front = 0.0f, back = 0.0f, radius = 0.0f;
  for (uint32_t lane = 0; lane < count; ++lane) {
    const Disc disc = readDisc(packet, lane);
    const glm::vec3 q = disc.centre - bound.centre;
    const float height = glm::dot(q, bound.normal);
    const float cosine = std::min(1.0f, std::abs(glm::dot(disc.normal, bound.normal)));
    const float sine = std::sqrt(1.0f - cosine * cosine);
    const float along = disc.radius * sine + disc.halfThickness * cosine;
    const float across =
        std::min(disc.radius + disc.halfThickness * sine, std::hypot(disc.radius, disc.halfThickness));
    front = std::max(front, height + along);
    back = std::min(back, height - along);
    radius = std::max(radius, std::sqrt(std::max(glm::dot(q, q) - height * height, 0.0f)) + across);
  }
  return {bound.centre + 0.5f * (front + back) * bound.normal, bound.normal, radius, 0.5f * (front - back)};
}

}  // namespace

void SurfaceTree::buildLevel(uint32_t level) {
  const uint32_t count = levels_[level].count, below = levels_[level - 1].count;
  const uint32_t firstPacket = levels_[level].start / kPacket,
                 firstChild = levels_[level - 1].start / kPacket;
  const uint32_t packets = (count + kPacket - 1) / kPacket;
  parallelFor(packets, 64, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p)
      for (uint32_t lane = 0; lane < kPacket; ++lane) {
        const auto node = static_cast<uint32_t>(p * kPacket + lane);
        const Disc disc =
            node < count ? boundDiscs(discs_[firstChild + node], std::min(kPacket, below - node * kPacket))
                         : kNowhere;
        writeDisc(disc, discs_[firstPacket + p], lane);
      }
  });
}

uint32_t SurfaceTree::levelOf(uint32_t node) const {
  if (isLeaf(node)) return 0;
  uint32_t level = 1;
  while (level + 1 < levels_.size() && node >= levels_[level + 1].start) ++level;
  return level;
}

size_t SurfaceTree::bytes() const {
  return keys_.capacityBytes() + triangles_.capacityBytes() + ids_.capacityBytes() + turns_.capacity() +
         discs_.capacityBytes();
}

}  // namespace raymap::cpu
