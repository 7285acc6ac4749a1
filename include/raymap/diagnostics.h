#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raymap {

/// A loop of edges with one face.
struct Hole {
  size_t edges = 0;
  double length = 0.0;  ///< All around.
  glm::dvec3 centre{0.0};
  double diameter = 0.0;  ///< Twice as far as its farthest vertex lies from the centre.
};

/// What is right and wrong with a mesh, measured after welding vertices at exactly equal positions.
struct Diagnostics {
  size_t vertices = 0;        ///< As stored.
  size_t weldedVertices = 0;  ///< Distinct positions, used by a face or not.
  size_t triangles = 0;
  size_t boundaryEdges = 0;     ///< Edges with one face.
  size_t nonManifoldEdges = 0;  ///< Edges with more than two faces.
  size_t flippedEdges = 0;      ///< Two-face edges used twice in the same direction.
  size_t flippedFaces = 0;      ///< The fewest to turn so that neighbours agree.
  std::vector<Hole> holes;      ///< The longest first.
  size_t components = 0;        ///< Connected through shared vertices.
  size_t degenerateFaces = 0;   ///< Repeated corner, or height below 1e-6 of the longest edge.
  size_t duplicateFaces = 0;    ///< Further faces on the same three corners, either orientation.
  bool watertight = false;      ///< Every edge has exactly two faces.
  bool consistentlyOriented = false;
  bool balanced = false;  ///< Every edge used equally often both ways: the winding number is whole.
  double signedVolume = 0.0;
  double area = 0.0;
  Box bounds;
};

Diagnostics diagnose(const Mesh& mesh);

/// Faces that cross others: inner points of the two coincide. What only touches, overlaps in one plane or
/// shares an edge does not cross. Exact, on corners snapped to a lattice of 2^29 steps and more along the
/// longest side.
struct SelfIntersections {
  size_t pairs = 0;
  std::vector<uint32_t> faces;  ///< Ascending.
  bool isComplete = true;       ///< Or there are at least so many: where too many faces overlap it stops.
};

SelfIntersections findSelfIntersections(const Mesh& mesh);

}  // namespace raymap
