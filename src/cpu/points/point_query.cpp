#include "cpu/points/point_query.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "cpu/points/closest_point.h"
#include "cpu/points/nearest_triangles.h"

namespace raymap::cpu {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Most points that are sorted together. Their numbers leave room for their places on the curve.
constexpr size_t kBatch = size_t{1} << (64 - 3 * kCurveBits);

/// Most points that one thread answers at a time, and fewest.
constexpr size_t kMostAtOnce = 4096, kFewestAtOnce = 64;

/// Points farther from the grid than this many times its size are searched by themselves: the precision of a
/// search is that of its farthest point. Even farther ones are moved closer, to this distance. It hardly
/// matters there from which of two directions so close to each other one looks.
constexpr float kFar = 4.0f, kFarthest = 1e4f;

glm::dvec3 pointAt(const PointsView& view, size_t i) {
  const auto* bytes = static_cast<const std::byte*>(view.data) + i * view.stride;
  const auto read = [&]<class S>(S) {
    S p[3];
    std::memcpy(p, bytes, sizeof(p));
    return glm::dvec3(p[0], p[1], p[2]);
  };
  return view.scalar == PointsView::Scalar::Float ? read(float{}) : read(double{});
}

bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Spreads the bits of a number, so that two free ones follow each.
uint64_t spread(uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffull;
  v = (v | v << 16) & 0x001f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

/// Some points of a query, sorted along a curve.
class Batch {
 public:
  /// Takes those points numbered [begin, end) that are far from the grid, or the others.
  void take(const PreparedSurface& surface, const PointsView& view, size_t begin, size_t end, bool isFar) {
    begin_ = begin;
    const glm::vec3 dims(surface.grid.dims);
    const float size = std::max({dims.x, dims.y, dims.z});
    keys_.clear();
    cells_.resizeUninitialized(end - begin);
    parallelFor(end - begin, kMostAtOnce, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) cells_[i] = toCells(surface.grid, pointAt(view, begin + i), size);
    });
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (size_t i = 0; i < cells_.size(); ++i) {
      const glm::vec3& p = cells_[i];
      const glm::vec3 q = glm::abs(p - 0.5f * dims);
      const bool isNear = std::max({q.x, q.y, q.z}) <= kFar * size;
      if (std::isnan(p.x) || isNear == isFar) continue;
      keys_.push_back(i);
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    if (!keys_.empty()) sort(low, high);
  }

  size_t count() const { return keys_.size(); }
  SortedPoints sorted() const { return {points_, codes_, low_, side_}; }
  /// Returns the number of a sorted point in the query.
  size_t number(size_t k) const { return begin_ + keys_[k]; }

 private:
  static glm::vec3 toCells(const Grid& grid, const glm::dvec3& p, float size) {
    if (!isFinite(p)) return glm::vec3(NAN);
    glm::dvec3 q = (p - grid.origin) * (1.0 / grid.spacing);
    const double far = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)}),
                 most = double(kFarthest) * size;
    if (far > most) q = q / far * most;
    return glm::vec3(q);
  }

  void sort(const glm::vec3& low, const glm::vec3& high) {
    constexpr float kPlaces = 1 << kCurveBits;
    const glm::vec3 size = high - low;
    low_ = low;
    // All points lie within the cube in spite of rounding.
    side_ = std::max({size.x, size.y, size.z, 1e-20f}) * 1.0001f;
    const int shift = 64 - 3 * kCurveBits;
    parallelFor(keys_.size(), kMostAtOnce, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const glm::uvec3 place(
            glm::clamp((cells_[keys_[k]] - low) * (kPlaces / side_), 0.0f, kPlaces - 1.0f));
        keys_[k] |= (spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2) << shift;
      }
    });
    hwy::Sorter()(keys_.data(), keys_.size(), hwy::SortAscending());
    points_.resizeUninitialized(keys_.size());
    codes_.resizeUninitialized(keys_.size());
    parallelFor(keys_.size(), kMostAtOnce, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        codes_[k] = keys_[k] >> shift;
        keys_[k] &= kBatch - 1;
        points_[k] = cells_[keys_[k]];
      }
    });
  }

  size_t begin_ = 0;
  Buffer<glm::vec3> cells_, points_;
  std::vector<uint64_t> keys_;  // the point's number in the batch below its place on the curve
  Buffer<uint64_t> codes_;
  glm::vec3 low_{0.0f};
  float side_ = 0.0f;
};

/// Answers for one part of a batch after another. Each thread has its own instance.
class Answers {
 public:
  Answers(const PreparedSurface& surface, const PointsView& view, const QueryOptions& options,
          QueryResult& result)
      : surface_(surface), view_(view), options_(options), result_(result) {
    if (surface.isSigned)
      winding_.emplace(WindingSource{surface.mesh, surface.turns, surface.signTree(), surface.dipoles,
                                     surface.lattice, surface.threshold});
  }

