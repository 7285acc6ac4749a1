#pragma once

#include <tbb/parallel_sort.h>

#include "base/parallel.h"

namespace raymap {

/// Sorts, as `std::sort` does, with the threads of the call.
template <class Iterator, class... Less>
void parallelSort(Iterator begin, Iterator end, Less... less) {
  withCallersThreads([&] { tbb::parallel_sort(begin, end, less...); });
}

}  // namespace raymap
