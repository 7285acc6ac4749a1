#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"
#include "mesh/patches.h"

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
  bool areTouching = false;   ///< Whether a ray of a piece starts on another one.
  bool areMixed = false;  ///< Whether a piece is in another one at some of its rays, and at others is not.

  bool areApart() const { return !areTouching && !areMixed; }
};

/// Finds the pieces and their volumes.
Pieces findPieces(const Model& mesh);

/// Finds which pieces enclose which: rays from each one cross them. The rays start on at most `raysPerPiece`
/// of its faces, spread evenly over their order. One is enough for surfaces that touch and cross nowhere. A
/// ray that starts on another piece does not tell whether it is inside.
void nestPieces(const PackedMesh& mesh, size_t raysPerPiece, Pieces& found);

}  // namespace raymap
