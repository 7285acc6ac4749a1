#pragma once

#include <string_view>

#include "io/mesh/mesh_file.h"

namespace raymap {

bool isDataUri(std::string_view uri);
/// Returns the bytes of `data:...;base64,...`.
Buffer<std::byte> decodeDataUri(const MeshFile& file, std::string_view uri);
/// Returns the path of the file beside `file` that a relative URI names. Other URIs fail: nothing is fetched
/// from elsewhere.
std::filesystem::path relativeFile(const MeshFile& file, std::string_view uri);

}  // namespace raymap
