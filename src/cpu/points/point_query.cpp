#include "cpu/points/point_query.h"

#include <hwy/cache_control.h>
#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/morton.h"
#include "base/parallel.h"
#include "cpu/points/closest_point.h"
#include "cpu/points/nearest_triangles.h"
#include "cpu/points/point_cells.h"
#include "method/points_view.h"

namespace raymap::cpu {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Most points that are sorted together. Their numbers leave room for their places on the curve.
constexpr size_t kPointsAtOnce = size_t{1} << (64 - 3 * kCurveBits);

/// Most points that one thread answers at a time, and fewest. Sparse points gain nothing from each other.
constexpr size_t kMostAtOnce = 4096, kFewestAtOnce = 256, kFewestSparseAtOnce = 64;

/// Points farther from the grid than this many times its size are searched by themselves: the precision of a
/// search is that of its farthest point.
constexpr float kFar = 4.0f;

/// Some points of a query, sorted along a curve.
class Batch {
 public:
  /// Loads the points numbered [begin, end).
  void load(const Grid& grid, const PointsView& view, size_t begin, size_t end) {
    begin_ = begin;
    cells_.resizeUninitialized(end - begin);
    places_.resizeUninitialized(end - begin);
    parts_.assign((end - begin + kMostAtOnce - 1) / kMostAtOnce, {});
    forEachPart([&](Part& part, size_t i) {
      cells_[i] = toCells(grid, pointAt(view, begin_ + i));
      places_[i] = placeOf(grid, cells_[i]);
      if (places_[i] != Place::Nowhere) part.sets[places_[i] == Place::Far].add(cells_[i]);
    });
  }

  /// Sorts the points that are far from the grid, or the others.
  void sort(bool isFar) {
    PointSet all;
    for (Part& part : parts_) {
      part.next = all.count;
      all.add(part.sets[isFar]);
    }
    keys_.resizeUninitialized(all.count);
    if (all.count == 0) return;
    const glm::vec3 size = all.high - all.low;
    low_ = all.low;
    // All points lie within the cube in spite of rounding.
    side_ = std::max({size.x, size.y, size.z, 1e-20f}) * 1.0001f;
    const Place wanted = isFar ? Place::Far : Place::Near;
    forEachPart([&](Part& part, size_t i) {
      if (places_[i] == wanted) keys_[part.next++] = codeOf(cells_[i]) << kNumberBits | i;
    });
    hwy::Sorter()(keys_.data(), keys_.size(), hwy::SortAscending());
  }

  /// Number of points that were sorted.
  size_t count() const { return keys_.size(); }
  /// Returns the number of a sorted point in the query.
  size_t number(size_t k) const { return begin_ + (keys_[k] & (kPointsAtOnce - 1)); }
  /// Returns the place of a sorted point on the curve.
  uint64_t code(size_t k) const { return keys_[k] >> kNumberBits; }
  /// Returns some of the sorted points, from what the caller keeps of them.
  SortedPoints sorted(std::span<const glm::vec3> cells, std::span<const uint64_t> codes) const {
    return {cells, codes, low_, side_};
  }
  /// Returns whether a coordinate of some point is not finite.
  bool hasNowhere() const {
    size_t somewhere = 0;
    for (const Part& part : parts_) somewhere += part.sets[0].count + part.sets[1].count;
    return somewhere < cells_.size();
  }

 private:
  static constexpr int kNumberBits = 64 - 3 * kCurveBits;
  enum class Place : uint8_t { Near, Far, Nowhere };

  /// Size of a set of points.
  struct PointSet {
    size_t count = 0;
    glm::vec3 low{INFINITY}, high{-INFINITY};

    void add(const glm::vec3& p) { add(PointSet{1, p, p}); }
    void add(const PointSet& set) {
      count += set.count;
      low = glm::min(low, set.low);
      high = glm::max(high, set.high);
    }
  };

  /// Points that one thread loads at a time.
  struct Part {
    PointSet sets[2];  // near and far
    size_t next = 0;   // where its next key goes
  };

  static Place placeOf(const Grid& grid, const glm::vec3& p) {
    if (std::isnan(p.x)) return Place::Nowhere;
    const glm::vec3 dims(grid.dims), q = p - 0.5f * dims;
    const float farthest = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
    return farthest <= kFar * std::max({dims.x, dims.y, dims.z}) ? Place::Near : Place::Far;
  }

