#pragma once

#include <raymap/field.h>

namespace raymap {

/// Bounds distances outside of a field's box from below; see raymap/sample.h. All in sample coordinates.
class OutsideBound {
 public:
  explicit OutsideBound(const Field& field);

  /// Returns whether a point lies outside the box of the outermost samples.
  bool isOutside(const glm::dvec3& p) const;
  /// Returns a lower bound on the distance of a point outside the box.
  double at(const glm::dvec3& p) const;

 private:
  /// Lower bounds on the distances at two points.
  struct Bounds {
    double there, atBox;
  };

  Bounds fromSamples(const glm::dvec3& p, const glm::dvec3& q) const;

  const Field& field_;
  glm::dvec3 last_;
  Box surface_;          ///< Empty: not known.
  bool isHeld_ = false;  ///< Whether the box holds the surface.
};

}  // namespace raymap
