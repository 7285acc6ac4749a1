// Times of copies, prefix sums and sorts on the best Vulkan device, by its own clock: NAME/ELEMENTS.
// `bytes_per_second` counts the least that each must move; it compares with copy.

#include <benchmark/benchmark.h>
#include <raymap/error.h>

#include <cstdio>
#include <memory>

#include "vulkan/device/command_buffer.h"
#include "vulkan/primitives/radix_sort.h"

namespace raymap::vulkan::bench {

namespace {

std::unique_ptr<Device> sharedDevice;

Device& device() {
  return *sharedDevice;
}

DeviceBuffer buffer(const char* name, uint64_t elements) {
  DeviceBuffer result(device(), name);
  result.resize<uint32_t>(elements);
  return result;
}

/// Times the commands that `record` records, each time after those of `prepare`.
template <class Prepare, class Record>
void measure(benchmark::State& state, int64_t bytes, Prepare&& prepare, Record&& record) {
  CommandBuffer own(device());
  const auto run = [&] {
    Commands commands = own.begin();
    prepare(commands);
    commands.startStage("measured");
    record(commands);
    commands.stopStage();
    own.submitAndWait();
    return own.times();
  };
  if (run().empty()) {  // This run compiles the kernels.
    state.SkipWithError("the device has no timestamps");
    return;
  }
  for (auto unused : state) state.SetIterationTime(run().front().milliseconds * 1e-3);
  state.SetBytesProcessed(bytes * int64_t(state.iterations()));
}

void copy(benchmark::State& state) {
  const int64_t count = state.range(0);
  const DeviceBuffer from = buffer("from", count), to = buffer("to", count);
  measure(
      state, 2 * 4 * count, [&](Commands& commands) { commands.fill(from, 1); },
      [&](Commands& commands) { commands.copy(from, to, from.bytes()); });
}

void scan(benchmark::State& state) {
  const auto count = static_cast<uint32_t>(state.range(0));
  const DeviceBuffer values = buffer("values", count), sums = buffer("sums", count + 1);
  Scan scan(device());
  scan.reserve(count);
  measure(
      state, int64_t{3 * 4} * count, [&](Commands& commands) { commands.fill(values, 1); },
      [&](Commands& commands) { scan.record(commands, values.address(), sums.address(), {.most = count}); });
}

/// Each pass reads the keys twice and the values once, and writes both once.
void radixSort(benchmark::State& state) {
  const auto count = static_cast<uint32_t>(state.range(0));
  DeviceBuffer random(device(), "random", MemoryUse::Upload);
  random.resize<uint32_t>(count);
  uint32_t last = 1;
  for (uint32_t& key : random.mapped<uint32_t>()) key = last = last * 1664525U + 1013904223U;
  const DeviceBuffer keys = buffer("keys", count), values = buffer("values", count);
  const DeviceBuffer otherKeys = buffer("other keys", count), otherValues = buffer("other values", count);
  RadixSort sort(device());
  sort.reserve(count);
  measure(
      state, int64_t{4 * 5 * 4} * count,
      [&](Commands& commands) { commands.copy(random, keys, keys.bytes()); },
      [&](Commands& commands) {
        sort.record(commands, {keys.address(), values.address()},
                    {otherKeys.address(), otherValues.address()}, {.most = count}, 32);
      });
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->RangeMultiplier(16)->Range(1 << 12, 1 << 24)->UseManualTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(copy)->Apply(sizes);
BENCHMARK(scan)->Apply(sizes);
BENCHMARK(radixSort)->Apply(sizes);

}  // namespace

}  // namespace raymap::vulkan::bench

int main(int argc, char** argv) {
  using namespace raymap::vulkan;
  benchmark::Initialize(&argc, argv);
  try {
    bench::sharedDevice = std::make_unique<Device>();
    benchmark::AddCustomContext("device", bench::device().info().name);
    benchmark::AddCustomContext("driver", bench::device().info().driver);
    benchmark::RunSpecifiedBenchmarks();
    bench::sharedDevice.reset();
  } catch (const raymap::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
