#pragma once

#include <raymap/buffer.h>

#include <cstddef>
#include <cstdint>

#include "base/parallel.h"

namespace raymap {

/// Sixteen bytes that sort as one number: by `high`, then by `low`.
struct alignas(16) SortKey {
  uint64_t low, high;
};

/// Sorts `count` keys into `keys` with all threads. `make(begin, end, to)` writes the keys numbered
/// [begin, end) to `to`; it is called more than once for each key, from any thread. Keys with equal `high`
/// are sorted by one thread.
void sortKeys(size_t count, FunctionView<size_t, size_t, SortKey*> make, Buffer<SortKey>& keys);

}  // namespace raymap
