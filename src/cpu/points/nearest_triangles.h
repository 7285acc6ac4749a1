#pragma once

#include <raymap/field.h>

#include <cstdint>
#include <span>

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Bits per axis of a place on the curve.
inline constexpr int kCurveBits = 14;

/// Points in cell units, in the order of a Morton curve through a cube.
struct SortedPoints {
  std::span<const glm::vec3> points;
  std::span<const uint64_t> codes;  ///< Place of each point on the curve, `kCurveBits` per axis, x lowest.
  glm::vec3 low{0.0f};              ///< Lowest corner of the cube.
  float side = 0.0f;                ///< Its side.
  bool areSparse = false;           ///< Whether each is better searched for by itself.
};

/// Returns whether points that are spread along a surface are so few that blocks of them save no time. The
/// power was measured on bunnies of 69,000 and 1.1 million triangles, whose limits are 4000 to 8000 and
/// 30,000 to 50,000 points.
bool areSparse(size_t points, const SurfaceTree& tree);

/// Triangle of a tree, and its squared distance in cells.
struct NearestTriangle {
  float squared;
  uint32_t triangle;
};

/// Finds the closest triangle to each point. Of triangles that are equally close in single precision, it
/// takes the one that is lowest in the tree. So the result for a point does not depend on the other points.
/// Points that are farther than `most` cells may get `kNoTriangle`.
void findNearestTriangles(const SurfaceTree& tree, const SortedPoints& sorted, float most,
                          std::span<NearestTriangle> nearest);

}  // namespace raymap::cpu
