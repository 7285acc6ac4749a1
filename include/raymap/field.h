#pragma once

#include <raymap/buffer.h>
#include <raymap/grid.h>

#include <cstdint>

namespace raymap {

/// A sampled signed distance field. Arrays hold one value per sample, x fastest; see `Grid::index`. Arrays
/// that were not asked for are empty.
struct Field {
  Grid grid = {};
  Buffer<float> distance = {};     ///< In the mesh's units, negative inside, positive outside.
  Buffer<uint32_t> triangle = {};  ///< Index of the closest triangle, or `kNoTriangle`.
  Buffer<float> winding = {};      ///< Winding number, +1 inside a closed surface that faces outwards.
  Buffer<float> confidence = {};   ///< Confidence in the sign, 0 to 1.
  /// Distances are clamped to +-this, in the mesh's units; 0 = not clamped. `FieldOptions::band` times the
  /// spacing.
  double clampDistance = 0.0;
  /// Bounds of the surface that distances lead to, in the mesh's units; empty if they are not known. They
  /// tell what may lie outside the grid; see raymap/sample.h.
  Box surfaceBounds = {};
};

/// One of a field's arrays.
enum class FieldArray { Distance, Winding, Confidence, Triangle };

/// Value of `Field::triangle` where the distance is clamped, and where surface that closes a hole is closer.
inline constexpr uint32_t kNoTriangle = 0xffffffffu;

}  // namespace raymap
