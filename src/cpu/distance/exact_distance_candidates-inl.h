// Candidates for the closest triangles of a block of samples, and their pruning (exact_distance.cpp).
// Compiled once per instruction set.

#include <utility>
#include <vector>

#include "cpu/distance/surface_shapes-inl.h"

#if defined(RAYMAP_EXACT_DISTANCE_CANDIDATES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMAP_EXACT_DISTANCE_CANDIDATES_INL_H
#undef RAYMAP_EXACT_DISTANCE_CANDIDATES_INL_H
#else
#define RAYMAP_EXACT_DISTANCE_CANDIDATES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {

/// Tree nodes and triangles that may hold the closest triangle of some sample of a block.
struct Candidates {
  std::vector<uint32_t> nodes, triangles;
  uint32_t closest = 0;  // triangle closest to the block's centre; any triangle for the largest blocks

  void reset(uint32_t newClosest) {
    nodes.clear();
    triangles.clear();
    closest = newClosest;
  }
};

/// Tangents of one candidate at the centres of all halves.
struct StoredTangent {
  Lanes d, gx, gy, gz;
  HWY_INLINE Tangent load(size_t i) const { return {d.load(i), gx.load(i), gy.load(i), gz.load(i)}; }
  HWY_INLINE void store(size_t i, const Tangent& t) {
    d.store(i, t.d), gx.store(i, t.gx), gy.store(i, t.gy), gz.store(i, t.gz);
  }
};

/// Returns the side of a block's centre, 0 or 1 along each axis, on which the half in this lane lies.
HWY_INLINE glm::ivec3 octant(size_t lane) {
  return {lane & 1, lane >> 1 & 1, lane >> 2};
}

HWY_INLINE Triangle<One> triangleOf(const SurfaceTree& tree, uint32_t t) {
  return {tree.triangles(t / kPacket), {t % kPacket}};
}
HWY_INLINE Disc<One> discOf(const SurfaceTree& tree, uint32_t node) {
  return {tree.discs(node / kPacket), {node % kPacket}};
}

/// The eight halves of a block, one per lane.
struct Level {
  Candidates candidates[kLanes];
  Lanes x, y, z;                         // centre
  Lanes distance;                        // from the centre to the triangle closest to it
  alignas(64) uint32_t closest[kLanes];  // that triangle
  Lanes corners[8];                      // distance from each corner to that triangle, minus the tolerance
  std::vector<StoredTangent> triangles, nodes;
};

/// Selects the candidates that may be closest to some sample.
class Pruner {
 public:
  explicit Pruner(const SurfaceTree& tree) : tree_(tree) {}

  /// Calls `keepTriangle` or `keepNode` with each candidate that may be closest, and with the lanes of the
  /// halves in which it may be. Opens nodes whose radius is above `wide`. `reach` is half a half's side.
  template <class KeepTriangle, class KeepNode>
  HWY_INLINE void prune(const Candidates& candidates, float reach, float wide, uint32_t active,
                        const Level& level, KeepTriangle&& keepTriangle, KeepNode&& keepNode) {
    const Float reachLanes = hn::Set(Tag(), reach);
    const auto offer = [&](uint32_t t, uint32_t lanes) {
      if (lanes) keepTriangle(t, lanes);
    };
    for (size_t k = 0; k < candidates.triangles.size(); ++k)
      offer(candidates.triangles[k], active & survivors(level.triangles[k], reachLanes, level));
    offer(candidates.closest, active & survivors(triangleOf(tree_, candidates.closest), reachLanes, level));
    for (size_t k = 0; k < candidates.nodes.size(); ++k)
      if (const uint32_t lanes = active & survivors(level.nodes[k], reachLanes, level))
        stack_.emplace_back(candidates.nodes[k], lanes);
    while (!stack_.empty()) {
      const auto [node, lanes] = stack_.back();
      stack_.pop_back();
      if (tree_.radius(node) <= wide) {
        keepNode(node, lanes);
        continue;
      }
      const uint32_t packet = tree_.childPacket(node), first = packet * kPacket;
      uint32_t halves[kPacket];
      if (tree_.isLeaf(node)) {
        const TrianglePacket& triangles = tree_.triangles(packet);
        survivors([&](size_t i) { return Triangle<Each>{triangles, {i}}; }, lanes, reachLanes, level, halves);
        for (uint32_t t = 0; t < kPacket; ++t) offer(first + t, halves[t]);
      } else {
        survivors(
            [&](size_t i) {
              return Disc<Each>{tree_.discs(packet), {i}};
            },
            lanes, reachLanes, level, halves);
        for (uint32_t n = 0; n < kPacket; ++n)
          if (halves[n]) stack_.emplace_back(first + n, halves[n]);
      }
    }
  }

