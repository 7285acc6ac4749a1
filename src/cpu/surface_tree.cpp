// Ours (the paper's future work names a hierarchy): the tree behind exact_distance.

#include "surface_tree.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "parallel.h"

namespace raymap {

namespace {

constexpr int kCurveBits = 10;
constexpr size_t kGrain = 2048;

/// Position along the Morton curve of a point on a 2^10 lattice.
uint32_t mortonIndex(glm::uvec3 p) {
  const auto spread = [](uint32_t v) {
    v = (v | (v << 16)) & 0x030000ffu;
    v = (v | (v << 8)) & 0x0300f00fu;
    v = (v | (v << 4)) & 0x030c30c3u;
    return (v | (v << 2)) & 0x09249249u;
  };
  return spread(p.x) << 2 | spread(p.y) << 1 | spread(p.z);
}

/// A unit vector across the unit vector `x` and across `e`. Where the cross product is mostly rounding, which
/// may point along `x`, any direction across `x` will do: `e` lies along it.
glm::dvec3 directionAcross(const glm::dvec3& x, const glm::dvec3& e) {
  const glm::dvec3 v = glm::cross(x, e);
  const double length = glm::length(v);
  if (length > 1e-9 * glm::length(e)) return v / length;
  return glm::normalize(glm::cross(x, std::abs(x.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
}

float inverseSquare(const glm::dvec2& v) {
  const double length2 = glm::dot(v, v);
  return length2 > 1e-30 ? static_cast<float>(1.0 / length2) : 0.0f;
}

/// Runs of the curve this long are put into better order: compact nodes are worth more than the curve's.
constexpr size_t kRun = size_t{kPacket} * kPacket * kPacket;

struct Centroid {
  glm::vec3 position;
  uint64_t key;
};

/// Halves the run across its longest side until packets are left, each power of two a run of its own.
void splitRun(Centroid* begin, size_t count) {
  if (count <= kPacket) return;
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (size_t t = 0; t < count; ++t) {
    low = glm::min(low, begin[t].position);
    high = glm::max(high, begin[t].position);
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const size_t half = std::bit_ceil(count) / 2;
  std::nth_element(begin, begin + half, begin + count, [axis](const Centroid& a, const Centroid& b) {
    return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis] : a.key < b.key;
  });
  splitRun(begin, half);
  splitRun(begin + half, count - half);
}

/// Writes a triangle into a lane. The longest edge becomes ab, so that c lies over it and slivers keep a
/// sound frame.
void writeTriangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, uint32_t id, TrianglePacket& packet,
                   uint32_t lane) {
  const auto square = [](const glm::dvec3& v) { return glm::dot(v, v); };
  const double ab = square(b - a), bc = square(c - b), ca = square(a - c);
  if (bc >= ab && bc >= ca) {
    std::swap(a, b);
    std::swap(b, c);
  } else if (ca >= ab) {
    std::swap(a, c);
    std::swap(b, c);
  }
  const glm::dvec3 e = c - a;
  const double length = glm::distance(a, b);
  const glm::dvec3 x = length > 0.0 ? (b - a) / length : glm::dvec3(1, 0, 0);
  const glm::dvec3 z = directionAcross(x, e);
  const glm::dvec3 y = glm::cross(z, x);
  const glm::dvec2 b2(length, 0.0), c2(glm::dot(e, x), glm::dot(e, y));
  const auto write = [lane](const glm::dvec3& v, float* fx, float* fy, float* fz) {
    fx[lane] = static_cast<float>(v.x), fy[lane] = static_cast<float>(v.y),
    fz[lane] = static_cast<float>(v.z);
  };
  write(a, packet.ax, packet.ay, packet.az);
  write(x, packet.xx, packet.xy, packet.xz);
  write(y, packet.yx, packet.yy, packet.yz);
  write(z, packet.zx, packet.zy, packet.zz);
  packet.bx[lane] = static_cast<float>(b2.x);
  packet.cx[lane] = static_cast<float>(c2.x);
  packet.cy[lane] = static_cast<float>(c2.y);
  packet.inverseBc2[lane] = inverseSquare(c2 - b2);
  packet.inverseCa2[lane] = inverseSquare(c2);
  packet.id[lane] = id;
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

/// No point comes near: fills the lanes of a packet that hold no node.
constexpr float kOutOfReach = 1e15f;

/// The disc around points, across a direction.
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

void SurfaceTree::build(const CellMesh& mesh) {
  sortTriangles(mesh);
  const auto count = static_cast<uint32_t>(mesh.triangles.size());
  const auto packets = [](uint32_t n) { return (n + kPacket - 1) / kPacket; };
  levelStarts_.clear();
  levelCounts_.clear();
  uint32_t start = 0;
  for (uint32_t nodes = packets(count);; nodes = packets(nodes)) {
    levelStarts_.push_back(start);
    levelCounts_.push_back(nodes);
    start += packets(nodes) * kPacket;
    if (nodes == 1) break;
  }
  leafCount_ = levelCounts_[0];
  triangles_.resize(leafCount_);
  discs_.resize(start / kPacket);
  buildLeaves(mesh);
  for (uint32_t level = 1; level < levelStarts_.size(); ++level) buildLevel(level);
}

void SurfaceTree::sortTriangles(const CellMesh& mesh) {
  const size_t count = mesh.triangles.size();
  const auto thrice = [&](size_t t) { return mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2); };
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const glm::vec3& v : mesh.vertices) {
    low = glm::min(low, v);
    high = glm::max(high, v);
  }
  const glm::vec3 size = 3.0f * (high - low);
  const float scale = ((1 << kCurveBits) - 1) / std::max({size.x, size.y, size.z, 1e-20f});
  keys_.resize(count);
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) {
      const glm::vec3 p = glm::clamp((thrice(t) - 3.0f * low) * scale, 0.0f, float((1 << kCurveBits) - 1));
      keys_[t] = uint64_t(mortonIndex(glm::uvec3(p))) << 32 | t;
    }
  });
  hwy::Sorter()(keys_.data(), count, hwy::SortAscending());
  parallelFor((count + kRun - 1) / kRun, 4, [&](size_t begin, size_t end) {
    std::array<Centroid, kRun> run;
    for (size_t r = begin; r < end; ++r) {
      uint64_t* keys = keys_.data() + r * kRun;
      const size_t length = std::min(kRun, count - r * kRun);
      for (size_t t = 0; t < length; ++t) run[t] = {thrice(static_cast<uint32_t>(keys[t])), keys[t]};
      splitRun(run.data(), length);
      for (size_t t = 0; t < length; ++t) keys[t] = run[t].key;
    }
  });
}