  uint64_t codeOf(const glm::vec3& p) const {
    constexpr float kPlaces = 1 << kCurveBits;
    const glm::uvec3 place(glm::clamp((p - low_) * (kPlaces / side_), 0.0f, kPlaces - 1.0f));
    return mortonCode(place.x, place.y, place.z);
  }

  template <class Visit>
  void forEachPart(Visit&& visit) {
    parallelFor(parts_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t part = begin; part < end; ++part)
        for (size_t i = part * kMostAtOnce; i < std::min((part + 1) * kMostAtOnce, cells_.size()); ++i)
          visit(parts_[part], i);
    });
  }

  size_t begin_ = 0;
  Buffer<glm::vec3> cells_;
  Buffer<Place> places_;
  std::vector<Part> parts_;
  Buffer<uint64_t> keys_;  // the point's number in the batch below its place on the curve
  glm::vec3 low_{0.0f};
  float side_ = 0.0f;
};

/// A query and the place of its results.
struct Query {
  const PreparedSurface& surface;
  bool isSigned;
  const PointsView& view;
  const QueryOptions& options;
  QueryResult& result;
};

/// Answers for one part of a batch after another. Each thread has its own instance.
class Answers {
 public:
  explicit Answers(const Query& query)
      : surface_(query.surface), view_(query.view), options_(query.options), result_(query.result) {
    if (query.isSigned) winding_.emplace(surface_.windingSource());
  }

  void answer(const Batch& batch, size_t begin, size_t end) {
    gather(batch, begin, end - begin);
    const double limit = options_.maxDistance / surface_.grid.spacing;
    SortedPoints sorted = batch.sorted(cells_, codes_);
    sorted.areSparse = areSparse(batch.count(), surface_.tree);
    findNearestTriangles(surface_.tree, sorted, static_cast<float>(limit), nearest_);
    for (size_t k = 0; k < cells_.size(); ++k) {
      const uint32_t found = nearest_[k].triangle;
      triangles_[k] = found == kNoTriangle ? kNoTriangle : surface_.tree.triangleId(found);
    }
    findClosestPoints(surface_.mesh, exact_, triangles_, closest_);
    for (size_t k = 0; k < cells_.size(); ++k) measure(k, batch.number(begin + k));
    if (winding_) computeSigns(batch, begin);
  }

 private:
  /// Collects points that are scattered over memory.
  void gather(const Batch& batch, size_t begin, size_t count) {
    constexpr size_t kAhead = 32;
    nearest_.resize(count), cells_.resize(count), codes_.resize(count), exact_.resize(count);
    distances_.resize(count), numbers_.resize(count), triangles_.resize(count), closest_.resize(count);
    unsigned_.resize(count), shrinking_.resize(count);
    for (size_t k = 0; k < count; ++k) {
      if (k + kAhead < count) hwy::Prefetch(bytesAt(view_, batch.number(begin + k + kAhead)));
      const glm::dvec3 p = pointAt(view_, batch.number(begin + k));
      cells_[k] = toCells(surface_.grid, p);
      codes_[k] = batch.code(begin + k);
      const glm::dvec3 offset = p - surface_.mesh.origin;
      shrinking_[k] = shrinkingOf(offset);
      exact_[k] = offset * shrinking_[k];
    }
  }

  /// Fills what follows from the closest triangle.
  void measure(size_t k, size_t number) {
    TrianglePoint closest = closest_[k];
    uint32_t triangle = triangles_[k];
    const double length = triangle == kNoTriangle ? INFINITY : glm::length(exact_[k] - closest.position);
    double distance = length / shrinking_[k];
    // Beyond the largest distance nothing more is known of points without a triangle. The sign must not
    // depend on which points those are.
    const double known = std::min(distance, options_.maxDistance);
    distances_[k] = static_cast<float>(known / surface_.grid.spacing);
    if (distance > options_.maxDistance || triangle == kNoTriangle) {
      distance = options_.maxDistance;
      triangle = kNoTriangle;
      closest = {glm::dvec3(kNaN), glm::dvec3(kNaN)};
    }
    if (winding_)
      unsigned_[k] = distance;
    else if (options_.distance)
      result_.distance[number] = distance;
    if (options_.closest) result_.closest[number] = closest.position + surface_.mesh.origin;
    if (options_.triangle) result_.triangle[number] = triangle;
    if (options_.barycentric) result_.barycentric[number] = closest.weights;
    if (options_.direction)
      result_.direction[number] = distance > 0.0 ? (closest.position - exact_[k]) / length : glm::dvec3(0.0);
  }

