#pragma once

#include <raymap/picture.h>

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "picture/drawn_field.h"
#include "picture/sphere_trace_shared.h"

namespace raymap {

/// Returns a plane in sample coordinates, with a unit normal. Throws `Error(Usage)` if it has none.
Plane toSamples(const Plane& plane, const Grid& grid);

/// Bounds of a solid, in sample coordinates.
struct Extent {
  glm::dvec3 min{INFINITY};
  glm::dvec3 max{-INFINITY};
  double deepest = INFINITY;  ///< Smallest value, in samples.
};

/// The solid that a field bounds, with the modifiers of Krayer & Müller 2019, Fig. 1 (hollowed out, cut in
/// half). It is a signed distance bound of its own; intersections are maxima. Units as in `DrawnField`.
class Shape {
 public:
  /// Keeps a reference to the field. Throws `Error(Usage)`, and `Error(Input)` if a sample is not finite. If
  /// a field's samples are on a device, `Field::distance` is empty: the field must be signed and the options
  /// must give the frame.
  Shape(DrawnField field, const RenderOptions& options);

  double distance(const glm::dvec3& p) const {
    const double d = hollowed(field_.value(p));
    return cut_ ? std::max(d, cutDistance(p)) : d;
  }
  /// Returns how far a ray may go on from a point whose distance is `d`, without meeting the surface: a share
  /// of the distance, or to the end of a plateau of the field.
  double step(const glm::dvec3& p, const glm::dvec3& direction, double d) const {
    const double near = kCaution * d;
    const std::optional<DrawnField::Plateau> plateau = field_.plateau(p, direction);
    return plateau && hollowed(plateau->value) > 0.0 ? std::max(near, plateau->length) : near;
  }
  /// Returns the distance for occlusion, stretched to infinity where a banded field only means "far".
  double openDistance(const glm::dvec3& p) const {
    const double d = distance(p);
    return band_ > 0.0 && d > 0.0 ? d / std::max(1.0 - d / band_, 1e-6) : d;
  }
  /// Returns whether a distance in the field only means "far".
  bool isClamped(double d) const {
    const double band = d > 0.0 ? band_ : innerBand_;
    return band > 0.0 && std::abs(d) > kClampedShare * band;
  }
  /// Returns the distance in the field itself, before any modifier.
  double fieldDistance(const glm::dvec3& p) const { return field_.value(p) - level_; }

  /// Returns the outward unit normal at a point of the surface.
  glm::dvec3 normal(const glm::dvec3& p) const;
  bool isOnCutFace(const glm::dvec3& p) const { return cut_ && std::abs(cutDistance(p)) < kCutTolerance; }

  /// Returns how far the shape reaches along each unit direction, from sample (0,0,0).
  std::vector<double> reach(std::span<const glm::dvec3> directions) const;

  /// Returns the largest depth of the material, in samples; never 0.
  double depth() const {
    const double solid = std::max(level_ - extent_.deepest, 1e-9);
    return wall_ > 0.0 ? std::min(wall_, solid) : solid;
  }
  const DrawnField& field() const { return field_; }
  double level() const { return level_; }  ///< Value of the field that is drawn as the surface, in samples.
  double wall() const { return wall_; }    ///< Thickness of the wall, in samples; 0 for a solid.
  /// Returns the distance from the surface to where the band ends outside, in samples; 0 for none.
  double band() const { return band_; }
  double innerBand() const { return innerBand_; }  ///< The same inside.
  /// Returns whether everything above `cutOffset` along `cutNormal` is cut away.
  bool isCut() const { return cut_; }
  const glm::dvec3& cutNormal() const { return cutNormal_; }
  double cutOffset() const { return cutOffset_; }
  glm::dvec3 centre() const { return 0.5 * (extent_.min + extent_.max); }
  double radius() const { return 0.5 * glm::length(extent_.max - extent_.min); }

 private:
  /// Returns the distance of the hollowed shape where the field has this value.
  double hollowed(double value) const {
    const double d = value - level_;
    return wall_ > 0.0 ? std::max(d, -(d + wall_)) : d;
  }
  std::vector<double> reachOfFrame(std::span<const glm::dvec3> directions) const;
  double cutDistance(const glm::dvec3& p) const { return glm::dot(cutNormal_, p) - cutOffset_; }

  DrawnField field_;
  double level_;
  double wall_;
  double band_ = 0.0, innerBand_ = 0.0;
  Extent extent_;
  bool isFramed_;
  bool cut_;
  glm::dvec3 cutNormal_{0.0};
  double cutOffset_ = 0.0;
};

}  // namespace raymap
