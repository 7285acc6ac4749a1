#pragma once

#include <tbb/parallel_sort.h>

namespace raymap {

/// Sorts, as `std::sort` does, with all threads.
template <class Iterator, class... Less>
void parallelSort(Iterator begin, Iterator end, Less... less) {
  tbb::parallel_sort(begin, end, less...);
}

}  // namespace raymap
