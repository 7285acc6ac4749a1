// Ours (Krayer & Müller 2019 keep the nearest cell's triangles, §3.3): the true closest triangle of every
// sample.
//
// Blocks of samples are halved again and again, each with the list of triangles and tree nodes that may hold
// the closest triangle of some sample in it. The eight halves lie in SIMD lanes. Let t be the triangle
// closest to a half's centre. The distance to a candidate is convex, so its tangent plane at the centre
// bounds it from below over the whole half; the distance to t is convex too, so where it stays below that
// plane at the eight corners, it does so everywhere between, and the candidate cannot matter. Lists shrink to
// a handful before single samples look at them.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/distance/exact_distance.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "cpu/distance/exact_distance.h"
#include "cpu/distance/nearest_search-inl.h"
#include "cpu/distance/surface_shapes-inl.h"

#ifndef RAYMAP_EXACT_DISTANCE_COMMON
#define RAYMAP_EXACT_DISTANCE_COMMON
namespace raymap::cpu {

/// What a run reads and writes, the same for every block.
struct ExactDistanceJob {
  const SurfaceTree& tree;
  glm::ivec3 dims;
  float band;       // cells; 0 = none
  float tolerance;  // cells: candidates that cannot win by more are dropped
  float* distance;
  uint32_t* triangle;  // may be null
  bool isAddition;     // keeps what is as close already
};

}  // namespace raymap::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kLargeSide = 32;
/// A node stays whole in the list of a block if its radius is at most this share of half the block's side, or
/// so many cells: measured best from coarse to fine meshes.
constexpr float kNodeShare = 0.6f, kSmallNode = 0.8f;

/// What may hold the closest triangle of some sample of a block.
struct Candidates {
  std::vector<uint32_t> nodes, triangles;
  uint32_t closest = 0;  // the triangle closest to the middle of the block that this one is a half of

  void reset(uint32_t newClosest) {
    nodes.clear();
    triangles.clear();
    closest = newClosest;
  }
};

struct StoredTangent {
  Lanes d, gx, gy, gz;
  HWY_INLINE Tangent load(size_t i) const { return {d.load(i), gx.load(i), gy.load(i), gz.load(i)}; }
  HWY_INLINE void store(size_t i, const Tangent& t) {
    d.store(i, t.d), gx.store(i, t.gx), gy.store(i, t.gy), gz.store(i, t.gz);
  }
};

HWY_INLINE glm::ivec3 octant(size_t lane) {
  return {lane & 1, lane >> 1 & 1, lane >> 2};
}

/// Halves one block after another; each thread has its own.
class BlockRefiner {
 public:
  explicit BlockRefiner(const ExactDistanceJob& job) : job_(job), tree_(job.tree), search_(job.tree) {
    for (size_t c = 0; c < kLanes; ++c) {
      const glm::vec3 sign = 2.0f * glm::vec3(octant(c)) - 1.0f;
      signX_.v[c] = sign.x, signY_.v[c] = sign.y, signZ_.v[c] = sign.z;
    }
  }

  void run(glm::ivec3 low, int side) {
    Candidates all;
    all.nodes.push_back(tree_.root());
    all.closest = 0;
    refine(low, side, all, 0);
  }

 private:
  /// The eight halves of a block.
  struct Level {
    Candidates candidates[kLanes];
    Lanes x, y, z;                         // their centres
    Lanes distance;                        // of the closest triangle to the centres
    alignas(64) uint32_t closest[kLanes];  // that triangle
    Lanes corners[8];                      // its distance at the corners, minus the tolerance
    std::vector<StoredTangent> triangles, nodes;
  };

  /// Fills the eight halves of a block of `side` samples.
  void refine(glm::ivec3 low, int side, const Candidates& candidates, int depth) {
    Level& level = levels_[depth];
    const int half = side / 2;
    const float reach = 0.5f * static_cast<float>(half - 1);
    uint32_t active = samplesFrom(low, half);
    placeHalves(low, half, reach, level);
    measure(candidates, active, level);
    if (job_.isAddition) active = skipClose(low, half, reach, active, level);
    if (job_.band > 0.0f) active = skipFar(low, half, reach, active, level);
    if (!active) return;
    if (half == 2) {
      finish(low, candidates, active, level);
      return;
    }
    for (size_t lane = 0; lane < kLanes; ++lane) {
      measureCorners(lane, reach, level);
      level.candidates[lane].reset(level.closest[lane]);
    }
    prune(
        candidates, reach, active, level,
        [&](uint32_t t, uint32_t lanes) {
          forEachLane(lanes, [&](size_t lane) { level.candidates[lane].triangles.push_back(t); });
        },
        [&](uint32_t n, uint32_t lanes) {
          forEachLane(lanes, [&](size_t lane) { level.candidates[lane].nodes.push_back(n); });
        });
    forEachLane(active, [&](size_t lane) {
      refine(low + half * octant(lane), half, level.candidates[lane], depth + 1);
    });
  }

