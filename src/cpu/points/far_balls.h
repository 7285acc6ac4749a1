#pragma once

#include <cstdint>
#include <span>

#include "base/progress.h"
#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// The side on which all points of a ball lie beyond the band, or `Near` if some may not.
enum class BallSide : uint8_t { Outside, Inside, Near };

/// Finds balls that lie wholly beyond a band around a surface, by queries of their centres.
class FarBalls {
 public:
  /// `width` is the band's width on each side, in the mesh's units.
  FarBalls(const PreparedSurface& surface, double radius, double width);

  /// Fills the side of each ball.
  void find(std::span<const glm::dvec3> centres, Progress& progress, std::span<BallSide> sides);

 private:
  void doubt(std::span<const glm::dvec3> centres, Progress& progress, std::span<BallSide> sides);
  bool isSettled(const glm::dvec3& centre, double winding) const;

  const PreparedSurface& surface_;
  double radius_;
  double far_;  ///< Smallest distance of the centre of a ball beyond the band.
  QueryResult found_;
};

}  // namespace raymap::cpu
