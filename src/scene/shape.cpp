#include <raymap/error.h>
#include <raymap/picture.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "scene/camera.h"
#include "scene/shape.h"

namespace raymap {

namespace {

/// Values up to this one, in samples, are inside if no sample is negative. On a plane between samples,
/// trilinear values are up to 0.5.
constexpr double kSkin = 0.7;

[[noreturn]] void refuseSample(glm::ivec3 sample, float value) {
  throw Error(ErrorCode::Input,
              "sample (" + std::to_string(sample.x) + ", " + std::to_string(sample.y) + ", " +
                  std::to_string(sample.z) + ") of the field is " + numberText(value) +
                  ": a field to draw must be finite, in samples too; make it again or replace the value");
}

/// Calls `visit(position, d)` for every sample of a sheet with d <= 0. The solid contains a ball of radius -d
/// around it. Returns the least value. The grid's box cuts the solid off, and so the balls.
template <class Visit>
double visitInside(const Field& field, int k, double level, Visit&& visit) {
  double least = INFINITY;
  const double scale = 1.0 / field.grid.spacing;
  const glm::dvec3 last(field.grid.dims - 1);
  const float* value = field.distance.data() + field.grid.index({0, 0, k});
  for (int j = 0; j < field.grid.dims.y; ++j)
    for (int i = 0; i < field.grid.dims.x; ++i, ++value) {
      const double d = *value * scale - level;
      if (!std::isfinite(d)) refuseSample({i, j, k}, *value);
      least = std::min(least, d);
      if (d > 0.0) continue;
      const glm::dvec3 p(i, j, k);
      const glm::dvec3 toBorder = glm::min(p, last - p);
      visit(p, std::max(d, -std::min({toBorder.x, toBorder.y, toBorder.z})));
    }
  return least;
}

Extent findExtent(const Field& field, double level) {
  std::vector<Extent> sheets(size_t(field.grid.dims.z));
  parallelFor(sheets.size(), 1, [&](size_t k, size_t) {
    Extent& sheet = sheets[k];
    sheet.deepest = visitInside(field, int(k), level, [&](const glm::dvec3& p, double d) {
      sheet.min = glm::min(sheet.min, p + d);
      sheet.max = glm::max(sheet.max, p - d);
    });
  });
  Extent all;
  for (const Extent& sheet : sheets) {
    all.min = glm::min(all.min, sheet.min);
    all.max = glm::max(all.max, sheet.max);
    all.deepest = std::min(all.deepest, sheet.deepest);
  }
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

Shape::Shape(const Field& field, const RenderOptions& options)
    : field_(field),
      sampler_(field),
      level_(options.iso / field.grid.spacing),
      wall_(options.shell / field.grid.spacing),
      band_(field.clampDistance / field.grid.spacing),
      isFramed_(options.frame.has_value()),
      cut_(options.cut || options.cutPlane) {
  if (!std::isfinite(level_) || (field.clampDistance > 0.0 && std::abs(options.iso) >= field.clampDistance))
    throw Error(ErrorCode::Usage, "no surface can be drawn at the distance " + numberText(options.iso) +
                                      ": it must be finite, and less than the field's band (" +
                                      numberText(field.clampDistance) + ") if it has one");
  if (!field.distance.empty()) extent_ = findExtent(field, level_);
  if (!(options.shell >= 0.0) || (field.clampDistance > 0.0 && options.shell >= field.clampDistance))
    throw Error(ErrorCode::Usage, "a shell of " + numberText(options.shell) +
                                      " cannot be drawn: it must not be negative, and thinner than the " +
                                      "field's band (" + numberText(field.clampDistance) + ") if it has one");
  if (extent_.deepest >= 0.0 && options.iso == 0.0 && !field.distance.empty()) {
    level_ = kSkin;
    extent_ = findExtent(field, level_);
  }
  if (isFramed_) extent_ = frameExtent(*options.frame, field.grid);
  if (glm::any(glm::greaterThan(extent_.min, extent_.max))) {  // Nothing is inside: frame the grid.
    extent_.min = glm::dvec3(0.0);
    extent_.max = sampler_.last();
  }
  if (options.cutPlane) {
    const Plane plane = toSamples(*options.cutPlane, field.grid);
    cutNormal_ = plane.normal;
    cutOffset_ = plane.offset;
  } else {
    cutNormal_ = cutAxis(options.direction, options.up);
    cutOffset_ = glm::dot(cutNormal_, centre());
  }
}

std::vector<double> Shape::reach(std::span<const glm::dvec3> directions) const {
  if (isFramed_) return reachOfFrame(directions);
  std::vector<std::vector<double>> sheets(size_t(field_.grid.dims.z));
  parallelFor(sheets.size(), 1, [&](size_t k, size_t) {
    sheets[k].assign(directions.size(), -INFINITY);
    visitInside(field_, int(k), level_, [&](const glm::dvec3& p, double d) {
      const double depth = cut_ ? std::max(d, cutDistance(p)) : d;
      if (depth > 0.0) return;
      for (size_t n = 0; n < directions.size(); ++n)
        sheets[k][n] = std::max(sheets[k][n], glm::dot(directions[n], p) - depth);
    });
  });
  std::vector<double> all(directions.size(), -INFINITY);
  for (size_t n = 0; n < all.size(); ++n) {
    for (const std::vector<double>& sheet : sheets) all[n] = std::max(all[n], sheet[n]);
    if (all[n] == -INFINITY)  // Nothing is inside.
      all[n] = glm::dot(directions[n], centre()) + radius();
  }
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
  const glm::dvec3 gradient = sampler_.gradient(p);
  const double length = glm::length(gradient);
  if (!(length > 0.0)) return {0.0, 0.0, 1.0};  // On a plateau any normal will do.
  const double d = fieldDistance(p);
  const bool isInnerWall = wall_ > 0.0 && -(d + wall_) > d;
  return (isInnerWall ? -1.0 : 1.0) / length * gradient;
}

}  // namespace raymap
