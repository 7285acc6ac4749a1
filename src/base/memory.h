#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace raymap {

/// Bytes that this process can still get without swapping: the least of what the system has left and the
/// limit of its control group; SIZE_MAX if neither is known.
size_t availableMemory();

/// For messages, rounded up.
std::string mebibytes(uint64_t bytes);

/// Throws `Error(Memory)` if a field needs more than the limit; `where` is said after how much it needs.
void checkFieldMemory(uint64_t needed, uint64_t limit, const std::string& where = "");

/// Throws `Error(Memory)` if a surface needs more than this process can get.
void checkSurfaceMemory(uint64_t needed);

}  // namespace raymap
