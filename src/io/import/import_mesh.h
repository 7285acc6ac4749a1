#pragma once

#include <string_view>

#include "base/source_file.h"
#include "io/mesh/mesh_file.h"

namespace raymap {

/// Reads a mesh with Assimp, in a child process (see Importer). `file` says how; its bytes are ignored.
Mesh importMesh(const SourceFile& source, std::string_view format, const MeshFile& file);

}  // namespace raymap
