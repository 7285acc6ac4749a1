#pragma once

#include <raymap/field.h>

#include <functional>

namespace raymap {

/// Bounds distances outside of a field's box from below; see raymap/sample.h. All in sample coordinates.
class OutsideBound {
 public:
  /// Returns the distance of a sample, in the mesh's units.
  using Read = std::function<float(const glm::ivec3& sample)>;

  /// `clampDistance` is that of a field.
  OutsideBound(const Grid& grid, const Box& surfaceBounds, double clampDistance);

  /// Returns whether a point lies outside the box of the outermost samples.
  bool isOutside(const glm::dvec3& p) const;
  /// Returns a lower bound on the distance of a point outside the box.
  double at(const glm::dvec3& p, const Read& read) const;

 private:
  /// Lower bounds on the distances at two points.
  struct Bounds {
    double there, atBox;
  };

  Bounds fromSamples(const glm::dvec3& p, const glm::dvec3& q, const Read& read) const;

  glm::ivec3 dims_;
  glm::dvec3 last_;
  double spacing_;
  double lowest_;        ///< Distances up to this one may be clamped.
  Box surface_;          ///< Empty: not known.
  bool isHeld_ = false;  ///< Whether the box holds the surface.
};

}  // namespace raymap
