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

/// The values number the keys, so that a change in the order of equal keys shows.
template <class Key>
struct Lists {
  std::vector<Key> keys;
  std::vector<uint32_t> values;
};

template <class Key>
Lists<Key> randomLists(uint32_t count, uint32_t bits) {
  std::mt19937_64 random(count);
  Lists<Key> lists{std::vector<Key>(count), std::vector<uint32_t>(count)};
  // The bits above those to sort by are random.
  for (Key& key : lists.keys) key = static_cast<Key>(random()) & ~(bits < 12 ? Key{6} : Key{0});
  std::iota(lists.values.begin(), lists.values.end(), 0U);
  return lists;
}

template <class Key>
Lists<Key> sorted(const Lists<Key>& lists, uint32_t bits) {
  const Key mask = static_cast<Key>(~Key{0}) >> (8 * sizeof(Key) - bits);
  Lists<Key> result{std::vector<Key>(lists.keys.size()), lists.values};
  std::stable_sort(result.values.begin(), result.values.end(),
                   [&](uint32_t a, uint32_t b) { return (lists.keys[a] & mask) < (lists.keys[b] & mask); });
  for (size_t i = 0; i < result.keys.size(); ++i) result.keys[i] = lists.keys[result.values[i]];
  return result;
}

/// If `spare` is given, only the device knows the count, which is this much below the capacity.
template <class Key>
void compareSort(const Probe& probe, uint32_t count, uint32_t bits, uint32_t spare = 0) {
  const Lists<Key> lists = randomLists<Key>(count, bits);
  std::array<std::array<DeviceBuffer, 2>, 2> buffers;
  for (auto& pair : buffers) pair = {probe.upload(lists.keys, "keys"), probe.upload(lists.values, "values")};
  const DeviceBuffer counted = probe.upload<uint32_t>({count}, "count");
  RadixSort sort(probe.device(), sizeof(Key) / 4);
  sort.reserve(count + spare);
  probe.run([&](Commands& commands) {
    sort.record(commands, {buffers[0][0].address(), buffers[0][1].address()},
                {buffers[1][0].address(), buffers[1][1].address()},
                {.most = count + spare, .address = spare == 0 ? 0 : counted.address()}, bits);
  });
  const std::array<DeviceBuffer, 2>& result = buffers[(bits + 7) / 8 % 2];
  const Lists<Key> expected = sorted(lists, bits);
  inCase(textOf(count) + " keys of " + textOf(bits) + " bits", [&] {
    requireEqual("keys", probe.download<Key>(result[0]), expected.keys);
    requireEqual("values", probe.download<uint32_t>(result[1]), expected.values);
  });
}

// Sizes about those of groups, tiles and blocks.
constexpr uint32_t kSizes[] = {1, 255, 257, 4097, 65537};

void checkScan(Subject& subject) {
  for (const uint32_t size : kSizes) compareScan(subject.probe, size);
}

void checkRadixSort(Subject& subject) {
  for (const uint32_t size : {1U, 257U, 2049U, 65537U}) compareRadixSort(subject.probe, size);
}

}  // namespace

void compareScan(const Probe& probe, uint32_t count) {
  std::vector<uint32_t> values = randomValues(count);
  values.push_back(0xDEADBEEF);  // Space for the total, so that the sums can replace the values.
  std::vector<uint32_t> expected(values);
  std::exclusive_scan(values.begin(), values.end(), expected.begin(), 0U);
  const uint32_t most = count + 100000;  // For some sizes more levels than needed.
  const DeviceBuffer in = probe.upload(values, "values"), inPlace = probe.upload(values, "values"),
                     counted = probe.upload<uint32_t>({count}, "count");
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

void compareRadixSort(const Probe& probe, uint32_t count) {
  compareSort<uint32_t>(probe, count, 32);
  compareSort<uint32_t>(probe, count, 11);
  compareSort<uint32_t>(probe, count, 24, 70000);
  compareSort<uint64_t>(probe, count, 45);
}

std::span<const Check> checksOfPrimitives() {
  static constexpr Check kChecks[] = {{"scan", checkScan}, {"radix_sort", checkRadixSort}};
  return kChecks;
}

}  // namespace raymap::vulkan
