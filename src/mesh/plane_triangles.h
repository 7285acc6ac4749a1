#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "predicates/exact_points.h"

namespace raymap {

/// Triangles that cover points and edges of a plane, in the frame of `ExactPoints`. Seen along an axis they
/// turn counter-clockwise.
class PlaneTriangles {
 public:
  PlaneTriangles(const ExactPoints& points, int axis);

  /// Adds a point that is new.
  void addPoint(uint32_t point);
  /// Makes an edge between two points. No other point may lie on it, and no other such edge cross it.
  /// Returns false if one does.
  bool addEdge(uint32_t from, uint32_t to);
  /// Returns the triangles. Edges that were not asked for are flipped where that makes angles less sharp.
  std::vector<glm::uvec3> triangles();

 private:
  using Edge = std::array<uint32_t, 2>;

  static uint64_t keyOf(uint32_t from, uint32_t to) { return uint64_t{from} << 32 | to; }
  /// Returns the third corner of the triangle on the left of an edge.
  uint32_t apex(uint32_t from, uint32_t to) const { return apexes_.at(keyOf(from, to)); }
  bool hasEdge(uint32_t from, uint32_t to) const { return apexes_.contains(keyOf(from, to)); }
  int turn(uint32_t a, uint32_t b, uint32_t c) const { return points_.turn(a, b, c, axis_); }
  void add(uint32_t a, uint32_t b, uint32_t c);
  void remove(uint32_t a, uint32_t b, uint32_t c);
  glm::uvec3 triangleAround(uint32_t point) const;
  bool canFlip(const Edge& edge) const;
  Edge flip(const Edge& edge);
  bool isSharp(const Edge& edge) const;
  void improve(std::vector<Edge> edges);
  std::optional<Edge> firstCrossing(uint32_t from, uint32_t to) const;
  bool clearWay(uint32_t from, uint32_t to, std::vector<Edge> crossing);

  const ExactPoints& points_;
  int axis_;
  std::unordered_map<uint64_t, uint32_t> apexes_;  // Of each edge in the direction of its triangle.
  std::unordered_map<uint32_t, uint32_t> nexts_;   // A corner after each point in some triangle.
  std::unordered_set<uint64_t> fixed_;             // Edges that stay, from the lower number.
  glm::uvec3 last_;                                // A triangle.
};

}  // namespace raymap