  /// The eight positions `step` apart from `low` on, those that are samples of the grid.
  HWY_INLINE uint32_t samplesFrom(glm::ivec3 low, int step) const {
    const glm::ivec3 high = low + step;
    if (high.x < job_.dims.x && high.y < job_.dims.y && high.z < job_.dims.z) return 0xff;
    const uint32_t x = high.x < job_.dims.x ? 0xff : 0x55, y = high.y < job_.dims.y ? 0xff : 0x33,
                   z = high.z < job_.dims.z ? 0xff : 0x0f;
    return x & y & z;
  }

  /// Places the centres of the halves.
  void placeHalves(glm::ivec3 low, int half, float reach, Level& level) const {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const glm::vec3 centre = glm::vec3(low + half * octant(lane)) + reach;
      level.x.v[lane] = centre.x, level.y.v[lane] = centre.y, level.z.v[lane] = centre.z;
    }
  }

  /// Stores the tangents of all candidates, and finds the closest triangle to each centre.
  HWY_NOINLINE void measure(const Candidates& candidates, uint32_t active, Level& level) {
    level.triangles.resize(candidates.triangles.size());
    level.nodes.resize(candidates.nodes.size());
    Lanes squared;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) {
      const Float x = level.x.load(i), y = level.y.load(i), z = level.z.load(i);
      Nearest nearest(candidates.closest, hn::Sqrt(squaredDistance(triangle(candidates.closest), x, y, z)));
      for (size_t k = 0; k < candidates.triangles.size(); ++k) {
        const Tangent t = tangent(triangle(candidates.triangles[k]), x, y, z);
        level.triangles[k].store(i, t);
        nearest.take(candidates.triangles[k], t.d);
      }
      nearest.distance = hn::Mul(nearest.distance, nearest.distance);
      nearest.store(i, squared, level.closest);
      for (size_t k = 0; k < candidates.nodes.size(); ++k) {
        level.nodes[k].store(i, tangent(disc(candidates.nodes[k]), x, y, z));
      }
    }
    search_.search(candidates.nodes, {active, level.x, level.y, level.z, squared, level.closest},
                   [&](size_t k, size_t i) {
                     const Float d = level.nodes[k].d.load(i);
                     return hn::Mul(d, d);
                   });
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) level.distance.store(i, hn::Sqrt(squared.load(i)));
  }

  /// Leaves out the halves that are closer to what was there before.
  uint32_t skipClose(glm::ivec3 low, int half, float reach, uint32_t active, const Level& level) const {
    uint32_t rest = active;
    forEachLane(active, [&](size_t lane) {
      const float closest = level.distance.v[lane] - reach * std::sqrt(3.0f) - job_.tolerance;
      if (!isAnyFarther(low + half * octant(lane), half, closest)) rest &= ~(1u << lane);
    });
    return rest;
  }

  bool isAnyFarther(glm::ivec3 begin, int half, float distance) const {
    const glm::ivec3 end = glm::min(begin + half, job_.dims);
    for (int z = begin.z; z < end.z; ++z)
      for (int y = begin.y; y < end.y; ++y) {
        const float* row = job_.distance + (size_t(z) * job_.dims.y + y) * job_.dims.x;
        if (std::any_of(row + begin.x, row + end.x, [&](float d) { return d > distance; })) return true;
      }
    return false;
  }

  /// Fills the halves that the band does not reach; returns the rest.
  uint32_t skipFar(glm::ivec3 low, int half, float reach, uint32_t active, const Level& level) const {
    uint32_t rest = active;
    forEachLane(active, [&](size_t lane) {
      if (level.distance.v[lane] - reach * std::sqrt(3.0f) <= job_.band) return;
      rest &= ~(1u << lane);
      const glm::ivec3 begin = low + half * octant(lane);
      const glm::ivec3 end = glm::min(begin + half, job_.dims);
      for (int z = begin.z; z < end.z; ++z)
        for (int y = begin.y; y < end.y; ++y) {
          const size_t row = (size_t(z) * job_.dims.y + y) * job_.dims.x;
          std::fill(job_.distance + row + begin.x, job_.distance + row + end.x, job_.band);
          if (job_.triangle)
            std::fill(job_.triangle + row + begin.x, job_.triangle + row + end.x, kNoTriangle);
        }
    });
    return rest;
  }

  /// Distances of the lane's closest triangle at the corners of its half; returns their squares.
  void measureCorners(size_t lane, float reach, Level& level, Lanes* squares = nullptr) const {
    const Tag tag;
    const Triangle<One> t = triangle(level.closest[lane]);
    const Float r = hn::Set(tag, reach);
    Lanes d;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
      const Float square = squaredDistance(t, hn::MulAdd(signX_.load(i), r, hn::Set(tag, level.x.v[lane])),
                                           hn::MulAdd(signY_.load(i), r, hn::Set(tag, level.y.v[lane])),
                                           hn::MulAdd(signZ_.load(i), r, hn::Set(tag, level.z.v[lane])));
      if (squares) squares->store(i, square);
      d.store(i, hn::Sub(hn::Sqrt(square), hn::Set(tag, job_.tolerance)));
    }
    for (size_t c = 0; c < 8; ++c) level.corners[c].v[lane] = d.v[c];
  }

  /// Where a candidate may be closest to some sample of a half: its tangent plane lies below the closest
  /// triangle's distance at some corner.
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

  /// The halves in which one candidate may win.
  HWY_INLINE uint32_t survivors(const Tangent& t, size_t i, Float reach, const Level& level) const {
    return bits(mayWin(t, reach, [&](size_t c) { return level.corners[c].load(i); })) << i;
  }

  /// Of the halves in `lanes`, those in which each of a packet's eight may win.
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

  /// Hands on the triangles and nodes that may matter, and to which halves. Nodes too wide for the halves are
  /// opened.
  template <class KeepTriangle, class KeepNode>
  HWY_INLINE void prune(const Candidates& candidates, float reach, uint32_t active, const Level& level,
                        KeepTriangle&& keepTriangle, KeepNode&& keepNode) {
    const Float reachLanes = hn::Set(Tag(), reach);
    // Each half already has its closest triangle.
    const auto offer = [&](uint32_t t, uint32_t lanes) {
      if (lanes) keepTriangle(t, lanes);
    };
    for (size_t k = 0; k < candidates.triangles.size(); ++k)
      offer(candidates.triangles[k], active & survivors(level.triangles[k], reachLanes, level));
    offer(candidates.closest, active & survivors(triangle(candidates.closest), reachLanes, level));
    for (size_t k = 0; k < candidates.nodes.size(); ++k)
      if (const uint32_t lanes = active & survivors(level.nodes[k], reachLanes, level))
        stack_.emplace_back(candidates.nodes[k], lanes);
    const float wide = std::max(kNodeShare * (reach + 0.5f), kSmallNode);
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
        survivors(
            [&](size_t i) {
              return Triangle<Each>{tree_.triangles(packet), {i}};
            },
            lanes, reachLanes, level, halves);
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

  /// Fills a block of 4x4x4 samples.
  HWY_NOINLINE void finish(glm::ivec3 low, const Candidates& candidates, uint32_t active, Level& level) {
    constexpr float kReach = 0.5f;
    for (size_t half = 0; half < kLanes; ++half) {
      measureCorners(half, kReach, level, &samples_.squared[half]);
      std::fill_n(samples_.closest[half], kLanes, level.closest[half]);
      level.candidates[half].reset(level.closest[half]);
    }
    prune(
        candidates, kReach, active, level,
        [&](uint32_t t, uint32_t halves) { finishTriangle(t, halves, level); },
        [&](uint32_t n, uint32_t halves) {
          forEachLane(halves, [&](size_t half) { level.candidates[half].nodes.push_back(n); });
        });
    forEachLane(active, [&](size_t half) {
      const glm::ivec3 first = low + 2 * octant(half);
      const uint32_t samples = samplesFrom(first, 1);
      finishNodes(half, samples, level);
      write(first, half, samples);
    });
  }

  /// Looks below the nodes left to a half, each sample for itself: their triangles are small beside the
  /// spacing.
  void finishNodes(size_t half, uint32_t samples, Level& level) {
    const Tag tag;
    const Float reach = hn::Set(tag, 0.5f);
    Lanes x, y, z;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
      x.store(i, hn::MulAdd(signX_.load(i), reach, hn::Set(tag, level.x.v[half])));
      y.store(i, hn::MulAdd(signY_.load(i), reach, hn::Set(tag, level.y.v[half])));
      z.store(i, hn::MulAdd(signZ_.load(i), reach, hn::Set(tag, level.z.v[half])));
    }
    const std::vector<uint32_t>& nodes = level.candidates[half].nodes;
    search_.search(
        nodes, {samples, x, y, z, samples_.squared[half], samples_.closest[half]},
        [&](size_t k, size_t i) { return squaredDistance(disc(nodes[k]), x.load(i), y.load(i), z.load(i)); });
  }

  /// Takes the triangle as the closest of the samples where it is.
  HWY_INLINE void finishTriangle(uint32_t id, uint32_t halves, const Level& level) {
    const Tag tag;
    const Triangle<One> t = triangle(id);
    // The samples of a half lie at the same offsets from its centre in every half.
    Lanes u, v, w;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
      const Local centre = toLocal(t, level.x.load(i), level.y.load(i), level.z.load(i));
      u.store(i, centre.u), v.store(i, centre.v), w.store(i, centre.w);
    }
    const Float reach = hn::Set(tag, 0.5f);
    for (size_t i = 0; i < kLanes; i += hn::Lanes(tag)) {
      const Local offset = rotate(t, hn::Mul(signX_.load(i), reach), hn::Mul(signY_.load(i), reach),
                                  hn::Mul(signZ_.load(i), reach));
      forEachLane(halves, [&](size_t half) {
        const Local p{hn::Add(hn::Set(tag, u.v[half]), offset.u), hn::Add(hn::Set(tag, v.v[half]), offset.v),
                      hn::Add(hn::Set(tag, w.v[half]), offset.w)};
        Nearest nearest(i, samples_.squared[half], samples_.closest[half]);
        nearest.take(id, squaredDistance(t, p));
        nearest.store(i, samples_.squared[half], samples_.closest[half]);
      });
    }
  }

  void write(glm::ivec3 low, size_t half, uint32_t samples) const {
    Lanes distance;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
      distance.store(i, hn::Sqrt(samples_.squared[half].load(i)));
    forEachLane(samples, [&](size_t s) {
      const glm::ivec3 p = low + octant(s);
      const size_t index = (size_t(p.z) * job_.dims.y + p.y) * job_.dims.x + p.x;
      if (job_.isAddition && !(distance.v[s] < job_.distance[index])) return;
      const bool beyond = job_.band > 0.0f && distance.v[s] > job_.band;
      job_.distance[index] = beyond ? job_.band : distance.v[s];
      if (job_.triangle)
        job_.triangle[index] =
            beyond || job_.isAddition ? kNoTriangle : tree_.triangleId(samples_.closest[half][s]);
    });
  }

  HWY_INLINE Triangle<One> triangle(uint32_t t) const {
    return {tree_.triangles(t / kPacket), {t % kPacket}};
  }
  HWY_INLINE Disc<One> disc(uint32_t node) const { return {tree_.discs(node / kPacket), {node % kPacket}}; }

  const ExactDistanceJob& job_;
  const SurfaceTree& tree_;
  Lanes signX_, signY_, signZ_;  // of the eight corners of a half
  Level levels_[4];
  NearestOfLanes samples_;
  NearestSearch search_;
  std::vector<std::pair<uint32_t, uint32_t>> stack_;  // node, lanes
};

