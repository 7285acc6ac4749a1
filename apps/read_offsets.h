#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <vector>

namespace raymap {

/// Reads offset points, in samples, from a text file: three whole numbers a line, separated by blanks. Leaves
/// out empty lines and what follows a '#'. Throws `Error`: File, or Input that names the line.
std::vector<glm::ivec3> readOffsets(const std::filesystem::path& path);

}  // namespace raymap
