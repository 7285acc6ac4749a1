#pragma once

#include <raymap/field.h>
#include <raymap/repair.h>

#include "mesh/pieces.h"

namespace raymap {

/// Faces that a result shall not have.
struct Choice {
  std::vector<bool> isDropped;  ///< For each piece.
  size_t count = 0;             ///< Number of dropped pieces.
};

/// Chooses small parts but for the `needed` ones, sealed cavities unless `keepsCavities`, and what lies in
/// those. `needed` may be empty. Sets the report's figures of them.
Choice choosePieces(const Pieces& found, const RepairOptions& repair, bool keepsCavities,
                    RepairReport& report, const std::vector<bool>& needed = {});

/// Returns the choice of all pieces that a choice keeps.
Choice opposite(const Choice& choice);

/// Gives the samples in the dropped pieces the side of the space around them, of a narrow band those in
/// leaves. Their distances are then far larger than all others.
void dropFrom(Field& solid, const Mesh& surface, const Pieces& found, const Choice& choice);

/// Removes the faces of the dropped pieces, and the vertices that only they use.
void dropFrom(Mesh& surface, const Pieces& found, const Choice& choice);

/// Warns of what may be more than crumbs and bubbles: dropped parts nearly as large as those that stay,
/// filled cavities larger than a part to drop, and parts in filled cavities.
void warnOfRemoved(const Pieces& found, const Choice& choice, const RepairReport& report,
                   const WarningCallback& warn);

/// Warns of parts that were small enough to be dropped, but kept.
void warnOfKept(const RepairReport& report, const WarningCallback& warn);

/// Counts the solids and the cavities of a result.
void countPieces(const Model& result, RepairReport& report);

}  // namespace raymap
