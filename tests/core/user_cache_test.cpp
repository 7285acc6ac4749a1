#include "base/user_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
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
  for (const fs::path& made : {folder, folder.parent_path()})
    EXPECT_EQ(fs::status(made).permissions(), fs::perms::owner_all);
}

TEST(UserCache, ReadsNoFileOfAnotherUser) {
  const TemporaryFolder temporary;
  const ScopedVariable cache("RAYMAP_CACHE", temporary.path().string());
  const fs::path file = temporary.path() / "file";
  std::ofstream(file) << "text";
  EXPECT_EQ(readUserCache("file", 4), "text");
  EXPECT_EQ(readUserCache("file", 3), std::nullopt);
  EXPECT_EQ(readUserCache("missing", 4), std::nullopt);
  fs::create_symlink("file", temporary.path() / "link");
  EXPECT_EQ(readUserCache("link", 4), std::nullopt);
  ASSERT_EQ(mkfifo((temporary.path() / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(readUserCache("pipe", 4), std::nullopt);
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  ASSERT_EQ(chown(file.c_str(), 65534, 65534), 0);
  EXPECT_EQ(readUserCache("file", 4), std::nullopt);
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
