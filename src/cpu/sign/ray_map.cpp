// Krayer & Müller 2019, §3.5, Eq. 3-8.

#include "cpu/sign/ray_map.h"

#include <algorithm>

#include "base/parallel.h"
#include "cpu/sign/crossings_lines.h"

namespace raymap::cpu {

namespace {

/// Sums the crossings of a line (Eq. 4-5): r(m) = w_l(m), r(i) = r(i + 1) + w_l(i). Each crossing gets a
/// step.
void sumLine(const Crossing* crossings, size_t count, RayStep* steps) {
  RayStep sum;
  for (size_t e = count; e-- > 0;) {
    sum.index = crossings[e].index;
    sum.signedSum += crossings[e].signedCount;
    sum.unsignedSum += crossings[e].unsignedCount;
    steps[e] = sum;
  }
}
}  // namespace

const RayStep* RayMap::find(int axis, const glm::ivec3& sample) const {
  const LineAxes a(axis);
  if (sample[a.u] < 0 || sample[a.u] >= dims[a.u] || sample[a.v] < 0 || sample[a.v] >= dims[a.v])
    return nullptr;  // There is no line of the lattice, so nothing is crossed.
  const int index = std::max(sample[axis], -1);
  const auto steps = axes[axis].line(size_t(sample[a.v]) * dims[a.u] + sample[a.u]);
  const auto step =
      std::partition_point(steps.begin(), steps.end(), [&](const RayStep& s) { return s.index < index; });
  return step == steps.end() ? nullptr : &*step;
}

int32_t RayMap::ray(int axis, glm::ivec3 sample) const {
  const RayStep* step = find(axis, sample);
  return step ? step->signedSum : 0;
}

int32_t RayMap::unsignedRay(int axis, glm::ivec3 sample) const {
  const RayStep* step = find(axis, sample);
  return step ? step->unsignedSum : 0;
}

int32_t RayMap::segment(int axis, glm::ivec3 from, int to) const {
  const int32_t start = ray(axis, from);
  from[axis] = to;
  return start - ray(axis, from);
}

int32_t RayMap::total(int axis, size_t line) const {
  const auto steps = axes[axis].line(line);
  return steps.empty() ? 0 : steps.front().signedSum;
}

size_t RayMap::bytes() const {
  size_t sum = 0;
  for (const Axis& axis : axes) sum += axis.starts.capacityBytes() + axis.steps.capacityBytes();
  return sum;
}

size_t RayMap::bytesNeeded(const Crossings& crossings) {
  size_t sum = 0;
  for (const AxisCrossings& axis : crossings)
    sum += axis.starts.size() * sizeof(uint64_t) + axis.entries.size() * sizeof(RayStep);
  return sum;
}

size_t RayMap::bytesExpected(const glm::ivec3& dims) {
  return lineCount(dims) * (sizeof(uint64_t) + kExpectedCrossings * sizeof(RayStep));
}

void buildRayMap(glm::ivec3 dims, const Crossings& crossings, RayMap& map) {
  map.dims = dims;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisCrossings& from = crossings[axis];
    RayMap::Axis& to = map.axes[axis];
    to.starts.resizeUninitialized(from.starts.size());
    to.steps.resizeUninitialized(from.entries.size());
    std::copy(from.starts.begin(), from.starts.end(), to.starts.begin());
    parallelFor(from.starts.size() - 1, kLinesPerTask, [&](size_t begin, size_t end) {
      for (size_t line = begin; line < end; ++line)
        sumLine(from.entries.data() + from.starts[line], size_t(from.starts[line + 1] - from.starts[line]),
                to.steps.data() + from.starts[line]);
    });
  }
}

}  // namespace raymap::cpu
