#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// A connected part of a closed surface: the outside of a solid, or the wall of a sealed cavity.
struct Piece {
  static constexpr uint32_t kNone = UINT32_MAX;

  double volume = 0.0;      ///< Volume that it encloses, in the mesh's units cubed; negative: a cavity.
  uint32_t around = kNone;  ///< Innermost piece that encloses it.

  bool isCavity() const { return volume < 0.0; }
};

/// The pieces of a surface on which every edge has two faces that agree in orientation.
struct Pieces {
  std::vector<uint32_t> ids;  ///< Piece of each face.
  std::vector<Piece> pieces;  ///< In the order of their first faces.
  bool areApart = true;       ///< False if pieces touch, or reach from the inside of another one outside.
};

/// Finds the pieces and their volumes.
Pieces findPieces(const PackedMesh& mesh);

/// Finds which pieces enclose which: rays from each one cross them. The rays start on at most `raysPerPiece`
/// of its faces, spread evenly over their order. One is enough for surfaces that touch and cross nowhere.
void nestPieces(const PackedMesh& mesh, size_t raysPerPiece, Pieces& found);

}  // namespace raymap
