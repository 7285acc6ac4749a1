#pragma once

#include <string_view>

#include "io/mesh/mesh_file.h"

namespace raymap {

bool isDataUri(std::string_view uri);
/// Returns the bytes of `data:...;base64,...`.
Buffer<std::byte> decodeDataUri(const MeshFile& file, std::string_view uri);
/// Opens the file that a relative URI names. Those outside the folder of `file`, and other URIs, fail:
/// nothing is fetched from elsewhere.
Buffer<std::byte> loadUri(const MeshFile& file, std::string_view uri);

}  // namespace raymap
