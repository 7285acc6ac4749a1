// Ours, after Krayer & Müller 2019, §3.5: the field says which way the faces point.

#include "cpu/sign/orientation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "cpu/sign/ray_sweep.h"
#include "method/orientation_shared.h"

namespace raymap::cpu {

namespace {

struct Misfit {
  double squares = 0.0, jumps = 0.0;
};

/// Adds the misfit of one line. The field fits as well as possible, so the residual is orthogonal to all
/// differences of fields. Its square is then its product with the jumps, and only crossed edges count.
void addLine(std::span<const Crossing> line, const float* field, size_t stride, int samples, Misfit& sum) {
  for (const Crossing& crossing : line) {
    if (crossing.signedCount == 0 || crossing.index < 0 || crossing.index + 1 >= samples) continue;
    const float* at = field + size_t(crossing.index) * stride;
    const double jump = crossing.signedCount;
    sum.squares += jump * (jump - (double(at[0]) - double(at[stride])));
    sum.jumps += std::abs(jump);
  }
}

/// Returns the number of a sample's six rays that cross an odd number of faces. A sum of +1 and -1 is odd
/// exactly if their number is odd.
int oddRays(const RayRow& row, size_t i) {
  const auto odd = [](int32_t ray) { return ray & 1; };
  return odd(row.x[i]) + odd(row.x[i] - row.totalX) + odd(row.y[i]) + odd(row.y[i] - row.totalY[i]) +
         odd(row.z[i]) + odd(row.z[i] - row.totalZ[i]);
}

}  // namespace

double measureMisfit(const glm::ivec3& dims, const Crossings& crossings, const Buffer<float>& winding) {
  constexpr size_t kLinesPerPart = 1024;
  const size_t strides[] = {1, size_t(dims.x), size_t(dims.x) * size_t(dims.y)};
  Misfit sum;
  for (int axis = 0; axis < 3; ++axis) {
    const LineAxes across(axis);
    const AxisCrossings& lines = crossings[size_t(axis)];
    const size_t count = lines.starts.size() - 1, width = size_t(dims[across.u]);
    // Each part has its own sum, so that the order of all additions is always the same.
    std::vector<Misfit> parts((count + kLinesPerPart - 1) / kLinesPerPart);
    parallelFor(parts.size(), 1, [&](size_t part, size_t) {
      for (size_t line = part * kLinesPerPart; line < std::min((part + 1) * kLinesPerPart, count); ++line) {
        const uint64_t first = lines.starts[line], end = lines.starts[line + 1];
        const size_t sample = line % width * strides[across.u] + line / width * strides[across.v];
        addLine({lines.entries.data() + first, size_t(end - first)}, winding.data() + sample, strides[axis],
                dims[axis], parts[part]);
      }
    });
    for (const Misfit& part : parts) {
      sum.squares += part.squares;
      sum.jumps += part.jumps;
    }
  }
  return sum.jumps > 0.0 ? sum.squares / sum.jumps : 0.0;
}

bool contradictsParity(const RayMap& map, const Buffer<float>& winding, double threshold) {
  const RaySweep sweep(map);
  const auto limit = static_cast<float>(threshold);
  std::atomic<bool> does = false;
  sweep.run([&](const RayRow& row) {
    if (does) return;
    const float* const w = winding.data() + row.first;
    int32_t found = 0;
    for (size_t i = 0; i < sweep.rowLength(); ++i) {  // Without branches the compiler vectorizes the loop.
      const int32_t a = row.x[i], b = a - row.totalX, c = row.y[i], d = c - row.totalY[i], e = row.z[i],
                    f = e - row.totalZ[i];
      const int32_t allOdd = a & b & c & d & e & f & 1, allEven = ~(a | b | c | d | e | f) & 1;
      const float excess = std::abs(w[i]) - limit;
      const int32_t isSure = std::abs(excess) > kSureSign ? 1 : 0;
      found |= isSure & (excess > 0.0f ? allEven : allOdd);
    }
    if (found != 0) does = true;
  });
  return does;
}

void averageParity(const RayMap& map, Buffer<float>& parity) {
  const RaySweep sweep(map);
  parity.resizeUninitialized(sweep.sampleCount());
  sweep.run([&](const RayRow& row) {
    for (size_t i = 0; i < sweep.rowLength(); ++i) parity[row.first + i] = float(oddRays(row, i)) / 6.0f;
  });
}

}  // namespace raymap::cpu
