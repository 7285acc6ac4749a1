// Finds the closest triangles to points in SIMD lanes by descending the surface tree. Compiled once per
// instruction set.

#if defined(RAYMAP_NEAREST_SEARCH_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMAP_NEAREST_SEARCH_INL_H
#undef RAYMAP_NEAREST_SEARCH_INL_H
#else
#define RAYMAP_NEAREST_SEARCH_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "cpu/distance/surface_shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Smallest value so far in each lane, and the id that it belongs to.
struct Nearest {
  using IntTag = hn::Rebind<int32_t, Tag>;
  Float distance;
  hn::Vec<IntTag> id;
  HWY_INLINE Nearest(uint32_t firstId, Float first)
      : distance(first), id(hn::Set(IntTag(), static_cast<int32_t>(firstId))) {}
  HWY_INLINE Nearest(size_t i, const Lanes& distances, const uint32_t* ids)
      : distance(distances.load(i)), id(hn::Load(IntTag(), reinterpret_cast<const int32_t*>(ids) + i)) {}
  HWY_INLINE void take(uint32_t newId, Float value) {
    take(hn::Set(IntTag(), static_cast<int32_t>(newId)), value, hn::Lt(value, distance));
  }
  HWY_INLINE void takeEach(uint32_t firstId, Float value) {
    take(hn::Iota(IntTag(), static_cast<int32_t>(firstId)), value, hn::Lt(value, distance));
  }
  /// Does the same as `take`. Of equal values it takes the one with the lowest id.
  HWY_INLINE void takeLowest(uint32_t newId, Float value) {
    takeLowest(hn::Set(IntTag(), static_cast<int32_t>(newId)), value);
  }
  HWY_INLINE void takeLowestEach(uint32_t firstId, Float value) {
    takeLowest(hn::Iota(IntTag(), static_cast<int32_t>(firstId)), value);
  }
  HWY_INLINE void store(size_t i, Lanes& distances, uint32_t* ids) const {
    distances.store(i, distance);
    hn::Store(id, IntTag(), reinterpret_cast<int32_t*>(ids) + i);
  }

 private:
  HWY_INLINE void take(hn::Vec<IntTag> newId, Float value, Mask isCloser) {
    id = hn::IfThenElse(hn::RebindMask(IntTag(), isCloser), newId, id);
    distance = hn::Min(distance, value);
  }
  HWY_INLINE void takeLowest(hn::Vec<IntTag> newId, Float value) {
    const Mask isLower = hn::RebindMask(Tag(), hn::Lt(newId, id));
    take(newId, value, hn::Or(hn::Lt(value, distance), hn::And(hn::Eq(value, distance), isLower)));
  }
};

/// Points in some of the lanes, and the closest triangles so far.
struct Points {
  uint32_t lanes;
  const Lanes &x, &y, &z;
  Lanes& squared;
  uint32_t* closest;
};

/// Table of 8 x 8 closest triangles. It holds those of eight points in each of the eight halves of a block,
/// by half, then by point. Or it holds those of eight points among each lane of the searched packets, by
/// point, then by lane.
struct NearestOfLanes {
  Lanes squared[kLanes];
  alignas(64) uint32_t closest[kLanes][kLanes];
};

/// Squared distance beyond which lie only the discs that fill up packets.
constexpr float kFarthest = 1e29f;

/// Triangle that a search takes where several are equally close, but for rounding.
enum class Ties {
  Any,    ///< Any of them: the fastest search.
  Lowest  ///< The lowest of those whose squared distances are least in single precision, whatever was
          ///< searched.
};

/// Search with its scratch memory. Each thread has its own instance.
template <Ties kTies>
class NearestSearch {
 public:
  /// With `Ties::Lowest`, `slack` exceeds the rounding errors of all distances, in cells.
  explicit NearestSearch(const SurfaceTree& tree, float slack = 0.0f) : tree_(tree), slack_(slack) {}

  /// Searches for closer triangles below nodes whose squared distances are at least `bound(node, lane)`. The
  /// node that may be closest to each point comes first: it nearly settles the point's distance. Then come
  /// all other nodes that may still be closer.
  template <class Bound>
  HWY_INLINE void search(const std::vector<uint32_t>& nodes, const Points& points, Bound&& bound) {
    alignas(64) uint32_t first[kLanes];
    const uint32_t lanes = points.lanes & boundNodes(nodes.size(), points, bound, first);
    if (!lanes) return;
    start(points);
    searchFirst(nodes, first, lanes, points);
    settle(lanes, points);
    for (size_t k = 0; k < nodes.size(); ++k)
      if (const uint32_t open = lanes & mayBeCloser(bounds_[k], points.squared)) push(nodes[k], open);
    if (stack_.empty()) return;
    searchStack(points);
    settle(lanes, points);
  }

  /// Closest triangle so far to a point.
  struct Closest {
    float squared;
    uint32_t triangle;
  };

