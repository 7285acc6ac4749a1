#pragma once

#include <raymap/callbacks.h>
#include <raymap/mesh.h>

#include <string_view>

#include "base/source_file.h"

namespace raymap {

/// Reads a mesh with Assimp, in a child process (see Importer).
Mesh importMesh(const SourceFile& source, std::string_view format, const WarningCallback& warn);

}  // namespace raymap
