// Krayer & Müller 2019, §3.5: local intersection counts, sorted by lattice line.

#include "cpu/sign/crossings_lines.h"

#include "base/parallel.h"

#include <algorithm>
#include <atomic>

namespace raymap::cpu {

namespace {

template <class Work>
void forEachRecord(const std::vector<LineRecords>& lists, int axis, Work&& work) {
  parallelFor(lists.size(), 1, [&](size_t list, size_t) {
    for (const LineRecord& record : lists[list][size_t(axis)]) work(record);
  });
}

uint64_t addOne(uint64_t& count) {
  return std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
}

/// Appends the records to their lines with a counting sort. The order within a line depends on the threads.
void appendRecords(const std::vector<LineRecords>& lists, int axis, RecordWeights weights,
                   AxisCrossings& crossings) {
  const size_t lines = crossings.starts.size() - 1;
  const AxisCrossings old{crossings.starts.clone(), crossings.entries.clone()};
  Buffer<uint64_t>& starts = crossings.starts;
  for (size_t line = 0; line < lines; ++line) starts[line] = old.starts[line + 1] - old.starts[line];
  forEachRecord(lists, axis, [&](const LineRecord& r) { addOne(starts[r.line]); });
  uint64_t total = 0;
  for (size_t line = 0; line < lines; ++line) total += std::exchange(starts[line], total);
  crossings.entries.resizeUninitialized(total);
  // starts[line + 1] counts up from the line's begin to its end, which is where the next line begins.
  for (size_t line = lines; line > 0; --line) {
    const uint64_t begin = old.starts[line - 1], count = old.starts[line] - begin;
    std::copy_n(old.entries.data() + begin, count, crossings.entries.data() + starts[line - 1]);
    starts[line] = starts[line - 1] + count;
  }
  starts[0] = 0;
  forEachRecord(lists, axis, [&](const LineRecord& r) {
    crossings.entries[addOne(starts[r.line + 1])] = {r.index, weights.signedCount * r.sign,
                                                     weights.unsignedCount};
  });
}

/// Sorts a line's crossings by index and adds up those with the same index. Removes those of no face. Returns
/// how many are left.
size_t mergeLine(Crossing* begin, Crossing* end) {
  if (begin == end) return 0;
  std::sort(begin, end, [](const Crossing& a, const Crossing& b) { return a.index < b.index; });
  Crossing* last = begin;
  for (Crossing* next = begin + 1; next < end; ++next) {
    if (next->index == last->index) {
      last->signedCount += next->signedCount;
      last->unsignedCount += next->unsignedCount;
    } else {
      *++last = *next;
    }
  }
  const auto isEmpty = [](const Crossing& c) { return c.unsignedCount == 0; };
  return size_t(std::remove_if(begin, last + 1, isEmpty) - begin);
}

void mergeLines(AxisCrossings& crossings) {
  const size_t lines = crossings.starts.size() - 1;
  std::vector<uint32_t> lengths(lines);
  parallelFor(lines, kLinesPerTask, [&](size_t begin, size_t end) {
    for (size_t line = begin; line < end; ++line)
      lengths[line] = static_cast<uint32_t>(mergeLine(crossings.entries.data() + crossings.starts[line],
                                                      crossings.entries.data() + crossings.starts[line + 1]));
  });
  uint64_t to = 0;
  for (size_t line = 0; line < lines; ++line) {
    const uint64_t from = std::exchange(crossings.starts[line], to);
    for (uint32_t e = 0; e < lengths[line]; ++e) crossings.entries[to++] = crossings.entries[from + e];
  }
  crossings.starts[lines] = to;
  crossings.entries.resizeUninitialized(to);
}

}  // namespace

size_t lineCount(const glm::ivec3& dims, int axis) {
  const LineAxes across(axis);
  return size_t(dims[across.u]) * size_t(dims[across.v]);
}

size_t lineCount(const glm::ivec3& dims) {
  return lineCount(dims, 0) + lineCount(dims, 1) + lineCount(dims, 2);
}

void clearLines(size_t lines, AxisCrossings& axis) {
  axis.starts.resizeUninitialized(lines + 1);
  std::fill(axis.starts.begin(), axis.starts.end(), 0);
  axis.entries.resizeUninitialized(0);
}

void addToLines(const std::vector<LineRecords>& lists, int axis, RecordWeights weights,
                AxisCrossings& crossings) {
  appendRecords(lists, axis, weights, crossings);
  mergeLines(crossings);
}

}  // namespace raymap::cpu
