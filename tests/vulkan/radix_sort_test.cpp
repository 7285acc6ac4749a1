#include "vulkan/primitives/radix_sort.h"

#include <numeric>
#include <random>

#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

template <class Key>
struct Lists {
  std::vector<Key> keys;
  std::vector<uint32_t> values;
  bool operator==(const Lists&) const = default;
};

/// The values number the keys, so that a change in the order of equal keys shows.
template <class Key>
Lists<Key> randomLists(size_t count, uint32_t bits) {
  std::mt19937_64 random(count);
  Lists<Key> lists{std::vector<Key>(count), std::vector<uint32_t>(count)};
  // The bits above those to sort by are random.
  for (Key& key : lists.keys) key = static_cast<Key>(random()) & ~(bits < 8 ? Key{6} : Key{0});
  std::iota(lists.values.begin(), lists.values.end(), 0U);
  return lists;
}

template <class Key>
Lists<Key> sorted(const Lists<Key>& lists, uint32_t bits) {
  const Key mask = bits == 0 ? 0 : static_cast<Key>(~Key{0}) >> (8 * sizeof(Key) - bits);
  Lists<Key> result{std::vector<Key>(lists.keys.size()), lists.values};
  std::stable_sort(result.values.begin(), result.values.end(),
                   [&](uint32_t a, uint32_t b) { return (lists.keys[a] & mask) < (lists.keys[b] & mask); });
  for (size_t i = 0; i < result.keys.size(); ++i) result.keys[i] = lists.keys[result.values[i]];
  return result;
}

class VulkanRadixSort : public VulkanTest, public ::testing::WithParamInterface<uint32_t> {
 protected:
  /// Sorts on the device. If `spare` is given, only the device knows the count, which is this much below the
  /// capacity.
  template <class Key>
  static Lists<Key> sort(const Lists<Key>& lists, uint32_t bits, uint32_t spare = 0) {
    const auto count = static_cast<uint32_t>(lists.keys.size());
    DeviceBuffer buffers[2][2];
    for (DeviceBuffer* pair : {buffers[0], buffers[1]}) {
      pair[0] = upload(lists.keys, "keys");
      pair[1] = upload(lists.values, "values");
    }
    const DeviceBuffer counted = upload<uint32_t>({count}, "count");
    RadixSort sort(device(), sizeof(Key) / 4);
    sort.reserve(count + spare);
    RadixSort::Pairs result;
    run([&](Commands& commands) {
      result = sort.record(commands, {buffers[0][0].address(), buffers[0][1].address()},
                           {buffers[1][0].address(), buffers[1][1].address()},
                           {.most = count + spare, .address = spare == 0 ? 0 : counted.address()}, bits);
    });
    const size_t at = (bits + 7) / 8 % 2;
    EXPECT_EQ(result.keys, buffers[at][0].address());
    EXPECT_EQ(result.values, buffers[at][1].address());
    return {download<Key>(buffers[at][0]), download<uint32_t>(buffers[at][1])};
  }
};

TEST_P(VulkanRadixSort, SortsLikeTheStandardLibrary) {
  const Lists<uint32_t> lists = randomLists<uint32_t>(GetParam(), 32);
  const Lists<uint32_t> once = sort(lists, 32);
  EXPECT_TRUE(once == sorted(lists, 32));
  EXPECT_TRUE(once == sort(lists, 32)) << "the second time";
}

TEST_P(VulkanRadixSort, LooksAtTheLowestBitsOnly) {
  for (const uint32_t bits : {3U, 11U, 17U}) {
    const Lists<uint32_t> lists = randomLists<uint32_t>(std::min(GetParam(), 200000U), bits);
    EXPECT_TRUE(sort(lists, bits) == sorted(lists, bits)) << bits;
  }
}

TEST_P(VulkanRadixSort, SortsByTwoWords) {
  const Lists<uint64_t> lists = randomLists<uint64_t>(std::min(GetParam(), 200000U), 64);
  EXPECT_TRUE(sort(lists, 64) == sorted(lists, 64));
  EXPECT_TRUE(sort(lists, 45) == sorted(lists, 45));
}

TEST_P(VulkanRadixSort, SortsAsManyAsTheDeviceCounted) {
  const Lists<uint32_t> lists = randomLists<uint32_t>(std::min(GetParam(), 200000U), 24);
  EXPECT_TRUE(sort(lists, 24, 70000) == sorted(lists, 24));
}

INSTANTIATE_TEST_SUITE_P(Sizes, VulkanRadixSort,
                         ::testing::Values(0, 1, 7, 255, 256, 257, 2047, 2048, 2049, 65535, 65536, 65537,
                                           196607, 196609, 3000000),
                         ::testing::PrintToStringParamName());

class VulkanRadixSortLimits : public VulkanTest {};

TEST_F(VulkanRadixSortLimits, RefuseMoreKeysOrBitsThanReserved) {
  RadixSort sort(device());
  sort.reserve(10);
  CommandBuffer own(device());
  Commands commands = own.begin();
  EXPECT_THROW(sort.record(commands, {}, {}, {.most = 11}, 32), std::logic_error);
  EXPECT_THROW(sort.record(commands, {}, {}, {.most = 10}, 33), std::logic_error);
  EXPECT_THROW(sort.reserve(0x40000001U), std::logic_error);
}

}  // namespace
}  // namespace raymap::vulkan
