#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>

namespace raymap {

/// Returns the folder of files that later runs may use again: the environment variable RAYMAP_CACHE, else
/// $XDG_CACHE_HOME/raymap, else ~/.cache/raymap. The folder need not exist. Returns none if RAYMAP_CACHE is
/// "off" or no home folder is known.
std::optional<std::filesystem::path> userCacheFolder();

/// Makes the folder, and those above it that are missing, for their owner alone. Returns whether it is there.
bool makeUserCache(const std::filesystem::path& folder);

/// Returns whether an open file is a regular one that belongs to this user. Another user may have made it up.
bool isOwnFile(int file);

/// Returns the content of a file in the folder; none if it is missing, has more than `mostBytes` bytes, is a
/// link, or is not this user's own.
std::optional<std::string> readUserCache(const std::filesystem::path& name, uint64_t mostBytes);

/// Writes a file into the folder that `userCacheFolder` returns, and makes the folder if it is missing. The
/// file appears whole or not at all. Returns whether it was written: no run fails for want of a cache.
bool writeUserCache(const std::filesystem::path& name, const std::function<void(std::ostream&)>& write);

}  // namespace raymap
