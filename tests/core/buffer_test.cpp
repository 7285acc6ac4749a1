#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

namespace raymap {
namespace {

constexpr size_t kMegabyte = size_t{1} << 20;

/// Returns the memory that this process holds, or 0 where the system does not tell.
[[maybe_unused]] size_t residentBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (size_t kilobytes = 0; word == "VmRSS:" && status >> kilobytes) return kilobytes * 1024;
  return 0;
}

bool isAligned(const void* memory, size_t to) {
  return reinterpret_cast<uintptr_t>(memory) % to == 0;
}

TEST(Buffer, IsAlignedAndWritableToItsEnd) {
  for (const size_t bytes : {size_t{1}, size_t{64}, size_t{100'000}, 2 * kMegabyte - 1, 2 * kMegabyte,
                             2 * kMegabyte + 1, 5 * kMegabyte + 4097}) {
    Buffer<uint8_t> buffer(bytes), next(bytes);
    EXPECT_TRUE(isAligned(buffer.data(), 64)) << bytes;
    std::memset(buffer.data(), 1, bytes);
    std::memset(next.data(), 2, bytes);
    EXPECT_EQ(std::accumulate(buffer.begin(), buffer.end(), size_t{0}), bytes);
    EXPECT_EQ(std::accumulate(next.begin(), next.end(), size_t{0}), 2 * bytes);
  }
}

TEST(Buffer, KeepsItsMemoryWhenItShrinks) {
  Buffer<float> buffer(kMegabyte);
  const float* const data = buffer.data();
  buffer.resizeUninitialized(10);
  EXPECT_EQ(buffer.size(), 10u);
  EXPECT_EQ(buffer.capacityBytes(), 4 * kMegabyte);
  buffer.resizeUninitialized(kMegabyte);
  EXPECT_EQ(buffer.data(), data);
  buffer.release();
  EXPECT_TRUE(buffer.empty());
  EXPECT_EQ(buffer.capacityBytes(), 0u);
}

TEST(Buffer, SaysWhatItCannotAllocate) {
  std::vector<size_t> sizes{SIZE_MAX, SIZE_MAX / 2 + 1};
#ifndef RAYMAP_ADDRESS_SANITIZER  // AddressSanitizer ends a program that asks for so much.
  sizes.push_back(SIZE_MAX / 4);
#endif
  for (const size_t bytes : sizes) {
    try {
      freePages(allocatePages(bytes), bytes);
      ADD_FAILURE() << bytes;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Memory);
      EXPECT_EQ(std::string(error.what()).find("cannot allocate "), 0u) << error.what();
    }
  }
  EXPECT_EQ(allocatePages(0), nullptr);
  freePages(nullptr, 0);
  freePages(nullptr, 4 * kMegabyte);
}

#if defined(__linux__) && !defined(RAYMAP_ADDRESS_SANITIZER) && !defined(RAYMAP_THREAD_SANITIZER)
TEST(Buffer, GivesMemoryBackToTheSystem) {
  const auto filled = [](size_t bytes) {
    Buffer<uint8_t> buffer(bytes);
    std::memset(buffer.data(), 1, bytes);
    return buffer;
  };
  filled(30 * kMegabyte).release();  // From then on malloc would keep what is smaller.
  Buffer<uint8_t> first = filled(8 * kMegabyte), second = filled(8 * kMegabyte);
  const size_t before = residentBytes();
  first.release();
  EXPECT_LE(residentBytes() + 7 * kMegabyte, before);
  EXPECT_EQ(second[second.size() - 1], 1);
}
#endif

}  // namespace
}  // namespace raymap
