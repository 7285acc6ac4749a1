#include "base/user_cache.h"

#include <raymap/atomic_file.h>
#include <raymap/error.h>

#include <cstdlib>
#include <string_view>
#include <system_error>

namespace raymap {

namespace fs = std::filesystem;

namespace {

/// Returns the value of an environment variable; empty if it is not set.
std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

std::optional<fs::path> userCacheFolder() {
  const std::string_view own = variable("RAYMAP_CACHE");
  if (own == "off") return std::nullopt;
  if (!own.empty()) return fs::path(own);
  const fs::path caches = variable("XDG_CACHE_HOME");
  if (caches.is_absolute()) return caches / "raymap";  // XDG's specification: a relative path is ignored.
  const fs::path home = variable("HOME");
  if (home.is_absolute()) return home / ".cache" / "raymap";
  return std::nullopt;
}

bool writeUserCache(const fs::path& name, const std::function<void(std::ostream&)>& write) {
  const std::optional<fs::path> folder = userCacheFolder();
  std::error_code error;
  if (!folder || (fs::create_directories(*folder, error), error)) return false;
  try {
    writeAtomically(*folder / name, write);
  } catch (const Error& failed) {
    if (failed.code() != ErrorCode::File) throw;
    return false;
  }
  return true;
}

}  // namespace raymap
