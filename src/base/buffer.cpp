#include <raymap/buffer.h>
#include <raymap/error.h>

#include <cstdint>
#include <cstdlib>

#include "base/memory.h"

#if defined(__linux__) && !defined(RAYMAP_ADDRESS_SANITIZER)  // It watches the ends of malloc's arrays alone.
#include <sys/mman.h>
#define RAYMAP_MAPS_ARRAYS
#endif

namespace raymap {

namespace {

constexpr size_t kCacheLine = 64;

size_t roundUp(size_t bytes, size_t to) {
  return (bytes + to - 1) / to * to;
}

#ifdef RAYMAP_MAPS_ARRAYS

constexpr size_t kHugePage = size_t{2} << 20;
constexpr size_t kPage = size_t{64} << 10;  // A multiple of each system's.

/// Large arrays are mapped by themselves: when they are freed, the system has their memory back at once.
/// malloc would keep up to 64 MiB.
bool isMapped(size_t bytes) {
  return bytes >= kHugePage;
}

/// Returns memory on huge pages, or null.
void* map(size_t bytes) {
  const size_t size = roundUp(bytes, kPage);
  void* const all =
      mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) return nullptr;
  const auto place = reinterpret_cast<uintptr_t>(all);
  const size_t before = roundUp(place, kHugePage) - place;
  std::byte* const memory = static_cast<std::byte*>(all) + before;
  if (before > 0) munmap(all, before);
  munmap(memory + size, kHugePage - before);
  // Not the last part: a huge page would be held as a whole.
  madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
  return memory;
}

void unmap(void* memory, size_t bytes) {
  munmap(memory, roundUp(bytes, kPage));
}

#else

bool isMapped(size_t) {
  return false;
}
void* map(size_t) {
  return nullptr;
}
void unmap(void*, size_t) {}

#endif

}  // namespace

void* allocatePages(size_t bytes) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  if (bytes <= SIZE_MAX / 2)
    memory = isMapped(bytes) ? map(bytes) : std::aligned_alloc(kCacheLine, roundUp(bytes, kCacheLine));
  if (!memory)
    throw Error(ErrorCode::Memory,
                "cannot allocate " + neededText(bytes) + "; allow more memory, or use a lower resolution");
  return memory;
}

void freePages(void* memory, size_t bytes) {
  if (memory && isMapped(bytes))
    unmap(memory, bytes);
  else
    std::free(memory);
}

}  // namespace raymap
