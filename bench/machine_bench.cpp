// The limits of this machine, which docs/performance.md compares each stage with.

#include <benchmark/benchmark.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/parallel.h"
#include "cpu/cells/triangle.h"

namespace raymap::bench {

namespace {

constexpr size_t kBytes = size_t{256} << 20;  // Far beyond the last cache.
constexpr size_t kPart = size_t{1} << 20;

template <class Work>
void forParts(int threads, Work&& work) {
  withThreads(threads,
              [&] { parallelFor(kBytes / kPart, 1, [&](size_t part, size_t) { work(part * kPart); }); });
}

/// Measures copies: bytes read plus bytes written.
void copy(benchmark::State& state) {
  const std::vector<char> from(kBytes, 1);
  std::vector<char> to(kBytes, 2);
  for (auto unused : state)
    forParts(int(state.range(0)), [&](size_t offset) { std::memcpy(&to[offset], &from[offset], kPart); });
  state.SetBytesProcessed(int64_t(2 * kBytes) * state.iterations());
}

void touchFreshPages(benchmark::State& state, int advice) {
  for (auto unused : state) {
    void* memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
      state.SkipWithError("no memory");
      return;
    }
    madvise(memory, kBytes, advice);
    forParts(int(state.range(0)),
             [&](size_t offset) { std::memset(static_cast<char*>(memory) + offset, 1, kPart); });
    munmap(memory, kBytes);
  }
  state.SetBytesProcessed(int64_t(kBytes) * state.iterations());
}

/// Measures the distance of one point from triangles in the first-level cache, one at a time.
void testTriangles(benchmark::State& state) {
  std::vector<glm::vec3> corners(3 * 256);
  for (size_t c = 0; c < corners.size(); ++c)
    corners[c] = glm::sin(float(c) * glm::vec3(12.9f, 78.2f, 37.7f));
  const glm::vec3 point(0.3f, 0.2f, 0.1f);
  for (auto unused : state) {
    float closest = HUGE_VALF;
    for (size_t c = 0; c < corners.size(); c += 3)
      closest =
          std::min(closest, cpu::triangleSquaredDistance(point, corners[c], corners[c + 1], corners[c + 2]));
    benchmark::DoNotOptimize(closest);
  }
  state.SetItemsProcessed(int64_t(corners.size() / 3) * state.iterations());
}

BENCHMARK(copy)->Name("machine/copy")->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK_CAPTURE(touchFreshPages, small, MADV_NOHUGEPAGE)
    ->Name("machine/first_touch_small_pages")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime();
BENCHMARK_CAPTURE(touchFreshPages, huge, MADV_HUGEPAGE)
    ->Name("machine/first_touch_huge_pages")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime();
BENCHMARK(testTriangles)->Name("machine/triangle_test_scalar")->Arg(1);

}  // namespace

}  // namespace raymap::bench
