#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>

namespace raymap {

/// Returns the folder of files that later runs may use again: the environment variable RAYMAP_CACHE, else
/// $XDG_CACHE_HOME/raymap, else ~/.cache/raymap. The folder need not exist. Returns none if RAYMAP_CACHE is
/// "off" or no home folder is known.
std::optional<std::filesystem::path> userCacheFolder();

/// Writes a file into the folder that `userCacheFolder` returns, and makes the folder if it is missing. The
/// file appears whole or not at all. Returns whether it was written: no run fails for want of a cache.
bool writeUserCache(const std::filesystem::path& name, const std::function<void(std::ostream&)>& write);

}  // namespace raymap
