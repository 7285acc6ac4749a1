#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace raymap {

/// Returns the number of bytes that this process can still get without swapping. This is the smaller of the
/// system's available memory and the limit of the control group, or SIZE_MAX if neither is known.
size_t availableMemory();

// Sizes for messages, such as "12 bytes", "40 KiB" or "13903 MiB".

/// Formats what is needed, rounded up.
std::string neededText(uint64_t bytes);
/// Formats what there is at most, rounded down.
std::string limitText(uint64_t bytes);

/// Throws `Error(Memory)` if a field needs more than `limit` bytes. The message has `why` after the size.
void checkFieldMemory(uint64_t needed, uint64_t limit, const std::string& why = "");

/// Throws `Error(Memory)` if a surface needs more than `availableMemory()` bytes.
void checkSurfaceMemory(uint64_t needed);

}  // namespace raymap
