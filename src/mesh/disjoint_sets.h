#pragma once

#include <raymap/buffer.h>

#include <atomic>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/parallel.h"

namespace raymap {

/// Disjoint sets of numbers that any number of threads link at a time. The root of a set is its least number,
/// whatever the order of the links.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parents_(count) {
    parallelFor(count, size_t{1} << 16, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) parents_[k] = uint32_t(k);
    });
  }

  uint32_t root(uint32_t k) {
    for (;;) {
      uint32_t up = load(k);
      if (up == k) return k;
      const uint32_t above = load(up);
      if (above == up) return up;
      at(k).compare_exchange_weak(up, above, std::memory_order_relaxed);  // Halves the path.
      k = above;
    }
  }

  /// Joins the sets of two numbers. Returns the root that the other root was linked to, or nothing if there
  /// was only one set.
  std::optional<uint32_t> link(uint32_t a, uint32_t b) {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return {};
      if (a < b) std::swap(a, b);
      uint32_t expected = a;
      if (at(a).compare_exchange_weak(expected, b, std::memory_order_relaxed)) return b;
    }
  }

 private:
  std::atomic_ref<uint32_t> at(uint32_t k) { return std::atomic_ref(parents_[k]); }
  uint32_t load(uint32_t k) { return at(k).load(std::memory_order_relaxed); }

  Buffer<uint32_t> parents_;
};

}  // namespace raymap
