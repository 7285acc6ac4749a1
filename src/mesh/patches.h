#pragma once

#include "mesh/model.h"

namespace raymap {

/// Patches of a mesh: faces linked across edges that exactly two faces share. The faces of a patch must point
/// to the same side.
struct Patches {
  std::vector<uint32_t> ids;        ///< Patch of each face.
  std::vector<uint8_t> isReversed;  ///< Whether each face points the other way than its patch's first face.
  size_t count = 0;                 ///< Number of patches.
};

/// Finds the patches. Where links contradict each other (a Möbius strip), those of the higher vertices are
/// dropped.
Patches findPatches(const Model& mesh);

}  // namespace raymap
