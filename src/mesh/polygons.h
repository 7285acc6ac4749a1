#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// Triangles of polygons between numbered vertices, whose positions may become known later.
class Polygons {
 public:
  void reserve(size_t polygons) { triangles.reserve(polygons); }
  /// Numbers the corners of all polygons from 0 on, to fill `cornerNumbers`. To be called before any is
  /// added.
  void trackCorners() { isTracking_ = true; }
  /// Appends a polygon as a fan of triangles around its first corner. Fewer than three corners are dropped.
  void add(std::span<const uint32_t> corners);
  /// Replaces the fans of polygons that they do not cover by triangles that do (see polygon.h). Returns the
  /// number of polygons that have none: they cross themselves, or their corners lie on a line.
  template <class Vec>
  size_t cut(const std::vector<Vec>& positions);
  /// Number of polygons that had fewer than three corners.
  size_t dropped() const { return dropped_; }

  std::vector<glm::uvec3> triangles;
  std::vector<glm::uvec3> cornerNumbers;  ///< The triangles by the numbers of corners.

 private:
  struct Fan {
    uint32_t first;  ///< Its first triangle.
    uint32_t corners;
  };
  struct Cuts;

  template <class Vec>
  void cutFan(size_t fan, const std::vector<Vec>& positions, Cuts& cuts) const;
  void replace(std::span<const Cuts> parts, std::vector<glm::uvec3> Cuts::*cut,
               std::vector<glm::uvec3>& fans) const;

  std::vector<Fan> fans_;  // Those of more than one triangle.
  size_t dropped_ = 0, cornerCount_ = 0;
  bool isTracking_ = false;
};

}  // namespace raymap