  /// Searches the whole tree for a triangle that is closer to p.
  void search(const glm::vec3& p, Closest& closest) const { searchBelow(tree_.root(), p, closest); }

 private:
  static HWY_INLINE void prefetch(std::span<const std::byte> memory) {
    for (size_t line = 0; line < memory.size(); line += 64) hwy::Prefetch(memory.data() + line);
  }

  /// Returns where something with this lower bound may hold a triangle to be taken instead of the closest.
  HWY_INLINE Mask mayBeCloser(Float bound, Float squared) const {
    if constexpr (kTies == Ties::Any) return hn::Lt(bound, squared);
    const Float limit = hn::Add(hn::Sqrt(squared), hn::Set(Tag(), slack_));
    return hn::Le(bound, hn::Min(hn::Mul(limit, limit), hn::Set(Tag(), kFarthest)));
  }
  bool mayBeCloser(float bound, float squared) const {
    if constexpr (kTies == Ties::Any) return bound < squared;
    const float limit = std::sqrt(squared) + slack_;
    return bound <= std::min(limit * limit, kFarthest);
  }
  HWY_INLINE uint32_t mayBeCloser(const Lanes& bound, const Lanes& squared) const {
    uint32_t lanes = 0;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
      lanes |= bits(mayBeCloser(bound.load(i), squared.load(i))) << i;
    return lanes;
  }

