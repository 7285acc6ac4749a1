#pragma once

#include <raymap/render.h>

#include <algorithm>
#include <span>
#include <vector>

#include "field/field_sampler.h"

namespace raymap {

/// Where a solid lies, in sample coordinates.
struct Extent {
  glm::dvec3 min{INFINITY};
  glm::dvec3 max{-INFINITY};
  double deepest = INFINITY;  ///< Smallest value, in samples.
};

/// The solid that a field bounds, with the modifiers of the paper's Fig. 1 (hollowed out, cut in half), as a
/// signed distance bound of its own: maximum for intersection. Units as in `FieldSampler`.
class Shape {
 public:
  /// Refers to the field. Throws `Error(Usage)`, and `Error(Input)` if a sample is not finite. A field whose
  /// samples lie on a device has none here: it must be signed, and the options must say what to frame.
  Shape(const Field& field, const RenderOptions& options);

  double distance(const glm::dvec3& p) const {
    double d = sampler_.value(p) - level_;
    if (wall_ > 0.0) d = std::max(d, -(d + wall_));
    if (cut_) d = std::max(d, cutDistance(p));
    return d;
  }
  /// The distance, stretched to infinity where a banded field only says "far": what occlusion wants to know.
  double openDistance(const glm::dvec3& p) const {
    const double d = distance(p);
    return band_ > 0.0 && d > 0.0 ? d / std::max(1.0 - d / band_, 1e-6) : d;
  }
  /// Distance in the field itself, before any modifier.
  double fieldDistance(const glm::dvec3& p) const { return sampler_.value(p) - level_; }

  /// Outward unit normal at a point of the surface.
  glm::dvec3 normal(const glm::dvec3& p) const;
  bool isOnCutFace(const glm::dvec3& p) const { return cut_ && std::abs(cutDistance(p)) < 1e-2; }

  /// How far the shape reaches along each unit direction, from sample (0,0,0).
  std::vector<double> reach(std::span<const glm::dvec3> directions) const;

  /// How deep the material is where it is deepest; never 0.
  double depth() const {
    const double solid = std::max(level_ - extent_.deepest, 1e-9);
    return wall_ > 0.0 ? std::min(wall_, solid) : solid;
  }
  const Field& field() const { return field_; }
  double level() const { return level_; }  ///< The field's value that is drawn as surface.
  double wall() const { return wall_; }    ///< 0: solid.
  double band() const { return band_; }    ///< 0: none.
  /// What lies above `cutOffset` along `cutNormal` is cut away, if `isCut`.
  bool isCut() const { return cut_; }
  const glm::dvec3& cutNormal() const { return cutNormal_; }
  double cutOffset() const { return cutOffset_; }
  glm::dvec3 centre() const { return 0.5 * (extent_.min + extent_.max); }
  double radius() const { return 0.5 * glm::length(extent_.max - extent_.min); }

 private:
  std::vector<double> reachOfFrame(std::span<const glm::dvec3> directions) const;
  double cutDistance(const glm::dvec3& p) const { return glm::dot(cutNormal_, p) - cutOffset_; }

  const Field& field_;
  FieldSampler sampler_;
  double level_;  // the value drawn as surface
  double wall_;
  double band_;
  Extent extent_;
  bool isFramed_;
  bool cut_;
  glm::dvec3 cutNormal_{0.0};
  double cutOffset_ = 0.0;
};

}  // namespace raymap
