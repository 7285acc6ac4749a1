#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cpu/distance/surface_tree.h"
#include "predicates/segment_triangle.h"

namespace raymap::cpu {

/// Returns a length that exceeds the rounding errors of all positions in a tree and on its lattice, in cells.
float slackOf(const SurfaceTree& tree, const glm::ivec3& dims);

/// Computes by how much the winding number changes on the straight way from a point to each of others nearby,
/// all in cell units: by +1 where the way enters a triangle of the tree through its front, by -1 where it
/// leaves through it. `slack` exceeds the rounding errors of all coordinates.
void countCrossings(const SurfaceTree& tree, const glm::vec3& from, std::span<const glm::vec3> to,
                    float slack, std::span<int32_t> change);

/// Finds all triangles of the tree that the segment between two points crosses if their coordinates change by
/// at most `slack`, and perhaps a few others.
void findTrianglesAlong(const SurfaceTree& tree, const glm::vec3& from, const glm::vec3& to, float slack,
                        std::vector<uint32_t>& triangles);

/// Triangles of a tree along each of several segments.
struct TrianglesAlong {
  std::vector<uint32_t> triangles;
  std::vector<size_t> begins;  ///< First of each segment, and at last the number of triangles.

  std::span<const uint32_t> operator[](size_t segment) const {
    return std::span(triangles).subspan(begins[segment], begins[segment + 1] - begins[segment]);
  }
};

/// Finds the triangles along segments that follow each other, near the one before. This is faster than to
/// search for each.
void findTrianglesAlong(const SurfaceTree& tree, std::span<const glm::vec3> from,
                        std::span<const glm::vec3> to, float slack, TrianglesAlong& found);

}  // namespace raymap::cpu
