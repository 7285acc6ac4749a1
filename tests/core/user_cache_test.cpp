#include "base/user_cache.h"

#include <gtest/gtest.h>

#include <ostream>
#include <stdexcept>

#include "environment.h"
#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

TEST(UserCache, LiesWhereTheEnvironmentSays) {
  const struct {
    std::optional<std::string> own, caches, home;
    std::optional<fs::path> folder;
  } cases[] = {
      {"/own", "/caches", "/home/me", "/own"},
      {"relative", "/caches", "/home/me", "relative"},
      {"off", "/caches", "/home/me", std::nullopt},
      {"", "/caches", "/home/me", "/caches/raymap"},
      {std::nullopt, "/caches", "/home/me", "/caches/raymap"},
      {std::nullopt, "relative", "/home/me", "/home/me/.cache/raymap"},
      {std::nullopt, std::nullopt, "/home/me", "/home/me/.cache/raymap"},
      {std::nullopt, std::nullopt, std::nullopt, std::nullopt},
  };
  for (const auto& [own, caches, home, folder] : cases) {
    const ScopedVariable a("RAYMAP_CACHE", own), b("XDG_CACHE_HOME", caches), c("HOME", home);
    EXPECT_EQ(userCacheFolder(), folder) << own.value_or("-") << " " << caches.value_or("-");
  }
}

TEST(UserCache, MakesItsFolder) {
  const TemporaryFolder temporary;
  const fs::path folder = temporary.path() / "a" / "b";
  const ScopedVariable cache("RAYMAP_CACHE", folder.string());
  for (const char* text : {"first", "second"}) {
    EXPECT_TRUE(writeUserCache("file", [text](std::ostream& out) { out << text; }));
    EXPECT_EQ(readBytes(folder / "file"), text);
  }
}

TEST(UserCache, MayBeOffOrUnwritable) {
  const TemporaryFolder temporary;
  const fs::path file = temporary.path() / "file";
  std::ofstream(file) << "no folder";
  const auto write = [](std::ostream& out) { out << "text"; };
  for (const std::string& folder : {std::string("off"), file.string(), (file / "below").string()}) {
    const ScopedVariable cache("RAYMAP_CACHE", folder);
    EXPECT_FALSE(writeUserCache("name", write)) << folder;
  }
  EXPECT_EQ(readBytes(file), "no folder");
  const ScopedVariable cache("RAYMAP_CACHE", temporary.path().string());
  fs::create_directory(temporary.path() / "taken");
  EXPECT_FALSE(writeUserCache("taken", write));
  EXPECT_THROW(writeUserCache("name", [](std::ostream&) { throw std::runtime_error("ours"); }),
               std::runtime_error);
  EXPECT_FALSE(fs::exists(temporary.path() / "name"));
}

}  // namespace
}  // namespace raymap
