#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace raymap {

/// Returns the number of bytes that this process can still get without swapping. This is the smaller of the
/// system's available memory and the limit of the control group, or SIZE_MAX if neither is known.
size_t availableMemory();

/// Formats a size for messages, rounded up to whole MiB.
std::string mebibytes(uint64_t bytes);

/// Throws `Error(Memory)` if a field needs more than `limit` bytes. The message has `where` after the size.
void checkFieldMemory(uint64_t needed, uint64_t limit, const std::string& where = "");

/// Throws `Error(Memory)` if a surface needs more than `availableMemory()` bytes.
void checkSurfaceMemory(uint64_t needed);

}  // namespace raymap
