#pragma once

#include <raymap/mesh.h>

namespace raymap {

/// Faces that are one piece of surface: linked across edges that exactly two faces share, where they must
/// point to the same side.
struct Patches {
  std::vector<uint32_t> ids;        ///< Of each face, the patch that it belongs to.
  std::vector<uint8_t> isReversed;  ///< Of each face: whether it points the other way than its patch's first.
  size_t count = 0;
};

/// Where the links contradict each other (a Möbius strip), those of the higher vertices are not kept.
Patches findPatches(const Mesh& mesh);

}  // namespace raymap