  void computeSigns(const Batch& batch, size_t begin) {
    const WindingPoints points{cells_, exact_, distances_};
    if (options_.winding || options_.confidence)
      winding_->computeClosely(points, numbers_);
    else
      winding_->compute(points, numbers_);
    for (size_t k = 0; k < cells_.size(); ++k) {
      const size_t number = batch.number(begin + k);
      const bool isInside = std::abs(numbers_[k]) > surface_.threshold;
      if (options_.distance) result_.distance[number] = isInside ? -unsigned_[k] : unsigned_[k];
      if (options_.winding) result_.winding[number] = static_cast<float>(numbers_[k]);
      if (options_.confidence) result_.confidence[number] = winding_->confidence(cells_[k], numbers_[k]);
    }
  }

  const PreparedSurface& surface_;
  const PointsView& view_;
  const QueryOptions& options_;
  QueryResult& result_;
  std::optional<PointWinding> winding_;
  std::vector<NearestTriangle> nearest_;
  std::vector<glm::vec3> cells_;
  std::vector<uint64_t> codes_;
  std::vector<glm::dvec3> exact_;  // relative to the mesh's origin, times `shrinking_`
  std::vector<double> shrinking_;
  std::vector<float> distances_;
  std::vector<double> numbers_;
  std::vector<uint32_t> triangles_;
  std::vector<TrianglePoint> closest_;
  std::vector<double> unsigned_;  // distances in the mesh's units, until their signs are known
};

void sizeResult(const QueryOptions& options, size_t count, QueryResult& result) {
  const auto size = [&](auto& buffer, bool isAsked) { buffer.resizeUninitialized(isAsked ? count : 0); };
  size(result.distance, options.distance);
  size(result.closest, options.closest);
  size(result.triangle, options.triangle);
  size(result.barycentric, options.barycentric);
  size(result.direction, options.direction);
  size(result.winding, options.winding);
  size(result.confidence, options.confidence);
}

/// Writes what points with a coordinate that is not finite get.
void fillRest(const PointsView& view, size_t begin, size_t end, QueryResult& result) {
  const auto fill = [](auto& buffer, size_t i, const auto& value) {
    if (!buffer.empty()) buffer[i] = value;
  };
  for (size_t i = begin; i < end; ++i) {
    if (isFinite(pointAt(view, i))) continue;
    fill(result.distance, i, kNaN);
    fill(result.closest, i, glm::dvec3(kNaN));
    fill(result.triangle, i, kNoTriangle);
    fill(result.barycentric, i, glm::dvec3(kNaN));
    fill(result.direction, i, glm::dvec3(kNaN));
    fill(result.winding, i, NAN);
    fill(result.confidence, i, NAN);
  }
}

void answerAll(const Query& query, Progress& progress) {
  const PointsView& view = query.view;
  const SurfaceTree& tree = query.surface.tree;
  sizeResult(query.options, view.count, query.result);
  Batch batch;
  std::atomic<size_t> done{0};
  for (size_t begin = 0; begin < view.count; begin += kPointsAtOnce) {
    const size_t end = std::min(begin + kPointsAtOnce, view.count);
    batch.load(query.surface.grid, view, begin, end);
    for (const bool isFar : {false, true}) {
      batch.sort(isFar);
      const size_t fewest = areSparse(batch.count(), tree) ? kFewestSparseAtOnce : kFewestAtOnce,
                   part = std::clamp(batch.count() / (8 * parallelThreads()), fewest, kMostAtOnce);
      const size_t parts = (batch.count() + part - 1) / part;
      parallelWorkers(parts, [&](const auto& next) {
        Answers answers(query);
        for (size_t k = next(); k < parts; k = next()) {
          const size_t from = k * part, to = std::min(from + part, batch.count());
          answers.answer(batch, from, to);
          progress.report(double(done += to - from) / double(view.count));
        }
      });
    }
    if (batch.hasNowhere()) fillRest(view, begin, end, query.result);
  }
}

}  // namespace

void queryPoints(const PreparedSurface& surface, const PointsView& view, const QueryOptions& options,
                 Progress& progress, QueryResult& result) {
  answerAll({surface, surface.isSigned, view, options, result}, progress);
}

void queryUnsigned(const PreparedSurface& surface, const PointsView& view, const QueryOptions& options,
                   Progress& progress, QueryResult& result) {
  answerAll({surface, false, view, options, result}, progress);
}

}  // namespace raymap::cpu
