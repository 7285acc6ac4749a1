#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace raymap {

/// Returns the number of bytes that this process can still get without swapping. This is the least of the
/// system's available memory and of what the control groups and the process's own limits leave, or SIZE_MAX
/// if none is known.
size_t availableMemory();

/// Returns what the control groups of a process leave, of both versions and with all groups around them, or
/// SIZE_MAX if none has a limit. `ofProcess` names the groups, as /proc/self/cgroup does.
size_t memoryLeftInGroups(const std::filesystem::path& ofProcess, const std::filesystem::path& root);

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
