// The entry of raymap-vdb.plugin, and what its writers call of the library.

#include "io/field/vdb_module.h"

#include <raymap/version.h>

namespace raymap {

namespace {

VdbHost host;

constexpr VdbWriters kWriters{writeVdb, writeVdb, writeNvdb, writeNvdb};

}  // namespace

void parallelFor(size_t count, size_t grain, FunctionView<size_t, size_t> work) {
  host.parallelFor(count, grain, work);
}

void withCallersThreads(FunctionView<> work) {
  host.withCallersThreads(work);
}

void checkFormatMemory(uint64_t bytes) {
  host.checkFormatMemory(bytes);
}

std::vector<NamedArray> arraysWith(const Field& field, const NamedArray& asked) {
  return host.arraysWith(field, asked);
}

float largestMagnitude(std::span<const float> values) {
  return host.largestMagnitude(values);
}

}  // namespace raymap

// NOLINTNEXTLINE(readability-identifier-naming): a symbol for the dynamic loader.
extern "C" __attribute__((visibility("default"))) const raymap::VdbWriters* raymapVdbWriters(
    const raymap::VdbHost& given) {
  if (given.version != RAYMAP_VERSION || given.fieldBytes != sizeof(raymap::Field)) return nullptr;
  raymap::host = given;
  return &raymap::kWriters;
}
