// Exact distance of scattered points, with the tree and the candidate lists of exact_distance.
//
// Blocks are the cells of an octree over the points. The smallest block around a range of points is halved as
// in exact_distance, until a half holds few points. These are measured eight at a time.

#include "cpu/points/nearest_triangles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/points/nearest_triangles.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "cpu/distance/exact_distance_candidates-inl.h"
#include "cpu/distance/nearest_search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {

/// Most points that a block is not halved for.
constexpr size_t kFewPoints = 128;

/// Returns the largest radius of an unopened node in the list of a block with this half side, in cells. These
/// values measured best from sparse points to dense ones at the surface.
float widestNode(float reach) {
  return std::min(reach, 0.5f * reach + 1.4f);
}

/// Returns a length that exceeds the rounding errors of all distances between the tree and the points.
float slackOf(const SurfaceTree& tree, const SortedPoints& sorted) {
  constexpr float kRounding = 2e-6f;
  const DiscPacket& root = tree.discs(tree.root() / kPacket);
  const glm::vec3 centre(root.cx[0], root.cy[0], root.cz[0]), high = sorted.low + sorted.side;
  const glm::vec3 far = glm::max(glm::abs(centre) + root.radius[0] + root.halfThickness[0],
                                 glm::max(glm::abs(sorted.low), glm::abs(high)));
  return kRounding * std::max({far.x, far.y, far.z});
}

/// Halves blocks of points. Each thread has its own instance.
class PointBlocks {
 public:
  PointBlocks(const SurfaceTree& tree, const SortedPoints& sorted, float most,
              std::span<NearestTriangle> nearest)
      : tree_(tree),
        sorted_(sorted),
        most_(most),
        nearest_(nearest),
        slack_(slackOf(tree, sorted)),
        pruner_(tree),
        search_(tree, slack_) {}

  void run() {
    if (sorted_.areSparse) {
      measureApart();
      return;
    }
    Candidates all;
    all.nodes.push_back(tree_.root());
    all.closest = 0;
    refine({0, sorted_.points.size()}, all, 0);
  }

 private:
  struct Range {
    size_t begin, end;
    size_t count() const { return end - begin; }
  };

  /// The halves of a block, and the points in each.
  struct Halves {
    float reach;  // half a half's side
    Range ranges[kLanes];
    uint32_t active = 0;
  };

  /// Points in lanes, and the closest triangle to each.
  struct Found {
    Lanes x, y, z, squared;
    alignas(64) uint32_t closest[kLanes];

    void place(size_t lane, const glm::vec3& p) { x.v[lane] = p.x, y.v[lane] = p.y, z.v[lane] = p.z; }
  };

