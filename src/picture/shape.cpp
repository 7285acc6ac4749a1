#include <raymap/error.h>
#include <raymap/picture.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "picture/camera.h"
#include "picture/shape.h"

namespace raymap {

namespace {

/// Values up to this one, in samples, are inside if no sample is negative. On a plane between samples,
/// trilinear values are up to 0.5.
constexpr double kSkin = 0.7;

/// Returns the width of a band as a text; 0 means none.
std::string bandText(double width) {
  return numberText(std::isfinite(width) ? width : 0.0);
}

[[noreturn]] void refuseSample(glm::ivec3 sample, float value) {
  throw Error(ErrorCode::Input,
              "sample (" + std::to_string(sample.x) + ", " + std::to_string(sample.y) + ", " +
                  std::to_string(sample.z) + ") of the field is " + numberText(value) +
                  ": a field to draw must be finite, in samples too; make it again or replace the value");
}

/// Visits samples of a field with d <= 0, as positions and values. The solid contains a ball of radius -d
/// around each. The grid's box cuts the solid off, and so the balls.
class InsideSamples {
 public:
  InsideSamples(const DrawnField& field, double level)
      : field_(field), level_(level), scale_(1.0 / field.grid().spacing), last_(field.last()) {}

  /// Calls `merge(part)` for each `part = visitSome(visitor)`. The visitor takes a function
  /// `visit(position, d)`, which it calls for all samples of a part of the field, and returns the least
  /// value. Parts are visited in parallel, in any order.
  template <class VisitSome, class Merge>
  void forEachPart(VisitSome&& visitSome, Merge&& merge) const {
    const auto& band = field_.field().narrow;
    const size_t count = band ? band->leaves.size() + band->tiles.size() : size_t(field_.grid().dims.z);
    std::mutex isMerging;
    parallelFor(count, band ? kLeavesPerTask : 1, [&](size_t begin, size_t end) {
      const auto part = visitSome([&](auto&& visit) {
        double least = INFINITY;
        for (size_t n = begin; n < end; ++n) least = std::min(least, visitOne(n, visit));
        return least;
      });
      const std::lock_guard lock(isMerging);
      merge(part);
    });
  }

 private:
  static constexpr size_t kLeavesPerTask = 256;

  /// Visits a sheet, a leaf or a tile.
  template <class Visit>
  double visitOne(size_t n, Visit&& visit) const {
    const Field& field = field_.field();
    const auto& band = field.narrow;
    if (!band) return visitSheet(field, int(n), visit);
    if (n < band->leaves.size()) return visitLeaf(field, n, visit);
    return visitTile(field, band->tiles[n - band->leaves.size()], visit);
  }

  template <class Visit>
  double visitSheet(const Field& field, int k, Visit&& visit) const {
    double least = INFINITY;
    const float* value = field.distance.data() + field.grid.index({0, 0, k});
    for (int j = 0; j < field.grid.dims.y; ++j)
      for (int i = 0; i < field.grid.dims.x; ++i)
        least = std::min(least, visitSample({i, j, k}, *value++, visit));
    return least;
  }

  template <class Visit>
  double visitLeaf(const Field& band, size_t leaf, Visit&& visit) const {
    const glm::ivec3 low = band.narrow->leaves[leaf],
                     high = glm::min(low + NarrowBand::kLeafSide, band.grid.dims);
    const SparseBlock block{band.distance.data() + leaf * NarrowBand::kLeafSamples, 0.0f};
    double least = INFINITY;
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x)
          least = std::min(least, visitSample({x, y, z}, block.at({x, y, z}), visit));
    return least;
  }

  /// Visits the corners alone: no other sample of a tile reaches farther in any direction.
  template <class Visit>
  double visitTile(const Field& band, const NarrowBand::Tile& tile, Visit&& visit) const {
    const glm::ivec3 high = glm::min(tile.low + tile.side, band.grid.dims) - 1;
    double least = INFINITY;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 sample(corner & 1 ? high.x : tile.low.x, corner & 2 ? high.y : tile.low.y,
                              corner & 4 ? high.z : tile.low.z);
      least = std::min(least, visitSample(sample, -float(band.narrow->inside), visit));
    }
    return least;
  }

  template <class Visit>
  double visitSample(const glm::ivec3& sample, float value, Visit&& visit) const {
    const double d = value * scale_ - level_;
    if (!std::isfinite(d)) refuseSample(sample, value);
    if (d > 0.0) return d;
    const glm::dvec3 p(sample), toBorder = glm::min(p, last_ - p);
    visit(p, std::max(d, -std::min({toBorder.x, toBorder.y, toBorder.z})));
    return d;
  }

  const DrawnField& field_;
  double level_, scale_;
  glm::dvec3 last_;
};

Extent findExtent(const DrawnField& field, double level) {
  Extent all;
  InsideSamples(field, level)
      .forEachPart(
          [](auto&& visitAll) {
            Extent part;
            part.deepest = visitAll([&](const glm::dvec3& p, double d) {
              part.min = glm::min(part.min, p + d);
              part.max = glm::max(part.max, p - d);
            });
            return part;
          },
          [&](const Extent& part) {
            all.min = glm::min(all.min, part.min);
            all.max = glm::max(all.max, part.max);
            all.deepest = std::min(all.deepest, part.deepest);
          });
  return all;
}

