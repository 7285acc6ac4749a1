#include <raymap/buffer.h>
#include <raymap/error.h>

#include <cstdlib>

#include "base/memory.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace raymap {

namespace {
constexpr size_t kHugePage = size_t{2} << 20;
constexpr size_t kCacheLine = 64;

size_t alignmentFor(size_t bytes) {
  return bytes >= kHugePage ? kHugePage : kCacheLine;
}
size_t roundUp(size_t bytes, size_t to) {
  return (bytes + to - 1) / to * to;
}
}  // namespace

void* allocatePages(size_t bytes) {
  if (bytes == 0) return nullptr;
  const size_t alignment = alignmentFor(bytes);
  void* memory =
      bytes > SIZE_MAX - alignment ? nullptr : std::aligned_alloc(alignment, roundUp(bytes, alignment));
  if (!memory)
    throw Error(ErrorCode::Memory, "cannot allocate " + neededText(bytes) + "; use a lower resolution");
#ifdef __linux__
  // Not the last part: a large page would be held as a whole.
  if (alignment == kHugePage) madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
  return memory;
}

void freePages(void* memory) {
  std::free(memory);
}

}  // namespace raymap
