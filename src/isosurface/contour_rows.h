#pragma once

#include <raymap/field.h>

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "isosurface/cube_cycles.h"

namespace raymap {

/// A cube between eight samples that the surface passes. Its lowest corner is sample (x - 1, y - 1, z - 1);
/// its row gives y and z.
struct ContourCube {
  int32_t x;
  uint8_t corners;    // Bits of the corners that are inside.
  uint8_t ambiguous;  // Bits of the ambiguous faces.
  uint8_t joined;     // Bits of the ambiguous faces whose inside corners are joined.
  CubeCycles cycles;
  uint32_t firstVertex;  // First of its vertices, one per sheet.
  uint32_t firstQuad;    // First of its quads, one per own edge that the surface crosses.

  /// Returns whether the surface crosses the cube's own edge along an axis. A cube owns the lattice edges
  /// that start at its lowest corner.
  bool isCrossed(int axis) const { return ((corners ^ corners >> (1 << axis)) & 1) != 0; }
  bool startsInside() const { return (corners & 1) != 0; }
};

/// The cubes that have corners inside and outside, in rows along x. Rows without cubes are left out.
struct ContourRows {
  struct Row {
    int z, y;
    auto operator<=>(const Row&) const = default;
  };

  std::vector<Row> rows = {};           ///< Ascending.
  std::vector<size_t> begin = {0};      ///< First cube of each row, and the number of cubes.
  std::vector<ContourCube> cubes = {};  ///< Ascending along each row.
};

/// Finds the cubes of a field, with their corners alone. Everything beyond the grid is outside. Of a narrow
/// band, looks where the surface may be: at leaves and at the sides of tiles. Reports to `progress` from any
/// thread.
ContourRows findCubes(const Field& field, double iso, Progress& progress);

}  // namespace raymap