 private:
  /// Returns where a candidate may be closest to some sample of a half: where its tangent plane lies below
  /// the closest triangle's distance at some corner.
  template <class Corner>
  static HWY_INLINE Mask mayWin(const Tangent& t, Float reach, Corner&& corner) {
    const Float x = hn::Mul(t.gx, reach), y = hn::Mul(t.gy, reach), z = hn::Mul(t.gz, reach);
    const Float low = hn::Sub(t.d, z), high = hn::Add(t.d, z);
    const Float sum = hn::Add(x, y), difference = hn::Sub(x, y);
    const auto gap = [&](Float value, size_t c) { return hn::Sub(value, corner(c)); };
    const Float a = hn::Min(gap(hn::Sub(low, sum), 0), gap(hn::Add(low, difference), 1));
    const Float b = hn::Min(gap(hn::Sub(low, difference), 2), gap(hn::Add(low, sum), 3));
    const Float c = hn::Min(gap(hn::Sub(high, sum), 4), gap(hn::Add(high, difference), 5));
    const Float d = hn::Min(gap(hn::Sub(high, difference), 6), gap(hn::Add(high, sum), 7));
    return hn::Lt(hn::Min(hn::Min(a, b), hn::Min(c, d)), hn::Zero(Tag()));
  }

  /// Returns the halves in which one candidate may be closest.
  HWY_INLINE uint32_t survivors(const Tangent& t, size_t i, Float reach, const Level& level) const {
    return bits(mayWin(t, reach, [&](size_t c) { return level.corners[c].load(i); })) << i;
  }

  /// Finds, for each of a packet's eight candidates, the halves among `lanes` in which it may be closest.
  template <class Shape>
  HWY_INLINE void survivors(const Shape& packet, uint32_t lanes, Float reach, const Level& level,
                            uint32_t (&halves)[kPacket]) const {
    std::fill_n(halves, kPacket, 0u);
    const Tag tag;
    forEachLane(lanes, [&](size_t half) {
      const Float x = hn::Set(tag, level.x.v[half]), y = hn::Set(tag, level.y.v[half]),
                  z = hn::Set(tag, level.z.v[half]);
      const auto corner = [&](size_t c) { return hn::Set(tag, level.corners[c].v[half]); };
      for (size_t i = 0; i < kLanes; i += hn::Lanes(tag))
        forEachLane(bits(mayWin(tangent(packet(i), x, y, z), reach, corner)) << i,
                    [&](size_t child) { halves[child] |= 1u << half; });
    });
  }

  HWY_INLINE uint32_t survivors(const StoredTangent& t, Float reach, const Level& level) const {
    uint32_t lanes = 0;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) lanes |= survivors(t.load(i), i, reach, level);
    return lanes;
  }

  template <class Shape>
  HWY_INLINE uint32_t survivors(const Shape& shape, Float reach, const Level& level) const {
    uint32_t lanes = 0;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
      lanes |= survivors(tangent(shape, level.x.load(i), level.y.load(i), level.z.load(i)), i, reach, level);
    return lanes;
  }

  const SurfaceTree& tree_;
  std::vector<std::pair<uint32_t, uint32_t>> stack_;  // node, lanes
};

}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
