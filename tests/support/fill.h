#pragma once

#include <raymap/buffer.h>

#include <algorithm>
#include <vector>

namespace raymap {

/// Gives a buffer these values.
template <class T>
void fill(Buffer<T>& buffer, const std::vector<T>& values) {
  buffer.resizeUninitialized(values.size());
  std::ranges::copy(values, buffer.begin());
}

}  // namespace raymap
