#pragma once

#include <string_view>

#include "io/field/field_array.h"

namespace raymap {

/// The bytes that base64 text stands for. Text may consist of several pieces, each with its own padding.
ReadBytes base64Decoded(const std::filesystem::path& path, std::string_view text);
/// Gives the next whole number of a header.
using ReadCount = std::function<uint64_t()>;
/// VTK's compressed data: how many blocks, the size of each, of the last (0 if it is like the others), and
/// what each is packed into, in zlib's format; then the blocks. Throws `Error(Input)` unless they hold
/// `bytes`; `available` bounds what is packed.
ReadBytes blocksInflated(const std::filesystem::path& path, const ReadBytes& read, const ReadCount& count,
                         uint64_t bytes, uint64_t available);
/// The bytes of numbers in decimal: uint32 if `isWhole`, else double.
ReadBytes decimalDecoded(const std::filesystem::path& path, std::string_view text, bool isWhole);

}  // namespace raymap
