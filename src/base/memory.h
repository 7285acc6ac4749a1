#pragma once

#include <raymap/memory.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace raymap {

/// Returns what the control groups of a process leave, of both versions and with all groups around them, or
/// SIZE_MAX if none has a limit. `ofProcess` names the groups, as /proc/self/cgroup does.
size_t memoryLeftInGroups(const std::filesystem::path& ofProcess, const std::filesystem::path& root);

/// Lets allocations exceed a strict bound (`limitMemory`) from now on. Drivers of GPUs need it.
void allowAllocations();

/// Returns the most bytes that a call may hold, whose objects hold `held` now: `limit`, unless that is 0, and
/// no more than `held` and what is left.
size_t mostMemory(size_t limit, size_t held = 0);

/// Returns the most bytes that the content of a file of so many bytes may inflate to. No field or mesh is
/// packed to less than a 500th.
uint64_t mostInflated(uint64_t fileBytes);

// Sizes for messages, such as "12 bytes", "40 KiB" or "13903 MiB".

/// Formats what is needed, rounded up.
std::string neededText(uint64_t bytes);
/// Formats what there is at most, rounded down.
std::string limitText(uint64_t bytes);

/// Throws `Error(Memory)` if a field needs more than `limit` bytes. The message has `why` after the size.
void checkFieldMemory(uint64_t needed, uint64_t limit, const std::string& why = "");

/// Throws `Error(Memory)` if a surface needs more than `memoryLeft()` bytes.
void checkSurfaceMemory(uint64_t needed);

/// Throws `Error(Memory)` if the trees of a file's format need more than `memoryLeft()` bytes.
void checkFormatMemory(uint64_t needed);

}  // namespace raymap