  void answer(const Batch& batch, size_t begin, size_t end) {
    const size_t count = end - begin;
    nearest_.resize(count), exact_.resize(count), distances_.resize(count), numbers_.resize(count);
    const SortedPoints all = batch.sorted();
    const SortedPoints part{all.points.subspan(begin, count), all.codes.subspan(begin, count), all.low,
                            all.side};
    const double limit = options_.maxDistance / surface_.grid.spacing;
    findNearestTriangles(surface_.tree, part, static_cast<float>(limit), nearest_);
    for (size_t k = 0; k < count; ++k) {
      exact_[k] = pointAt(view_, batch.number(begin + k)) - surface_.mesh.origin;
      measure(k, batch.number(begin + k));
    }
    if (winding_) computeSigns(part.points, batch, begin);
  }

 private:
  /// Fills what follows from the closest triangle.
  void measure(size_t k, size_t number) {
    const uint32_t found = nearest_[k].triangle;
    TrianglePoint closest{glm::dvec3(kNaN), glm::dvec3(kNaN)};
    uint32_t triangle = kNoTriangle;
    double distance = INFINITY;
    if (found != kNoTriangle) {
      triangle = surface_.tree.triangleId(found);
      const glm::uvec3 face = surface_.mesh.triangles[triangle];
      closest = closestPoint(exact_[k], corner(face.x), corner(face.y), corner(face.z));
      distance = glm::length(exact_[k] - closest.position);
    }
    distances_[k] = static_cast<float>(distance / surface_.grid.spacing);
    if (distance > options_.maxDistance || found == kNoTriangle) {
      distance = options_.maxDistance;
      triangle = kNoTriangle;
      closest = {glm::dvec3(kNaN), glm::dvec3(kNaN)};
    }
    if (options_.distance) result_.distance[number] = distance;
    if (options_.closest) result_.closest[number] = closest.position + surface_.mesh.origin;
    if (options_.triangle) result_.triangle[number] = triangle;
    if (options_.barycentric) result_.barycentric[number] = closest.weights;
    if (options_.direction)
      result_.direction[number] =
          distance > 0.0 ? (closest.position - exact_[k]) / distance : glm::dvec3(0.0);
  }

  glm::dvec3 corner(uint32_t vertex) const { return glm::dvec3(surface_.mesh.vertices[vertex]); }

  void computeSigns(std::span<const glm::vec3> cells, const Batch& batch, size_t begin) {
    const WindingPoints points{cells, exact_, distances_};
    if (options_.winding)
      winding_->computeClosely(points, numbers_);
    else
      winding_->compute(points, numbers_);
    for (size_t k = 0; k < cells.size(); ++k) {
      const size_t number = batch.number(begin + k);
      const bool isInside = std::abs(numbers_[k]) > static_cast<float>(surface_.threshold);
      if (options_.distance && isInside) result_.distance[number] = -result_.distance[number];
      if (options_.winding) result_.winding[number] = numbers_[k];
      if (options_.confidence)
        result_.confidence[number] = surface_.lattice.confidence[winding_->nearestSample(cells[k])];
    }
  }

  const PreparedSurface& surface_;
  const PointsView& view_;
  const QueryOptions& options_;
  QueryResult& result_;
  std::optional<PointWinding> winding_;
  std::vector<NearestTriangle> nearest_;
  std::vector<glm::dvec3> exact_;
  std::vector<float> distances_, numbers_;
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

}  // namespace

size_t PreparedSurface::bytes() const {
  return tree.bytes() + (turnedTree ? turnedTree->bytes() : 0) + turns.capacity() + dipoles.bytes() +
         lattice.distance.capacityBytes() + lattice.winding.capacityBytes() +
         lattice.confidence.capacityBytes() + lattice.isNearRim.capacityBytes();
}

void queryPoints(const PreparedSurface& surface, const PointsView& view, const QueryOptions& options,
                 Progress& progress, QueryResult& result) {
  sizeResult(options, view.count, result);
  Batch batch;
  std::atomic<size_t> done{0};
  for (size_t begin = 0; begin < view.count; begin += kBatch) {
    const size_t end = std::min(begin + kBatch, view.count);
    for (const bool isFar : {false, true}) {
      batch.take(surface, view, begin, end, isFar);
      const size_t part = std::clamp(batch.count() / (8 * parallelThreads()), kFewestAtOnce, kMostAtOnce);
      const size_t parts = (batch.count() + part - 1) / part;
      parallelWorkers(parts, [&](const auto& next) {
        Answers answers(surface, view, options, result);
        for (size_t k = next(); k < parts; k = next()) {
          const size_t from = k * part, to = std::min(from + part, batch.count());
          answers.answer(batch, from, to);
          progress.report(double(done += to - from) / double(view.count));
        }
      });
    }
    fillRest(view, begin, end, result);
  }
}

}  // namespace raymap::cpu
