#pragma once

#include <string_view>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// Returns the bytes of `data:...;base64,...`, or those of the file that a relative URI names. Files outside
/// the folder of `file`, and other URIs, fail: nothing is fetched from elsewhere.
Buffer<std::byte> loadUri(const MeshFile& file, std::string_view uri);

}  // namespace raymap
