#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/sort_keys.h"
#include "mesh/packed_mesh.h"

namespace raymap {

/// Distinct positions of vertices.
struct Welding {
  Buffer<uint32_t> ids;  ///< Position of each vertex.
  size_t count = 0;      ///< Number of distinct positions.

  /// Returns the last vertex at each position.
  std::vector<uint32_t> vertices() const;
};

/// Numbers the distinct positions. Positions are the same if their coordinates are exactly equal. `keys` is
/// memory that is worth keeping for another sort.
Welding weldVertices(std::span<const glm::vec3> vertices, Buffer<SortKey>& keys);
Welding weldVertices(std::span<const glm::vec3> vertices);

/// Returns the welding of vertices that are all positions of their own.
Welding unwelded(size_t vertices);

/// Returns the positions of a face's corners.
inline glm::uvec3 weldedFace(const PackedMesh& mesh, const Welding& welding, size_t face) {
  const glm::uvec3& t = mesh.triangles[face];
  return {welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]};
}

}  // namespace raymap
