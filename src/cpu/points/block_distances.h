#pragma once

#include <span>
#include <vector>

#include "cpu/points/closest_point.h"
#include "cpu/points/nearest_triangles.h"
#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// A cube of lattice points.
struct LatticeBlock {
  glm::dvec3 low;  ///< The first point.
  int side;        ///< Points along its side, a power of two.
  double spacing;  ///< From one to the next.
};

/// Measures unsigned distances as `queryUnsigned` does, to the same bits, of points that need no sorting.
/// Each thread has its own instance.
class BlockDistances {
 public:
  explicit BlockDistances(const PreparedSurface& surface) : surface_(surface) {}

  /// Fills the distances and triangles of points of a block. `codes` has the place of each in the block on a
  /// Morton curve, ascending, x lowest. Beyond `most` points get that distance and no triangle.
  void find(const LatticeBlock& block, std::span<const glm::dvec3> points, std::span<const uint16_t> codes,
            double most, std::span<double> distances, std::span<uint32_t> triangles);

 private:
  const PreparedSurface& surface_;
  std::vector<glm::vec3> cells_;
  std::vector<uint64_t> codes_;
  std::vector<NearestTriangle> nearest_;
  std::vector<uint32_t> near_, nearTriangles_;
  std::vector<glm::dvec3> nearPoints_;
  std::vector<TrianglePoint> closest_;
};

}  // namespace raymap::cpu
