// What this machine can do at most: the floors that docs/performance.md compares each stage with.

#include <sys/mman.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <vector>

#include "cpu/parallel.h"

namespace raymap::bench {

namespace {

constexpr size_t kBytes = size_t{256} << 20;  // Far beyond the last cache.
constexpr size_t kPart = size_t{1} << 20;
constexpr int kRounds = 7;

/// The best of several rounds, in seconds.
template <class Work>
double best(int rounds, Work&& work) {
  double seconds = HUGE_VAL;
  for (int round = 0; round < rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds =
        std::min(seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return seconds;
}

template <class Work>
void forParts(int threads, Work&& work) {
  withThreads(threads,
              [&] { parallelFor(kBytes / kPart, 1, [&](size_t part, size_t) { work(part * kPart); }); });
}

char* mapPages(bool huge) {
  void* memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  madvise(memory, kBytes, huge ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
  return static_cast<char*>(memory);
}

void measureCopy(int threads) {
  std::vector<char> from(kBytes, 1), to(kBytes, 2);
  const double seconds = best(kRounds, [&] {
    forParts(threads, [&](size_t offset) { std::memcpy(&to[offset], &from[offset], kPart); });
  });
  std::printf("| copy, bytes read + bytes written, %d thread%s | %.1f GB/s |\n", threads,
              threads > 1 ? "s" : "", 2e-9 * double(kBytes) / seconds);
}

void measureFirstTouch(int threads, bool huge) {
  const double seconds = best(kRounds, [&] {
    char* memory = mapPages(huge);
    forParts(threads, [&](size_t offset) { std::memset(memory + offset, 1, kPart); });
    munmap(memory, kBytes);
  });
  std::printf("| first touch of fresh memory, %s pages, %d thread%s | %.1f GB/s |\n", huge ? "huge" : "small",
              threads, threads > 1 ? "s" : "", 1e-9 * double(kBytes) / seconds);
}

}  // namespace

}  // namespace raymap::bench

int main() {
  using namespace raymap::bench;
  std::puts("| what | rate |\n|---|---|");
  for (const int threads : {1, 2}) measureCopy(threads);
  for (const bool huge : {false, true})
    for (const int threads : {1, 2}) measureFirstTouch(threads, huge);
  return 0;
}
