// Ours: orders the triangles of the tree behind exact_distance, a run of the curve at a time.

#include "cpu/distance/surface_leaves.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/distance/surface_order.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Fields of a place, 16 bits each, from the lowest on. Field 0 is the index.
constexpr int kZ = 1, kY = 2, kX = 3, kFields = 4;

/// Largest number of places that comparing all with all sorts fastest.
constexpr size_t kRankSorted = 64;

/// Measures the extent of each field. `count` must be at least 8.
HWY_INLINE void measure(const Place* places, size_t count, uint16_t (&extent)[kFields]) {
  constexpr size_t kAtOnce = kFields * kPacket;
  uint16_t low[kAtOnce], high[kAtOnce] = {}, fields[kAtOnce];
  std::fill_n(low, kAtOnce, UINT16_MAX);
  for (size_t t = 0; t < count; t += kPacket) {
    // The last eight places overlap those before rather than reach beyond the end.
    std::memcpy(fields, places + std::min(t, count - kPacket), sizeof(fields));
    for (size_t i = 0; i < kAtOnce; ++i) {
      low[i] = std::min(low[i], fields[i]);
      high[i] = std::max(high[i], fields[i]);
    }
  }
  for (size_t field = 0; field < kFields; ++field) {
    for (size_t i = field; i < kAtOnce; i += kFields) {
      low[field] = std::min(low[field], low[i]);
      high[field] = std::max(high[field], high[i]);
    }
    extent[field] = static_cast<uint16_t>(high[field] - low[field]);
  }
}

/// Sorts a few places by counting for each how many are smaller.
HWY_INLINE void sortByRank(Place* places, size_t count) {
  const hn::CappedTag<uint64_t, kPacket> d;
  Place sorted[kRankSorted], padded[kRankSorted + kPacket];
  count = std::min(count, size_t{kRankSorted});  // Never more; GCC 14 warns of counts below 0 otherwise.
  std::copy_n(places, count, padded);
  std::fill_n(padded + count, kPacket, ~Place{0});
  for (size_t t = 0; t < count; ++t) {
    size_t smaller = 0;
    for (size_t i = 0; i < count; i += hn::Lanes(d))
      smaller += hn::CountTrue(d, hn::Lt(hn::LoadU(d, padded + i), hn::Set(d, padded[t])));
    sorted[smaller] = padded[t];
  }
  std::copy_n(sorted, count, places);
}

/// Returns a place from a sample, such that about `middle - begin` places are smaller.
HWY_INLINE Place guessMiddle(const Place* begin, const Place* middle, const Place* end) {
  constexpr size_t kSample = 16;
  const auto count = static_cast<size_t>(end - begin);
  Place sample[kSample];
  for (size_t i = 0; i < kSample; ++i) sample[i] = begin[(2 * i + 1) * count / (2 * kSample)];
  sortByRank(sample, kSample);
  return sample[static_cast<size_t>(middle - begin) * kSample / count];
}

/// Moves the smallest places before `middle`: quickselect, without a branch on the result of a comparison.
HWY_INLINE void selectMiddle(Place* begin, const Place* middle, Place* end) {
  while (end - begin > ptrdiff_t{kRankSorted}) {
    const Place pivot = guessMiddle(begin, middle, end);
    Place* smaller = begin;
    for (Place* next = begin; next < end; ++next) {
      const Place place = *next;
      *next = *smaller;
      *smaller = place;
      smaller += place < pivot;
    }
    if (smaller == middle) return;
    if (smaller == begin) {
      // The pivot is the smallest of all. It moves to the front, so that each round leaves fewer places.
      std::swap(*begin, *std::find(begin, end, pivot));
      ++begin;
    } else if (smaller < middle) {
      begin = smaller;
    } else {
      end = smaller;
    }
  }
  sortByRank(begin, static_cast<size_t>(end - begin));
}

/// Halves the run across its longest side until only leaves are left. Each half becomes a run of its own; the
/// first has a power of two of places.
void sortRun(Place* places, size_t count) {
  if (count <= kPacket) return;
  uint16_t extent[kFields];
  measure(places, count, extent);
  const int field = extent[kX] >= extent[kY] && extent[kX] >= extent[kZ] ? kX
                    : extent[kY] >= extent[kZ]                           ? kY
                                                                         : kZ;
  const int shift = 16 * (kX - field);
  const size_t half = std::bit_ceil(count) / 2;
  for (size_t t = 0; t < count; ++t) places[t] = std::rotl(places[t], shift);
  selectMiddle(places, places + half, places + count);
  for (size_t t = 0; t < count; ++t) places[t] = std::rotr(places[t], shift);
  sortRun(places, half);
  sortRun(places + half, count - half);
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(sortRun);

void sortRun(Place* places, size_t count) {
  HWY_DYNAMIC_DISPATCH(sortRun)(places, count);
}

}  // namespace raymap::cpu
#endif
