#pragma once

#include <span>
#include <vector>

#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// On which side of the surface something lies, as far as it is known.
enum class Side : uint8_t { Outside, Inside, Unknown };

/// Some of the points of a cube, that lie on a lattice in it.
struct BlockPoints {
  static constexpr int kMostSide = 16;  ///< Most points along the side of a cube, a power of two.

  int side = kMostSide;  ///< Points along the side of each cube.
  double spacing = 0.0;  ///< From one to the next, in the mesh's units.
  double reach = 0.0;    ///< Radius of a ball about each point whose side is asked for, too.
  std::span<const glm::dvec3> points;
  std::span<const double> distances;  ///< A lower bound on the distance of each point, not negative.
  /// Place of each point in its cube, x fastest. The points of a cube follow each other, in any order.
  std::span<const uint16_t> places;
  std::span<const size_t> begins;  ///< First point of each cube, and at last the number of points.
};

/// Finds the sides of points. Those that see each other share one winding number, so that few of them are
/// queried. `Side::Unknown` is left where rounding could decide, or the number may pass the threshold within
/// `reach`. Uses all threads of the caller's arena.
void findSides(const PreparedSurface& surface, const BlockPoints& blocks, std::span<Side> sides);

}  // namespace raymap::cpu
