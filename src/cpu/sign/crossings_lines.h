#pragma once

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

/// What a record adds to the two counts of its crossing. A triangle adds 1 to both. Removing it adds -1 to
/// both. Reversing it adds 2 to the signed count, with its new sign, and nothing to the other.
struct RecordWeights {
  int32_t signedCount, unsignedCount;
};

/// Sorts the records of one axis by line and index, and adds them to the existing crossings.
void addToLines(const std::vector<LineRecords>& lists, int axis, RecordWeights weights,
                AxisCrossings& crossings);

}  // namespace raymap::cpu
