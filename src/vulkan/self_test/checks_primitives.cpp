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
template <class Key>
std::vector<Key> randomKeys(uint32_t count, uint32_t bits) {
  std::mt19937_64 random(count);
  std::vector<Key> keys(count);
  for (Key& key : keys) key = static_cast<Key>(random()) & ~(bits < 12 ? Key{6} : Key{0});
  return keys;
}

template <class Key>
void compareSort(const Probe& probe, uint32_t count, uint32_t bits, uint32_t spare) {
  const std::vector<Key> keys = randomKeys<Key>(count, bits);
  std::vector<uint32_t> values(
      count);  // Numbers of the keys, so that a change in the order of equal keys shows.
  std::iota(values.begin(), values.end(), 0U);
  std::array<std::array<DeviceBuffer, 2>, 2> buffers;
  for (auto& pair : buffers) pair = {probe.upload(keys, "keys"), probe.upload(values, "values")};
  const DeviceBuffer counted = probe.upload(std::vector{count}, "count");
  RadixSort sort(probe.device(), sizeof(Key) / 4);
  sort.reserve(count + spare);
  RadixSort::Pairs sorted;
  probe.run([&](Commands& commands) {
    sorted = sort.record(commands, {buffers[0][0].address(), buffers[0][1].address()},
                         {buffers[1][0].address(), buffers[1][1].address()},
                         {.most = count + spare, .address = spare == 0 ? 0 : counted.address()}, bits);
  });
  const std::array<DeviceBuffer, 2>& result = buffers[(bits + 7) / 8 % 2];
  const Key mask = static_cast<Key>(~Key{0}) >> (8 * sizeof(Key) - bits);
  std::ranges::stable_sort(values, {}, [&](uint32_t v) { return keys[v] & mask; });
  std::vector<Key> expected;
  for (const uint32_t v : values) expected.push_back(keys[v]);
  inCase(textOf(count) + " keys of " + textOf(bits) + " bits", [&] {
    require(sorted.keys == result[0].address() && sorted.values == result[1].address(),
            "the sort names other buffers");
    requireEqual("keys", probe.download<Key>(result[0]), expected);
    requireEqual("values", probe.download<uint32_t>(result[1]), values);
  });
}

// Sizes about those of groups, tiles and blocks.
constexpr uint32_t kSizes[] = {1, 255, 257, 4097, 65537};

void checkScan(Subject& subject) {
  for (const uint32_t size : kSizes) compareScan(subject.probe, size);
}

void checkRadixSort(Subject& subject) {
  for (const uint32_t size : {1U, 257U, 2049U, 65537U}) {
    compareRadixSort(subject.probe, size, 1, 32);
    compareRadixSort(subject.probe, size, 1, 11);
    compareRadixSort(subject.probe, size, 1, 24, 70000);
    compareRadixSort(subject.probe, size, 2, 45);
  }
}

}  // namespace

void compareScan(const Probe& probe, uint32_t count) {
  std::vector<uint32_t> values = randomValues(count);
  values.push_back(0xDEADBEEF);  // Space for the total, so that the sums can replace the values.
  std::vector<uint32_t> expected(values);
  std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0U);
  const uint32_t most = count + 100000;  // For some sizes more levels than needed.
  const DeviceBuffer in = probe.upload(values, "values"), inPlace = probe.upload(values, "values"),
                     counted = probe.upload(std::vector<uint32_t>{count}, "count");
  DeviceBuffer out(probe.device(), "sums");
  out.resize<uint32_t>(values.size());
  Scan scan(probe.device());
  scan.reserve(most);
  const auto sumsOf = [&](const DeviceBuffer& from, const DeviceBuffer& to, const Count& numbers) {
    probe.run([&](Commands& commands) { scan.record(commands, from.address(), to.address(), numbers); });
    return probe.download<uint32_t>(to);
  };
  inCase(textOf(count) + " numbers", [&] {
    requireEqual("sums", sumsOf(in, out, {.most = count}), expected);
    requireEqual("sums the second time", sumsOf(in, out, {.most = count}), expected);
    requireEqual("sums by a count of the device's",
                 sumsOf(in, out, {.most = most, .address = counted.address()}), expected);
    requireEqual("sums in place", sumsOf(inPlace, inPlace, {.most = count}), expected);
  });
}

void compareRadixSort(const Probe& probe, uint32_t count, int words, uint32_t bits, uint32_t spare) {
  (words == 1 ? compareSort<uint32_t> : compareSort<uint64_t>)(probe, count, bits, spare);
}

std::span<const Check> checksOfPrimitives() {
  static constexpr Check kChecks[] = {{"scan", checkScan}, {"radix_sort", checkRadixSort}};
  return kChecks;
}

}  // namespace raymap::vulkan
