#pragma once

#include "io/import/import_stream.h"
#include "io/import/importer.h"
#include "io/mesh/mesh_file.h"

namespace raymap {

/// Returns the bytes that the attributes of a mesh take.
uint64_t attributeBytes(const MeshHeader& header);

/// Receives the attributes of the triangles of a mesh. Throws `Error(Input)` if they do not fit it. Leaves
/// texture coordinates and colours out that are not all finite numbers, with a warning.
void importAttributes(const MeshFile& file, const MeshHeader& header, std::span<const glm::uvec3> triangles,
                      Importer& importer);

}  // namespace raymap
