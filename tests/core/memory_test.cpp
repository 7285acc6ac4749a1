#include "base/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <string>

#include "files.h"

namespace raymap {
namespace {

namespace fs = std::filesystem;

class MemoryGroups : public ::testing::Test {
 protected:
  void write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder() / name).parent_path());
    std::ofstream(folder() / name) << text;
  }
  size_t left(const std::string& groups) const {
    write("groups", groups);
    return memoryLeftInGroups(folder() / "groups", folder() / "root");
  }
  const fs::path& folder() const { return folder_.path(); }

  TemporaryFolder folder_;
};

TEST_F(MemoryGroups, OfTheSecondVersionLeaveWhatIsNotHeld) {
  write("root/a/b/memory.max", "5000\n");
  write("root/a/b/memory.current", "3000\n");
  EXPECT_EQ(left("0::/a/b\n"), 2000u);
  // The kernel frees pages of files.
  write("root/a/b/memory.stat", "anon 10\ninactive_file 1200\nactive_file 77\n");
  EXPECT_EQ(left("0::/a/b\n"), 3200u);
  write("root/a/memory.max", "max\n");
  EXPECT_EQ(left("0::/a/b\n"), 3200u);
  write("root/a/memory.max", "6000\n");
  write("root/a/memory.current", "5500\n");
  EXPECT_EQ(left("0::/a/b\n"), 500u);
  write("root/a/memory.current", "6500\n");
  EXPECT_EQ(left("0::/a/b\n"), 0u);
  EXPECT_EQ(left("0::/\n"), SIZE_MAX);
  write("root/memory.max", "42\n");
  EXPECT_EQ(left("0::/\n"), 42u);
}

TEST_F(MemoryGroups, OfTheFirstVersionHaveAFolderOfTheirOwn) {
  write("root/memory/job/memory.limit_in_bytes", "9000\n");
  write("root/memory/job/memory.usage_in_bytes", "4000\n");
  write("root/memory/job/memory.stat", "inactive_file 1\ntotal_inactive_file 500\n");
  write("root/job/memory.max", "1\n");  // Of a group that the process is not in.
  EXPECT_EQ(left("5:pids:/x\n4:memory:/job\n1:cpu:/job\n0::/\n"), 5500u);
}

TEST_F(MemoryGroups, LeaveEverythingWhereNothingIsLimited) {
  EXPECT_EQ(left(""), SIZE_MAX);
  EXPECT_EQ(left("no groups\n"), SIZE_MAX);
  EXPECT_EQ(left("0::/not/there\n"), SIZE_MAX);
}

/// Returns a number of kilobytes of this process, in bytes.
size_t heldBytes(const std::string& wanted) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(wanted)) return std::stoull(line.substr(wanted.size())) * 1024;
  return 0;
}

TEST(AvailableMemory, HeedsTheLimitsOfTheProcess) {
  struct Case {
    __rlimit_resource_t resource;
    const char* held;
  };
  constexpr size_t kMore = size_t{128} << 20, kChange = size_t{16} << 20;
  for (const auto& [resource, held] : {Case{RLIMIT_AS, "VmSize:"}, Case{RLIMIT_DATA, "VmData:"}}) {
    rlimit before{};
    ASSERT_EQ(getrlimit(resource, &before), 0);
    const rlimit limit{.rlim_cur = heldBytes(held) + kMore, .rlim_max = before.rlim_max};
    ASSERT_EQ(setrlimit(resource, &limit), 0);
    const size_t left = availableMemory();
    setrlimit(resource, &before);
    EXPECT_GT(left, kMore - kChange) << held;
    EXPECT_LT(left, kMore + kChange) << held;
  }
}

}  // namespace
}  // namespace raymap
