#pragma once

#include <glm/glm.hpp>

namespace raymap {

/// Pieces in which a field is made.
enum class FieldForm {
  Whole,       ///< All samples at once.
  NarrowBand,  ///< Cubes of samples near the surface, and no others.
  Slabs        ///< Planes along z. A slab of them is written while the next is made.
};

/// A box of samples of a lattice.
struct Region {
  glm::ivec3 low{0};   ///< First sample.
  glm::ivec3 size{0};  ///< Number of samples along each axis.
};

/// Which arrays a region has besides the distance, and where its distances are clamped.
struct RegionOptions {
  double band = 0.0;        ///< Distances are clamped to this many samples; 0 = not clamped.
  bool triangle = false;    ///< Whether to compute closest triangles.
  bool winding = false;     ///< Whether to compute winding numbers. Needs a sign.
  bool confidence = false;  ///< Whether to compute the confidence in the sign. Needs a sign.
};

}  // namespace raymap
