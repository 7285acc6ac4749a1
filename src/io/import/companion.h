#pragma once

#include <filesystem>
#include <optional>

namespace raymap {

/// Returns the place of a file that is installed with this library: beside this program or library, or in the
/// folder for such files, which is found from this program or library, from the run path, by the prefix that
/// the build was configured with, or by the environment variable RAYMAP_IMPORT.
std::optional<std::filesystem::path> findCompanion(const char* name);

}  // namespace raymap
