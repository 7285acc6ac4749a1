#pragma once

#include <raymap/picture.h>

#include <filesystem>
#include <vector>

namespace raymap {

/// Returns a picture as the bytes of a PNG file. Throws as `writePng` does; errors name `path`.
std::vector<uint8_t> encodePng(const std::filesystem::path& path, const Picture& picture);

}  // namespace raymap