/// Large blocks share more work, small ones keep every thread busy.
int topSide(glm::ivec3 dims) {
  constexpr size_t kEnough = 64;
  const glm::ivec3 large = (dims + kLargeSide - 1) / kLargeSide;
  return size_t(large.x) * large.y * large.z >= kEnough ? kLargeSide : kLargeSide / 2;
}

void refineBlocks(const ExactDistanceJob& job, Progress& progress) {
  const int side = topSide(job.dims);
  const glm::ivec3 blocks = (job.dims + side - 1) / side;
  const size_t count = size_t(blocks.x) * blocks.y * blocks.z;
  std::atomic<size_t> done{0};
  parallelWorkers(count, [&](const auto& next) {
    BlockRefiner refiner(job);
    for (size_t b = next(); b < count; b = next()) {
      refiner.run(side * glm::ivec3(b % blocks.x, b / blocks.x % blocks.y, b / blocks.x / blocks.y), side);
      progress.report(double(++done) / double(count));
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(refineBlocks);

namespace {

ExactDistanceJob jobOf(const SurfaceTree& tree, const glm::ivec3& dims, Buffer<float>& distance,
                       Buffer<uint32_t>* triangle) {
  return {.tree = tree,
          .dims = dims,
          .band = 0.0f,
          .tolerance = 1e-7f * glm::length(glm::vec3(dims)),
          .distance = distance.data(),
          .triangle = triangle ? triangle->data() : nullptr,
          .isAddition = false};
}

}  // namespace

void computeExactDistance(const SurfaceTree& tree, const glm::ivec3& dims, double band, Progress& progress,
                          Buffer<float>& distance, Buffer<uint32_t>* triangle) {
  ExactDistanceJob job = jobOf(tree, dims, distance, triangle);
  job.band = static_cast<float>(band);
  HWY_DYNAMIC_DISPATCH(refineBlocks)(job, progress);
}

void addExactDistance(const SurfaceTree& tree, const glm::ivec3& dims, Progress& progress,
                      Buffer<float>& distance, Buffer<uint32_t>* triangle) {
  ExactDistanceJob job = jobOf(tree, dims, distance, triangle);
  job.isAddition = true;
  HWY_DYNAMIC_DISPATCH(refineBlocks)(job, progress);
}

}  // namespace raymap::cpu
#endif