  /// Stores all bounds and finds the node with the lowest bound for each point. Returns the points to which
  /// some node may be closer than the closest triangle so far.
  template <class Bound>
  HWY_INLINE uint32_t boundNodes(size_t count, const Points& points, Bound&& bound, uint32_t* first) {
    bounds_.resize(count);
    Lanes least;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
      Nearest nearest(0, hn::Set(Tag(), INFINITY));
      for (size_t k = 0; k < count; ++k) {
        const Float b = bound(k, i);
        bounds_[k].store(i, b);
        nearest.take(static_cast<uint32_t>(k), b);
      }
      nearest.store(i, least, first);
    }
    return mayBeCloser(least, points.squared);
  }

  static HWY_INLINE bool isBefore(const Closest& a, const Closest& b) {
    if constexpr (kTies == Ties::Any) return a.squared < b.squared;
    return a.squared < b.squared || (a.squared == b.squared && a.triangle < b.triangle);
  }

  HWY_INLINE void push(uint32_t node, uint32_t lanes) {
    stack_.emplace_back(node, lanes);
    if (tree_.isLeaf(node)) prefetch(tree_.memoryOf(node));
  }

  HWY_INLINE void start(const Points& points) {
    for (size_t point = 0; point < kLanes; ++point) {
      std::fill_n(best_.squared[point].v, kLanes, points.squared.v[point]);
      std::fill_n(best_.closest[point], kLanes, points.closest[point]);
    }
  }

  /// Takes for each point the closest of the triangles in all lanes.
  HWY_INLINE void settle(uint32_t lanes, const Points& points) const {
    forEachLane(lanes, [&](size_t point) {
      const float* squared = best_.squared[point].v;
      const uint32_t* closest = best_.closest[point];
      size_t best = 0;
      for (size_t lane = 1; lane < kLanes; ++lane)
        if (isBefore({squared[lane], closest[lane]}, {squared[best], closest[best]})) best = lane;
      points.squared.v[point] = squared[best];
      points.closest[point] = closest[best];
    });
  }

  /// Searches below the first node of each point, once for all points that share it.
  HWY_INLINE void searchFirst(const std::vector<uint32_t>& nodes, const uint32_t* first, uint32_t lanes,
                              const Points& points) {
    while (lanes) {
      const uint32_t k = first[hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes)];
      uint32_t sharing = 0;
      forEachLane(lanes, [&](size_t lane) {
        if (first[lane] != k) return;
        sharing |= 1u << lane;
        bounds_[k].v[lane] = INFINITY;  // This node is not searched again.
      });
      lanes &= ~sharing;
      if (tree_.isLeaf(nodes[k]))
        measureTriangles(nodes[k], sharing, points);
      else
        forEachLane(sharing, [&](size_t lane) {
          Closest closest{points.squared.v[lane], points.closest[lane]};
          searchBelow(nodes[k], {points.x.v[lane], points.y.v[lane], points.z.v[lane]}, closest);
          best_.squared[lane].v[0] = closest.squared;
          best_.closest[lane][0] = closest.triangle;
        });
    }
  }

  /// Searches for closer triangles below the nodes on the stack, each for the points in its lanes. No result
  /// waits for another: each lane of the packets keeps its closest triangle, and `settle` takes the closest
  /// of these at the end.
  HWY_NOINLINE void searchStack(const Points& points) {
    while (!stack_.empty()) {
      const auto [node, lanes] = stack_.back();
      stack_.pop_back();
      if (tree_.isLeaf(node))
        measureTriangles(node, lanes, points);
      else
        openNode(tree_.childPacket(node), lanes, points);
    }
  }

  HWY_INLINE void measureTriangles(uint32_t packet, uint32_t lanes, const Points& points) {
    const Tag tag;
    const TrianglePacket& triangles = tree_.triangles(packet);
    forEachLane(lanes, [&](size_t point) {
      const Float x = hn::Set(tag, points.x.v[point]), y = hn::Set(tag, points.y.v[point]),
                  z = hn::Set(tag, points.z.v[point]);
      for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
        Nearest nearest(i, best_.squared[point], best_.closest[point]);
        const Float squared = squaredDistance(Triangle<Each>{triangles, {i}}, x, y, z);
        if constexpr (kTies == Ties::Any)
          nearest.takeEach(packet * kPacket + i, squared);
        else
          nearest.takeLowestEach(packet * kPacket + i, squared);
        nearest.store(i, best_.squared[point], best_.closest[point]);
      }
    });
  }

  HWY_INLINE void openNode(uint32_t packet, uint32_t lanes, const Points& points) {
    const Tag tag;
    uint32_t open[kPacket] = {};
    forEachLane(lanes, [&](size_t point) {
      const Float x = hn::Set(tag, points.x.v[point]), y = hn::Set(tag, points.y.v[point]),
                  z = hn::Set(tag, points.z.v[point]), known = hn::Set(tag, points.squared.v[point]);
      for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
        const Float bound = squaredDistance(Disc<Each>{tree_.discs(packet), {i}}, x, y, z);
        forEachLane(bits(mayBeCloser(bound, known)) << i, [&](size_t child) { open[child] |= 1u << point; });
      }
    });
    for (uint32_t child = 0; child < kPacket; ++child)
      if (open[child]) push(packet * kPacket + child, open[child]);
  }

  /// Searches for a closer triangle to p below the node, nearer children first, a packet at a time.
  void searchBelow(uint32_t node, const glm::vec3& p, Closest& closest) const {
    if (const uint32_t level = tree_.levelOf(node); level > 0)
      searchPacket(level - 1, tree_.childPacket(node, level), p, closest);
    else
      measureLeaf(node, p, closest);
  }

  void measureLeaf(uint32_t packet, const glm::vec3& p, Closest& closest) const {
    const Tag tag;
    const TrianglePacket& triangles = tree_.triangles(packet);
    Lanes squared;
    uint32_t closer = 0;
    for (size_t i = 0; i < kPacket; i += hn::Lanes(tag)) {
      const Float d = squaredDistance(Triangle<Each>{triangles, {i}}, hn::Set(tag, p.x), hn::Set(tag, p.y),
                                      hn::Set(tag, p.z));
      squared.store(i, d);
      closer |= bits(hn::Le(d, hn::Set(tag, closest.squared))) << i;
    }
    forEachLane(closer, [&](size_t lane) {
      const Closest found{squared.v[lane], packet * kPacket + static_cast<uint32_t>(lane)};
      if (isBefore(found, closest)) closest = found;
    });
  }

  /// Does the same below the nodes of a packet, which belong to a level of the tree.
  void searchPacket(uint32_t level, uint32_t packet, const glm::vec3& p, Closest& closest) const {
    const Tag tag;
    Lanes bounds;
    uint32_t open = 0;
    for (size_t i = 0; i < kPacket; i += hn::Lanes(tag)) {
      const Float d = squaredDistance(Disc<Each>{tree_.discs(packet), {i}}, hn::Set(tag, p.x),
                                      hn::Set(tag, p.y), hn::Set(tag, p.z));
      bounds.store(i, d);
      open |= bits(mayBeCloser(d, hn::Set(tag, closest.squared))) << i;
    }
    const uint32_t first = tree_.childPacket(packet * kPacket, level);  // The others follow it.
    forEachLane(open, [&](size_t lane) {
      const uint32_t child = first + static_cast<uint32_t>(lane);
      if (level == 0)
        prefetch(tree_.memoryOf(child));
      else
        prefetch(std::as_bytes(std::span(&tree_.discs(child), 1)));
    });
    while (open) {
      size_t next = hwy::Num0BitsBelowLS1Bit_Nonzero32(open);
      forEachLane(open, [&](size_t lane) {
        if (bounds.v[lane] < bounds.v[next]) next = lane;
      });
      if (!mayBeCloser(bounds.v[next], closest.squared)) return;
      open &= ~(1u << next);
      const uint32_t child = first + static_cast<uint32_t>(next);
      if (level == 0)
        measureLeaf(child, p, closest);
      else
        searchPacket(level - 1, child, p, closest);
    }
  }

  const SurfaceTree& tree_;
  float slack_;
  NearestOfLanes best_;
  std::vector<Lanes> bounds_;
  std::vector<std::pair<uint32_t, uint32_t>> stack_;  // node, points
};

}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#endif
