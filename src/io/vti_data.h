#pragma once

#include <string_view>

#include "field_array.h"

namespace raymap {

/// The bytes that base64 text stands for. Text may consist of several pieces, each with its own padding.
ReadBytes base64Decoded(const std::filesystem::path& path, std::string_view text);
/// The bytes of numbers in decimal: uint32 if `isWhole`, else double.
ReadBytes decimalDecoded(const std::filesystem::path& path, std::string_view text, bool isWhole);

}  // namespace raymap
