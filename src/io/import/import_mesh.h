#pragma once

#include <raymap/callbacks.h>
#include <raymap/mesh.h>

#include <filesystem>

namespace raymap {

/// Reads a mesh with Assimp, in a child process (see Importer).
Mesh importMesh(const std::filesystem::path& path, const WarningCallback& warn);

}  // namespace raymap