void SurfaceTree::buildLeaves(const CellMesh& mesh) {
  const size_t count = mesh.triangles.size();
  const uint32_t packets = (leafCount_ + kPacket - 1) / kPacket;
  parallelFor(packets, 16, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      for (uint32_t lane = 0; lane < kPacket; ++lane) {
        const size_t leaf = p * kPacket + lane;
        if (leaf >= leafCount_) {
          writeDisc({glm::vec3(kOutOfReach), {0, 0, 1}, 0.0f, 0.0f}, discs_[p], lane);
          continue;
        }
        glm::vec3 corners[3 * kPacket], normal(0.0f);
        for (uint32_t t = 0; t < kPacket; ++t) {
          const auto id = static_cast<uint32_t>(keys_[std::min(leaf * kPacket + t, count - 1)]);
          glm::vec3* corner = corners + 3 * t;
          for (int c = 0; c < 3; ++c) corner[c] = mesh.corner(id, c);
          normal += glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
          writeTriangle(corner[0], corner[1], corner[2], id, triangles_[leaf], t);
        }
        writeDisc(boundPoints(corners, 3 * kPacket, normal), discs_[p], lane);
      }
    }
  });
}

namespace {

/// The disc around the discs of a packet.
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
  const uint32_t count = levelCounts_[level], below = levelCounts_[level - 1];
  const uint32_t firstPacket = levelStarts_[level] / kPacket, firstChild = levelStarts_[level - 1] / kPacket;
  const uint32_t packets = (count + kPacket - 1) / kPacket;
  parallelFor(packets, 64, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p)
      for (uint32_t lane = 0; lane < kPacket; ++lane) {
        const auto node = static_cast<uint32_t>(p * kPacket + lane);
        const Disc disc =
            node < count ? boundDiscs(discs_[firstChild + node], std::min(kPacket, below - node * kPacket))
                         : Disc{glm::vec3(kOutOfReach), {0, 0, 1}, 0.0f, 0.0f};
        writeDisc(disc, discs_[firstPacket + p], lane);
      }
  });
}

uint32_t SurfaceTree::childPacket(uint32_t node) const {
  if (isLeaf(node)) return node;
  uint32_t level = 1;
  while (level + 1 < levelStarts_.size() && node >= levelStarts_[level + 1]) ++level;
  return levelStarts_[level - 1] / kPacket + (node - levelStarts_[level]);
}

size_t SurfaceTree::bytes() const {
  return keys_.capacityBytes() + triangles_.capacityBytes() + discs_.capacityBytes();
}

}  // namespace raymap
