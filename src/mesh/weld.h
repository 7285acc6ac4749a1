#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "base/sort_keys.h"

namespace raymap {

/// Distinct positions of vertices.
struct Welding {
  Buffer<uint32_t> ids;  ///< Position of each vertex.
  size_t count = 0;      ///< Number of distinct positions.
};

/// Numbers the distinct positions. Positions are the same if their coordinates are exactly equal. `keys` is
/// memory that is worth keeping for another sort.
Welding weldVertices(std::span<const glm::vec3> vertices, Buffer<SortKey>& keys);
Welding weldVertices(std::span<const glm::vec3> vertices);

/// Returns the welding of vertices that all count as positions of their own.
Welding unwelded(size_t vertices);

}  // namespace raymap