/// Returns the extent that the camera frames, in samples. Its depth is half its shortest side.
Extent frameExtent(const Box& frame, const Grid& grid) {
  const glm::dvec3 size = frame.size();
  if (frame.isEmpty() || !std::isfinite(size.x + size.y + size.z) || size == glm::dvec3(0.0))
    throw Error(ErrorCode::Usage, "the box to frame has no size; give one around the shape");
  return {.min = (frame.min - grid.origin) / grid.spacing,
          .max = (frame.max - grid.origin) / grid.spacing,
          .deepest = -0.5 * std::min({size.x, size.y, size.z}) / grid.spacing};
}

/// Returns the horizontal grid axis that points most to the camera, as the cut's normal.
glm::dvec3 cutAxis(const glm::dvec3& direction, const glm::dvec3& up) {
  int axis = -1;
  int vertical = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(up[a]) > std::abs(up[vertical])) vertical = a;
  for (int a = 0; a < 3; ++a)
    if (a != vertical && (axis < 0 || std::abs(direction[a]) > std::abs(direction[axis]))) axis = a;
  glm::dvec3 normal(0.0);
  normal[axis] = direction[axis] > 0.0 ? -1.0 : 1.0;
  return normal;
}

}  // namespace

Plane toSamples(const Plane& plane, const Grid& grid) {
  const glm::dvec3 normal = unitVector(plane.normal, "normal of the plane");
  const double offset = plane.offset / glm::length(plane.normal) - glm::dot(normal, grid.origin);
  if (!std::isfinite(offset)) throw Error(ErrorCode::Usage, "the offset of the plane must be finite");
  return {.normal = normal, .offset = offset / grid.spacing};
}

Shape::Shape(DrawnField field, const RenderOptions& options)
    : field_(std::move(field)),
      level_(options.iso / field_.grid().spacing),
      wall_(options.shell / field_.grid().spacing),
      isFramed_(options.frame.has_value()),
      cut_(options.cut || options.cutPlane) {
  if (!std::isfinite(level_) || options.iso <= -field_.inside() || options.iso >= field_.outside())
    throw Error(ErrorCode::Usage, "no surface can be drawn at the distance " + numberText(options.iso) +
                                      ": it must be finite, and less than the field's band (" +
                                      bandText(options.iso > 0.0 ? field_.outside() : field_.inside()) +
                                      ") if it has one");
  if (field_.hasSamples()) extent_ = findExtent(field_, level_);
  if (!(options.shell >= 0.0) || (options.shell > 0.0 && options.shell >= field_.inside()))
    throw Error(ErrorCode::Usage, "a shell of " + numberText(options.shell) +
                                      " cannot be drawn: it must not be negative, and thinner than the " +
                                      "field's band (" + bandText(field_.inside()) + ") if it has one");
  if (extent_.deepest >= 0.0 && options.iso == 0.0 && field_.hasSamples()) {
    level_ = kSkin;
    extent_ = findExtent(field_, level_);
  }
  const double spacing = field_.grid().spacing;
  if (std::isfinite(field_.outside())) band_ = field_.outside() / spacing - level_;
  if (std::isfinite(field_.inside())) innerBand_ = field_.inside() / spacing + level_;
  if (isFramed_) extent_ = frameExtent(*options.frame, field_.grid());
  if (glm::any(glm::greaterThan(extent_.min, extent_.max))) {  // Nothing is inside: frame the grid.
    extent_.min = glm::dvec3(0.0);
    extent_.max = field_.last();
  }
  if (options.cutPlane) {
    const Plane plane = toSamples(*options.cutPlane, field_.grid());
    cutNormal_ = plane.normal;
    cutOffset_ = plane.offset;
  } else {
    cutNormal_ = cutAxis(options.direction, options.up);
    cutOffset_ = glm::dot(cutNormal_, centre());
  }
}

std::vector<double> Shape::reach(std::span<const glm::dvec3> directions) const {
  if (isFramed_) return reachOfFrame(directions);
  std::vector<double> all(directions.size(), -INFINITY);
  InsideSamples(field_, level_)
      .forEachPart(
          [&](auto&& visitAll) {
            std::vector<double> part(directions.size(), -INFINITY);
            visitAll([&](const glm::dvec3& p, double d) {
              const double depth = cut_ ? std::max(d, cutDistance(p)) : d;
              if (depth > 0.0) return;
              for (size_t n = 0; n < part.size(); ++n)
                part[n] = std::max(part[n], glm::dot(directions[n], p) - depth);
            });
            return part;
          },
          [&](const std::vector<double>& part) {
            for (size_t n = 0; n < all.size(); ++n) all[n] = std::max(all[n], part[n]);
          });
  for (size_t n = 0; n < all.size(); ++n)
    if (all[n] == -INFINITY)  // Nothing is inside.
      all[n] = glm::dot(directions[n], centre()) + radius();
  return all;
}

std::vector<double> Shape::reachOfFrame(std::span<const glm::dvec3> directions) const {
  std::vector<double> all;
  for (const glm::dvec3& direction : directions) {
    const glm::dvec3 corner(direction.x > 0.0 ? extent_.max.x : extent_.min.x,
                            direction.y > 0.0 ? extent_.max.y : extent_.min.y,
                            direction.z > 0.0 ? extent_.max.z : extent_.min.z);
    all.push_back(glm::dot(direction, corner));
  }
  return all;
}

glm::dvec3 Shape::normal(const glm::dvec3& p) const {
  if (isOnCutFace(p)) return cutNormal_;
  const glm::dvec3 gradient = field_.gradient(p);
  const double length = glm::length(gradient);
  if (!(length > 0.0)) return {0.0, 0.0, 1.0};  // On a plateau any normal will do.
  const double d = fieldDistance(p);
  const bool isInnerWall = wall_ > 0.0 && -(d + wall_) > d;
  return (isInnerWall ? -1.0 : 1.0) / length * gradient;
}

}  // namespace raymap
