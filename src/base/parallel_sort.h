#pragma once

#include <tbb/parallel_sort.h>

#include "base/parallel.h"

namespace raymap {

/// Sorts, as `std::sort` does, with the threads of the call.
template <class Iterator, class... Less>
void parallelSort(Iterator begin, Iterator end, Less... less) {
  withCallersThreads([&] {
    if (parallelThreads() == 1)
      std::sort(begin, end, less...);
    else
      tbb::parallel_sort(begin, end, less...);
  });
}

}  // namespace raymap
