#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "mesh/packed_mesh.h"
#include "predicates/exact_points.h"

namespace raymap {

/// A triangle that nothing crosses: a face of a mesh, or a part of one or more.
struct CutPiece {
  glm::uvec3 corners;  ///< Points, counter-clockwise seen from the side where the faces' sum points.
  uint32_t face;       ///< A face that it is part of.
  int layers;     ///< Number of faces that point there, less those that point the other way; not below 0.
  bool isTurned;  ///< Whether that face points the other way.
};

/// Faces of a mesh, cut where they cross, overlap or touch.
struct CutFaces {
  ExactPoints points;              ///< Distinct places of the vertices on the lattice, then the others.
  std::vector<uint32_t> vertices;  ///< First vertex of the mesh at each place.
  std::vector<glm::uvec3> faces;   ///< Points of each face of the mesh.
  std::vector<CutPiece> pieces;    ///< Faces that were not cut, then the parts of others.
  size_t cutFaces = 0;             ///< Number of faces that were cut.
  size_t repeatedFaces = 0;        ///< Number of faces that were not, and lie on another face.
};

/// Cuts the faces of a mesh, whose vertices are taken from their lattice, so that pieces share whole edges,
/// corners or nothing. Faces that cancel each other become pieces without layers. Faces without area are left
/// out: their neighbours are cut at their corners instead. Returns nothing if that takes too much work.
std::optional<CutFaces> cutFaces(const PackedMesh& mesh);

}  // namespace raymap
