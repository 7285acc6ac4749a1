#pragma once

#include <raymap/io.h>

namespace raymap {

/// Reads a mesh with Assimp, in the child process `raymap-import` with limits on its memory and time, so that
/// whatever a damaged file does to Assimp becomes an Error here. The program is looked for where the
/// environment variable RAYMAP_IMPORT says, then beside this program or library, then where it was installed.
Mesh importMesh(const std::filesystem::path& path, const Warn& warn);

}  // namespace raymap
