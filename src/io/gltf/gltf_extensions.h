#pragma once

#include <string_view>

namespace raymap {

/// Returns whether a file that requires this glTF extension can be read: it is read, or it cannot change the
/// shape of a mesh.
bool isReadableExtension(std::string_view name);

}  // namespace raymap
