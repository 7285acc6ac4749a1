#pragma once

#include "base/parallel.h"
#include "cpu/sign/crossings.h"

#include <vector>

namespace raymap::cpu {

/// Record of one triangle that crosses one lattice line.
struct LineRecord {
  uint32_t line;
  int32_t index;
  int32_t sign;
};
/// Records of each axis, in any order.
using LineRecords = std::array<std::vector<LineRecord>, 3>;

/// Returns the number of lattice lines along an axis.
size_t lineCount(const glm::ivec3& dims, int axis);
/// Returns the number of all lattice lines.
size_t lineCount(const glm::ivec3& dims);

void clearLines(size_t lines, AxisCrossings& axis);

/// Additions of a record to the two counts of its crossing. A triangle adds 1 to both. Removing it adds -1 to
/// both. Reversing it adds 2 to the signed count, with its new sign, and nothing to the other.
struct RecordWeights {
  int32_t signedCount, unsignedCount;
};

/// Sorts the records of one axis by line and index, and adds them to the existing crossings.
void addToLines(const std::vector<LineRecords>& lists, int axis, RecordWeights weights,
                AxisCrossings& crossings);

/// Edge of the lattice from one sample to the next along an axis, by their places on a grid, and its
/// crossings.
struct CrossedEdge {
  size_t from, to;
  int32_t signedCount;
};

/// Calls `add(sum, edge)` for the edges of a grid whose signed crossings are not zero. Returns the sums of
/// parts of the lattice, always the same parts.
template <class Sum, class Add>
std::vector<Sum> sumCrossedEdges(const glm::ivec3& dims, const Crossings& crossings, Add&& add) {
  constexpr size_t kLinesPerPart = 1024;
  const std::array<size_t, 3> strides{1, size_t(dims.x), size_t(dims.x) * size_t(dims.y)};
  std::vector<Sum> sums;
  for (int axis = 0; axis < 3; ++axis) {
    const LineAxes across(axis);
    const AxisCrossings& lines = crossings[size_t(axis)];
    const size_t count = lines.starts.size() - 1, width = size_t(dims[across.u]), before = sums.size(),
                 stride = strides[size_t(axis)];
    sums.resize(before + (count + kLinesPerPart - 1) / kLinesPerPart);
    parallelFor(sums.size() - before, 1, [&](size_t part, size_t) {
      for (size_t line = part * kLinesPerPart; line < std::min((part + 1) * kLinesPerPart, count); ++line) {
        const size_t first =
            line % width * strides[size_t(across.u)] + line / width * strides[size_t(across.v)];
        for (uint64_t c = lines.starts[line]; c < lines.starts[line + 1]; ++c) {
          const Crossing& crossing = lines.entries[c];
          if (crossing.signedCount == 0 || crossing.index < 0 || crossing.index + 1 >= dims[axis]) continue;
          const size_t from = first + size_t(crossing.index) * stride;
          add(sums[before + part], CrossedEdge{from, from + stride, crossing.signedCount});
        }
      }
    });
  }
  return sums;
}

}  // namespace raymap::cpu
