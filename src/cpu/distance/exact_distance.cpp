// Ours (Krayer & Müller 2019 keep the nearest cell's triangles, §3.3): the true closest triangle of every
// sample.
//
// A block of samples is halved along every axis, again and again. The eight blocks that result, its halves,
// lie in SIMD lanes. Each has a list of the triangles and tree nodes that may hold the closest triangle of
// some sample in it. Let t be the triangle closest to a half's centre. The distance to a candidate is convex,
// so its tangent plane at the centre bounds it from below over the whole half. The distance to t is convex
// too. If it stays below that plane at the eight corners, it does so everywhere between. Then the candidate
// cannot matter. Lists shrink to a handful before single samples use them.

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
#include "cpu/distance/exact_distance_candidates-inl.h"
#include "cpu/distance/exact_distance_job.h"
#include "cpu/distance/exact_distance_samples-inl.h"
#include "cpu/distance/nearest_search-inl.h"
#include "cpu/distance/surface_shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kLargeSide = 32;

/// Returns the largest radius of an unopened node in the list of a block with this half side, in cells. The
/// values measured best from coarse to fine meshes.
constexpr float widestNode(float reach) {
  return std::max(0.6f * (reach + 0.5f), 0.8f);
}

/// Halves one block after another. Each thread has its own instance.
class BlockRefiner {
 public:
  explicit BlockRefiner(const ExactDistanceJob& job)
      : job_(job), tree_(job.tree), grid_(job), pruner_(job.tree), search_(job.tree) {
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
  /// Fills the eight halves of a block with `side` samples along each axis.
  void refine(glm::ivec3 low, int side, const Candidates& candidates, int depth) {
    Level& level = levels_[depth];
    const int half = side / 2;
    const float reach = 0.5f * static_cast<float>(half - 1);
    uint32_t active = grid_.from(low, half);
    placeHalves(low, half, reach, level);
    measure(candidates, active, level);
    if (job_.isAddition) active = grid_.skipClose(low, half, reach, active, level);
    if (job_.band > 0.0f) active = grid_.skipFar(low, half, reach, active, level);
    if (!active) return;
    if (half == 2) {
      finish(low, candidates, active, level);
      return;
    }
    for (size_t lane = 0; lane < kLanes; ++lane) {
      measureCorners(lane, reach, level);
      level.candidates[lane].reset(level.closest[lane]);
    }
    pruner_.prune(
        candidates, reach, widestNode(reach), active, level,
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
      Nearest nearest(candidates.closest,
                      hn::Sqrt(squaredDistance(triangleOf(tree_, candidates.closest), x, y, z)));
      for (size_t k = 0; k < candidates.triangles.size(); ++k) {
        const Tangent t = tangent(triangleOf(tree_, candidates.triangles[k]), x, y, z);
        level.triangles[k].store(i, t);
        nearest.take(candidates.triangles[k], t.d);
      }
      nearest.distance = hn::Mul(nearest.distance, nearest.distance);
      nearest.store(i, squared, level.closest);
      for (size_t k = 0; k < candidates.nodes.size(); ++k) {
        level.nodes[k].store(i, tangent(discOf(tree_, candidates.nodes[k]), x, y, z));
      }
    }
    search_.search(candidates.nodes, {active, level.x, level.y, level.z, squared, level.closest},
                   [&](size_t k, size_t i) {
                     const Float d = level.nodes[k].d.load(i);
                     return hn::Mul(d, d);
                   });
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag())) level.distance.store(i, hn::Sqrt(squared.load(i)));
  }

  /// Measures the distances from the corners of a lane's half to its closest triangle. Stores their squares
  /// in `squares` if that is not null.
  void measureCorners(size_t lane, float reach, Level& level, Lanes* squares = nullptr) const {
    const Tag tag;
    const Triangle<One> t = triangleOf(tree_, level.closest[lane]);
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

  /// Fills a block of 4x4x4 samples.
  HWY_NOINLINE void finish(glm::ivec3 low, const Candidates& candidates, uint32_t active, Level& level) {
    constexpr float kReach = 0.5f;
    for (size_t half = 0; half < kLanes; ++half) {
      measureCorners(half, kReach, level, &samples_.squared[half]);
      std::fill_n(samples_.closest[half], kLanes, level.closest[half]);
      level.candidates[half].reset(level.closest[half]);
    }
    pruner_.prune(
        candidates, kReach, widestNode(kReach), active, level,
        [&](uint32_t t, uint32_t halves) { finishTriangle(t, halves, level); },
        [&](uint32_t n, uint32_t halves) {
          forEachLane(halves, [&](size_t half) { level.candidates[half].nodes.push_back(n); });
        });
    forEachLane(active, [&](size_t half) {
      const glm::ivec3 first = low + 2 * octant(half);
      const uint32_t samples = grid_.from(first, 1);
      finishNodes(half, samples, level);
      grid_.write(first, samples_, half, samples);
    });
  }

  /// Searches below the nodes left to a half, for each sample by itself: their triangles are small compared
  /// to the spacing.
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
    search_.search(nodes, {samples, x, y, z, samples_.squared[half], samples_.closest[half]},
                   [&](size_t k, size_t i) {
                     return squaredDistance(discOf(tree_, nodes[k]), x.load(i), y.load(i), z.load(i));
                   });
  }

  /// Updates the closest triangle of every sample of these halves with one triangle.
  HWY_INLINE void finishTriangle(uint32_t id, uint32_t halves, const Level& level) {
    const Tag tag;
    const Triangle<One> t = triangleOf(tree_, id);
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

  const ExactDistanceJob& job_;
  const SurfaceTree& tree_;
  SampleGrid grid_;
  Pruner pruner_;
  Lanes signX_, signY_, signZ_;  // signs of the offsets from a half's centre to its eight corners
  Level levels_[4];
  NearestOfLanes samples_;
  NearestSearch<Ties::Any> search_;
};

/// Returns the side of the largest blocks, in samples. Large blocks share more work; small ones keep every
/// thread busy.
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

}  // namespace
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
