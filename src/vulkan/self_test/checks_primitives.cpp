#include <array>
#include <numeric>
#include <random>

#include "vulkan/primitives/radix_sort.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"

namespace raymap::vulkan {

namespace {

std::vector<uint32_t> randomValues(uint32_t count) {
  std::mt19937 random(count);
  std::vector<uint32_t> values(count);
  for (uint32_t& value : values) value = random() >> 8;
  return values;
}

/// The bits above those to sort by are random, and many keys are equal if these are few.
std::vector<uint32_t> randomKeys(uint32_t count, uint32_t bits) {
  std::mt19937 random(count);
  std::vector<uint32_t> keys(count);
  for (uint32_t& key : keys) key = random() & ~(bits < 12 ? 6U : 0U);
  return keys;
}

// Sizes about those of groups, tiles and blocks.
constexpr uint32_t kSizes[] = {1, 255, 257, 4097, 65537};

}  // namespace

void checkScan(Subject& subject) {
  for (const uint32_t size : kSizes) compareScan(subject.probe, size);
}

void checkRadixSort(Subject& subject) {
  for (const uint32_t size : {1U, 257U, 2049U, 65537U}) {
    compareRadixSort(subject.probe, size, 32);
    compareRadixSort(subject.probe, size, 11);
  }
}

void compareScan(const Probe& probe, uint32_t count) {
  std::vector<uint32_t> values = randomValues(count);
  values.push_back(0xDEADBEEF);  // Space for the total, so that the sums can replace the values.
  std::vector<uint32_t> expected(values);
  std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0U);
  const DeviceBuffer in = probe.upload(values, "values"), inPlace = probe.upload(values, "values");
  const DeviceBuffer out = probe.room<uint32_t>(values.size(), "sums");
  Scan scan(probe.device());
  scan.reserve(count);
  const auto sumsOf = [&](const DeviceBuffer& from, const DeviceBuffer& to) {
    probe.run([&](Commands& commands) { scan.record(commands, from.address(), to.address(), count); });
    return probe.download<uint32_t>(to);
  };
  inCase(textOf(count) + " numbers", [&] {
    requireEqual("sums", sumsOf(in, out), expected);
    requireEqual("sums the second time", sumsOf(in, out), expected);
    requireEqual("sums in place", sumsOf(inPlace, inPlace), expected);
  });
}

void compareRadixSort(const Probe& probe, uint32_t count, uint32_t bits) {
  const std::vector<uint32_t> keys = randomKeys(count, bits);
  std::vector<uint32_t> values(
      count);  // Numbers of the keys, so that a change in the order of equal keys shows.
  std::iota(values.begin(), values.end(), 0U);
  std::array<std::array<DeviceBuffer, 2>, 2> buffers;
  for (auto& pair : buffers) pair = {probe.upload(keys, "keys"), probe.upload(values, "values")};
  RadixSort sort(probe.device());
  sort.reserve(count);
  RadixSort::Pairs sorted;
  probe.run([&](Commands& commands) {
    sorted = sort.record(commands, {buffers[0][0].address(), buffers[0][1].address()},
                         {buffers[1][0].address(), buffers[1][1].address()}, count, bits);
  });
  const std::array<DeviceBuffer, 2>& result = buffers[(bits + 7) / 8 % 2];
  const uint32_t mask = ~0U >> (32 - bits);
  std::ranges::stable_sort(values, {}, [&](uint32_t v) { return keys[v] & mask; });
  std::vector<uint32_t> expected;
  for (const uint32_t v : values) expected.push_back(keys[v]);
  inCase(textOf(count) + " keys of " + textOf(bits) + " bits", [&] {
    require(sorted.keys == result[0].address() && sorted.values == result[1].address(),
            "the sort names other buffers");
    requireEqual("keys", probe.download<uint32_t>(result[0]), expected);
    requireEqual("values", probe.download<uint32_t>(result[1]), values);
  });
}

}  // namespace raymap::vulkan
