#pragma once

#include <string_view>

#include "io/field/field_array.h"

namespace raymap {

/// Returns a reader of the bytes that base64 text encodes. The text may consist of several pieces, each with
/// its own padding.
ReadBytes base64Decoded(const std::filesystem::path& path, std::string_view text);
/// Function that returns the next integer of a header.
using ReadCount = std::function<uint64_t()>;
/// Returns a reader of VTK's compressed data. The header gives the number of blocks, the size of a block and
/// of the last block (0 if like the others), and each block's packed size. The blocks follow in zlib's
/// format. Throws `Error(Input)` unless they hold `bytes` bytes. `available` bounds the number and the packed
/// sizes of the blocks.
ReadBytes blocksInflated(const std::filesystem::path& path, const ReadBytes& read, const ReadCount& count,
                         uint64_t bytes, uint64_t available);
/// Returns a reader of decimal numbers as binary ones: uint32 if `isWhole`, else double.
ReadBytes decimalDecoded(const std::filesystem::path& path, std::string_view text, bool isWhole);

}  // namespace raymap