  void refine(const Range& range, const Candidates& candidates, size_t depth) {
    if (range.count() <= kFewPoints || sorted_.codes[range.begin] == sorted_.codes[range.end - 1]) {
      measurePoints(range, candidates);
      return;
    }
    if (levels_.size() <= depth) levels_.emplace_back(std::make_unique<Level>());
    Level& level = *levels_[depth];
    Halves halves = halve(range, level);
    measure(candidates, halves.active, level);
    halves.active = skipFar(halves, level);
    if (!halves.active) return;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      measureCorners(lane, halves.reach, level);
      level.candidates[lane].reset(level.closest[lane]);
    }
    pruner_.prune(
        candidates, halves.reach, widestNode(halves.reach), halves.active, level,
        [&](uint32_t t, uint32_t lanes) {
          forEachLane(lanes, [&](size_t lane) { level.candidates[lane].triangles.push_back(t); });
        },
        [&](uint32_t n, uint32_t lanes) {
          forEachLane(lanes, [&](size_t lane) { level.candidates[lane].nodes.push_back(n); });
        });
    forEachLane(halves.active,
                [&](size_t lane) { refine(halves.ranges[lane], level.candidates[lane], depth + 1); });
  }

  /// Halves the smallest block of the octree that holds all points of the range. Places the halves' centres.
  Halves halve(const Range& range, Level& level) const {
    const uint64_t first = sorted_.codes[range.begin], last = sorted_.codes[range.end - 1];
    // Level of the halves; the finest is 0. The codes differ.
    const int highest = static_cast<int>(std::bit_width(first ^ last)) - 1;
    const int octreeLevel = std::clamp(highest / 3, 0, kCurveBits - 1);
    const float cell = sorted_.side / static_cast<float>(1 << kCurveBits);
    const float side = cell * static_cast<float>(1 << octreeLevel);
    const uint64_t block = first >> (3 * (octreeLevel + 1));
    const glm::vec3 low =
        sorted_.low + 2.0f * side * glm::vec3(gather(block), gather(block >> 1), gather(block >> 2));
    Halves halves{.reach = 0.5f * side};
    size_t begin = range.begin;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const glm::vec3 centre = low + side * glm::vec3(octant(lane)) + halves.reach;
      level.x.v[lane] = centre.x, level.y.v[lane] = centre.y, level.z.v[lane] = centre.z;
      const uint64_t next = (block * kLanes + lane + 1) << (3 * octreeLevel);
      const size_t end = std::lower_bound(sorted_.codes.begin() + ptrdiff_t(begin),
                                          sorted_.codes.begin() + ptrdiff_t(range.end), next) -
                         sorted_.codes.begin();
      halves.ranges[lane] = {begin, end};
      if (end > begin) halves.active |= 1u << lane;
      begin = end;
    }
    return halves;
  }

  /// Returns every third bit, together.
  static float gather(uint64_t code) {
    uint32_t axis = 0;
    for (int bit = 0; bit < kCurveBits; ++bit) axis |= uint32_t(code >> (3 * bit) & 1) << bit;
    return static_cast<float>(axis);
  }

  /// Stores the tangents of all candidates, and finds a close triangle to each centre.
  HWY_NOINLINE void measure(const Candidates& candidates, uint32_t active, Level& level) {
    level.triangles.resize(candidates.triangles.size());
    level.nodes.resize(candidates.nodes.size());
    Lanes squared;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
      const Float x = level.x.load(i), y = level.y.load(i), z = level.z.load(i);
      Nearest nearest(candidates.closest, squaredDistance(triangleOf(tree_, candidates.closest), x, y, z));
      for (size_t k = 0; k < candidates.triangles.size(); ++k) {
        const Tangent t = tangent(triangleOf(tree_, candidates.triangles[k]), x, y, z);
        level.triangles[k].store(i, t);
        nearest.take(candidates.triangles[k], hn::Mul(t.d, t.d));
      }
      nearest.store(i, squared, level.closest);
      for (size_t k = 0; k < candidates.nodes.size(); ++k)
        level.nodes[k].store(i, tangent(discOf(tree_, candidates.nodes[k]), x, y, z));
    }
    search_.search(candidates.nodes, {active, level.x, level.y, level.z, squared, level.closest},
                   [&](size_t k, size_t i) {
                     const Float d = level.nodes[k].d.load(i);
                     return hn::Mul(d, d);
                   });
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) level.distance.store(i, hn::Sqrt(squared.load(i)));
  }

  /// Gives no triangle to the halves that are too far away. Returns the others.
  uint32_t skipFar(const Halves& halves, const Level& level) {
    uint32_t rest = halves.active;
    forEachLane(halves.active, [&](size_t lane) {
      if (level.distance.v[lane] - halves.reach * std::sqrt(3.0f) - slack_ <= most_) return;
      rest &= ~(1u << lane);
      const Range& range = halves.ranges[lane];
      std::fill(nearest_.begin() + ptrdiff_t(range.begin), nearest_.begin() + ptrdiff_t(range.end),
                NearestTriangle{INFINITY, kNoTriangle});
    });
    return rest;
  }

  /// Measures the distances from the corners of a half to its closest triangle.
  void measureCorners(size_t lane, float reach, Level& level) const {
    const Tag tag;
    const Triangle<One> t = triangleOf(tree_, level.closest[lane]);
    const glm::vec3 centre(level.x.v[lane], level.y.v[lane], level.z.v[lane]);
    Lanes x, y, z;
    for (size_t c = 0; c < kLanes; ++c) {
      const glm::vec3 corner = centre + reach * (2.0f * glm::vec3(octant(c)) - 1.0f);
      x.v[c] = corner.x, y.v[c] = corner.y, z.v[c] = corner.z;
    }
    Lanes d;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(tag))
      d.store(i,
              hn::Add(hn::Sqrt(squaredDistance(t, x.load(i), y.load(i), z.load(i))), hn::Set(tag, slack_)));
    for (size_t c = 0; c < kLanes; ++c) level.corners[c].v[lane] = d.v[c];
  }

  /// Finds the closest triangle to each point by itself: blocks of a few points would cost more than they
  /// save.
  void measureApart() {
    const float most = (most_ + slack_) * (most_ + slack_);
    uint32_t last = 0;  // The triangle of the last point is close to the next point, too.
    for (size_t k = 0; k < sorted_.points.size(); ++k) {
      const glm::vec3& p = sorted_.points[k];
      const Tag tag;
      const Float squared =
          squaredDistance(triangleOf(tree_, last), hn::Set(tag, p.x), hn::Set(tag, p.y), hn::Set(tag, p.z));
      NearestSearch<Ties::Lowest>::Closest closest{hn::GetLane(squared), last};
      if (closest.squared > most) closest = {most, kNoTriangle};
      search_.search(p, closest);
      nearest_[k] = {closest.squared, closest.triangle};
      if (closest.triangle != kNoTriangle) last = closest.triangle;
    }
  }

  void measurePoints(const Range& range, const Candidates& candidates) {
    constexpr size_t kAtATime = kLanes * kLanes;
    for (size_t begin = range.begin; begin < range.end; begin += kAtATime) {
      const Range some{begin, std::min(begin + kAtATime, range.end)};
      const bool isWorthwhile = some.count() == kAtATime && std::isfinite(most_);
      measureGroups(some, candidates, isWorthwhile ? groupsInReach(begin, candidates) : ~0u);
    }
  }

  /// Measures the points of up to eight groups, of which some may be near enough.
  void measureGroups(const Range& range, const Candidates& candidates, uint32_t near) {
    for (size_t begin = range.begin; begin < range.end; begin += kLanes, near >>= 1) {
      const size_t count = std::min(kLanes, range.end - begin);
      if (near & 1)
        measureLanes(begin, count, candidates);
      else
        std::fill_n(nearest_.begin() + ptrdiff_t(begin), count, NearestTriangle{INFINITY, kNoTriangle});
    }
  }

  /// Returns which of eight groups of points may be near enough. The centre of each tells.
  uint32_t groupsInReach(size_t begin, const Candidates& candidates) {
    Found centres;
    float radii[kLanes];
    for (size_t lane = 0; lane < kLanes; ++lane, begin += kLanes) {
      glm::vec3 low = sorted_.points[begin], high = low;
      for (size_t k = begin + 1; k < begin + kLanes; ++k) {
        low = glm::min(low, sorted_.points[k]);
        high = glm::max(high, sorted_.points[k]);
      }
      centres.place(lane, 0.5f * (low + high));
      radii[lane] = 0.5f * glm::distance(low, high);
    }
    find(candidates, (1u << kLanes) - 1, centres);
    uint32_t near = 0;
    for (size_t lane = 0; lane < kLanes; ++lane)
      if (std::sqrt(centres.squared.v[lane]) - radii[lane] - slack_ <= most_) near |= 1u << lane;
    return near;
  }

  void measureLanes(size_t begin, size_t count, const Candidates& candidates) {
    Found found;
    for (size_t lane = 0; lane < kLanes; ++lane)
      found.place(lane, sorted_.points[begin + std::min(lane, count - 1)]);
    find(candidates, (1u << count) - 1, found);
    for (size_t lane = 0; lane < count; ++lane)
      nearest_[begin + lane] = {found.squared.v[lane], found.closest[lane]};
  }

  HWY_NOINLINE void find(const Candidates& candidates, uint32_t lanes, Found& found) {
    const Lanes &x = found.x, &y = found.y, &z = found.z;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
      const auto distance = [&](uint32_t t) {
        return squaredDistance(triangleOf(tree_, t), x.load(i), y.load(i), z.load(i));
      };
      Nearest nearest(candidates.closest, distance(candidates.closest));
      for (const uint32_t t : candidates.triangles) nearest.takeLowest(t, distance(t));
      nearest.store(i, found.squared, found.closest);
    }
    search_.search(candidates.nodes, {lanes, x, y, z, found.squared, found.closest}, [&](size_t k, size_t i) {
      return squaredDistance(discOf(tree_, candidates.nodes[k]), x.load(i), y.load(i), z.load(i));
    });
  }

  const SurfaceTree& tree_;
  const SortedPoints& sorted_;
  float most_;
  std::span<NearestTriangle> nearest_;
  float slack_;
  Pruner pruner_;
  NearestSearch<Ties::Lowest> search_;
  std::vector<std::unique_ptr<Level>> levels_;
};

void findNearest(const SurfaceTree& tree, const SortedPoints& sorted, float most,
                 std::span<NearestTriangle> nearest) {
  PointBlocks(tree, sorted, most, nearest).run();
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(findNearest);

bool areSparse(size_t points, const SurfaceTree& tree) {
  return double(points) < std::pow(double(tree.triangleCount()), 0.75);
}

void findNearestTriangles(const SurfaceTree& tree, const SortedPoints& sorted, float most,
                          std::span<NearestTriangle> nearest) {
  HWY_DYNAMIC_DISPATCH(findNearest)(tree, sorted, most, nearest);
}

}  // namespace raymap::cpu
#endif
