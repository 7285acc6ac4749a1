#include "base/memory.h"

#include <gtest/gtest.h>
#include <raymap/buffer.h>
#include <sys/resource.h>

#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "error_code.h"
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

TEST(MemoryLeft, HeedsTheLimitsOfTheProcess) {
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
    const size_t left = memoryLeft();
    setrlimit(resource, &before);
    EXPECT_GT(left, kMore - kChange) << held;
    EXPECT_LT(left, kMore + kChange) << held;
  }
}

TEST(LimitMemory, LeavesWhatIsNotHeld) {
  constexpr size_t kMore = size_t{128} << 20, kChange = size_t{16} << 20;
  limitMemory(heldBytes("VmRSS:") + kMore);
  const size_t left = memoryLeft();
  limitMemory(1);
  EXPECT_EQ(memoryLeft(), 0u);
  EXPECT_FALSE(codeOf([] { const Buffer<char> held(kMore); })) << "The bound is not strict.";
  limitMemory(0);
  EXPECT_GT(left, kMore - kChange);
  EXPECT_LT(left, kMore);
  EXPECT_GT(memoryLeft(), kMore);
}

TEST(LimitMemory, MakesAllocationsFailIfItIsStrict) {
  constexpr size_t kMore = size_t{64} << 20;
  const size_t before = heldBytes("VmRSS:");
  limitMemory(before + kMore, true);
  EXPECT_EQ(codeOf([] { Buffer<char>(2 * kMore); }), ErrorCode::Memory);
  EXPECT_THROW(std::vector<char>(2 * kMore), std::bad_alloc);
  EXPECT_NO_THROW(std::vector<char>(kMore / 4));
  allowAllocations();
  EXPECT_NO_THROW(std::vector<char>(2 * kMore));
  EXPECT_LT(memoryLeft(), kMore) << "The bound itself stays.";
  limitMemory(0);
}

TEST(LimitMemory, RefusesAStrictBoundThatIsExceededAlready) {
  EXPECT_EQ(codeOf([] { limitMemory(1000, true); }), ErrorCode::Memory);
  EXPECT_GT(memoryLeft(), size_t{1} << 20);
}

TEST(MostMemory, IsTheLimitAndNoMoreThanWhatIsLeft) {
  EXPECT_EQ(mostMemory(1000), 1000u);
  limitMemory(1);
  EXPECT_EQ(mostMemory(1000), 0u);
  EXPECT_EQ(mostMemory(1000, 300), 300u);
  EXPECT_EQ(mostMemory(0, 300), 300u);
  limitMemory(0);
  EXPECT_GT(mostMemory(0, 300), 300u);
  EXPECT_EQ(mostMemory(0, SIZE_MAX), SIZE_MAX);
}

TEST(MostInflated, GrowsWithTheFile) {
  EXPECT_EQ(mostInflated(0), uint64_t{64} << 20);
  EXPECT_EQ(mostInflated(1000), (uint64_t{64} << 20) + 500'000);
  EXPECT_EQ(mostInflated(UINT64_MAX / 2), UINT64_MAX);
}

}  // namespace
}  // namespace raymap
