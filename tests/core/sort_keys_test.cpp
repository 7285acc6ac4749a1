#include "base/sort_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace raymap {
namespace {

bool isLess(const SortKey& a, const SortKey& b) {
  return a.high != b.high ? a.high < b.high : a.low < b.low;
}

void expectSorted(const std::vector<SortKey>& input) {
  std::vector<SortKey> expected = input;
  std::sort(expected.begin(), expected.end(), isLess);
  for (const int threads : {1, 4}) {
    Buffer<SortKey> keys;
    withThreads(threads, [&] {
      sortKeys(
          input.size(),
          [&](size_t begin, size_t end, SortKey* to) {
            std::copy(input.data() + begin, input.data() + end, to);
          },
          keys);
    });
    ASSERT_EQ(keys.size(), expected.size());
    for (size_t k = 0; k < expected.size(); ++k)
      ASSERT_TRUE(keys[k].high == expected[k].high && keys[k].low == expected[k].low)
          << "key " << k << " of " << expected.size() << ", " << threads << " threads";
  }
}

/// Returns keys whose upper halves have one of `values` values.
std::vector<SortKey> randomKeys(size_t count, uint64_t values) {
  std::mt19937_64 random(count);
  std::vector<SortKey> keys(count);
  for (SortKey& key : keys) key = {random(), random() % values * (UINT64_MAX / values)};
  return keys;
}

TEST(SortKeys, SortsAnyNumberOfKeys) {
  for (const size_t count : {0, 1, 2, 1000, 32767, 32768, 32769, 300001})
    expectSorted(randomKeys(count, 1u << 30));
}

TEST(SortKeys, SortsKeysWithEqualHalves) {
  for (const uint64_t values : {1, 2, 3, 100}) expectSorted(randomKeys(100000, values));
}

TEST(SortKeys, SortsExtremeKeys) {
  std::vector<SortKey> keys = randomKeys(100000, UINT64_MAX);
  for (size_t k = 0; k < keys.size(); k += 3) keys[k] = {k % 2 ? 0 : UINT64_MAX, k % 5 ? UINT64_MAX : 0};
  expectSorted(keys);
}

TEST(SortKeys, SortsSortedAndReversedKeys) {
  std::vector<SortKey> keys(200000);
  for (size_t k = 0; k < keys.size(); ++k) keys[k] = {k % 7, k};
  expectSorted(keys);
  std::reverse(keys.begin(), keys.end());
  expectSorted(keys);
}

}  // namespace
}  // namespace raymap
