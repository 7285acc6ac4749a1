#include "base/user_cache.h"

#include <fcntl.h>
#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>

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

bool makeUserCache(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error)) return true;
  if (folder.has_relative_path() && folder.has_parent_path() && !makeUserCache(folder.parent_path()))
    return false;
  return mkdir(folder.c_str(), 0700) == 0 || fs::is_directory(folder, error);
}

bool isOwnFile(int file) {
  struct stat about {};
  return fstat(file, &about) == 0 && S_ISREG(about.st_mode) && about.st_uid == geteuid();
}

std::optional<std::string> readUserCache(const fs::path& name, uint64_t mostBytes) {
  const std::optional<fs::path> folder = userCacheFolder();
  if (!folder) return std::nullopt;
  const int file = open((*folder / name).c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  struct stat about {};
  const bool isGood = isOwnFile(file) && fstat(file, &about) == 0 && uint64_t(about.st_size) <= mostBytes;
  std::string content(isGood ? size_t(about.st_size) : 0, '\0');
  const bool isRead = isGood && read(file, content.data(), content.size()) == about.st_size;
  close(file);
  return isRead ? std::optional(std::move(content)) : std::nullopt;
}

bool writeUserCache(const fs::path& name, const std::function<void(std::ostream&)>& write) {
  const std::optional<fs::path> folder = userCacheFolder();
  if (!folder || !makeUserCache(*folder)) return false;
  try {
    writeAtomically(*folder / name, write);
  } catch (const Error& failed) {
    if (failed.code() != ErrorCode::File) throw;
    return false;
  }
  return true;
}

}  // namespace raymap
