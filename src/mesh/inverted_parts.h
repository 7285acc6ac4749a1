#pragma once

// Ours: closed parts of a mesh that cross each other, but of which some are inside out
// (docs/dev/decisions/crossing_parts.md).

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns whether a mesh may have parts that enclose a volume and point outwards, and others that point
/// inwards. Looks at connections and volumes alone, which takes a few milliseconds per million faces of a
/// mesh in one part.
bool mayHaveInvertedParts(const PackedMesh& mesh);

/// Parts that face against others.
struct InvertedParts {
  std::vector<uint32_t>
      faces;  ///< All faces to reverse, ascending: of these parts, and of what they enclose.
  std::vector<uint32_t> firsts;  ///< Lowest face of each part, ascending.
};

/// Finds parts that cross others which face the other way. A part is what faces form across their edges, if
/// it encloses a volume: small holes do not matter. Parts that cross are linked. All of a linked set should
/// face as its largest part does. Parts that touch, share a plane, or lie within each other do not cross.
InvertedParts findInvertedParts(const PackedMesh& mesh);

}  // namespace raymap
