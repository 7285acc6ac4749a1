#pragma once

#include <raymap/export.h>
#include <raymap/mesh_view.h>

#include <cstdint>
#include <vector>

namespace raymap {

/// Returns the faces of each part of a mesh that is apart, in their order. A part is connected through
/// vertices at exactly equal positions. A closed part whose faces point into the solid around it is a cavity,
/// and belongs to that solid. Parts are in the order of their first faces. Throws `Error(Input)` as
/// `validate` does.
RAYMAP_API std::vector<std::vector<uint32_t>> splitParts(const MeshView& mesh);

}  // namespace raymap
