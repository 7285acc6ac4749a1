// Relaxation of the harmonic winding number.

#include <algorithm>

#include "base/parallel.h"
#include "cpu/sign/winding_harmonic_rows.h"
#include "cpu/sign/winding_harmonic_transfer.h"

namespace raymap::cpu {

namespace {
constexpr size_t kPlanesPerSlab = 8;

void relaxSlab(const LatticeBox& box, const RightHandSide& rightHandSide, int colour, int begin, int end,
               float* values) {
  std::vector<float> scratch(size_t(box.dims.x), 0.0f);
  for (int k = std::max(begin, 1); k < std::min(end, box.dims.z - 1); ++k)
    for (int j = 1; j + 1 < box.dims.y; ++j) {
      const RowStencil around{.jBefore = box.row(values, j - 1, k),
                              .jAfter = box.row(values, j + 1, k),
                              .kBefore = box.row(values, j, k - 1),
                              .kAfter = box.row(values, j, k + 1),
                              .rightHandSide = rightHandSide.row(box, j, k, scratch)};
      relaxRow(around, 1 + size_t((j + k + colour) & 1), size_t(box.dims.x), box.row(values, j, k));
      rightHandSide.clear(box, j, k, scratch);
    }
}
}  // namespace

const float* RightHandSide::row(const LatticeBox& box, int j, int k, std::vector<float>& scratch) const {
  if (values) return box.row(values, j, k);
  for (const JumpRows& along : *jumps) along.addTo(scratch.data(), box.row(j, k), 1.0f);
  return scratch.data();
}

void RightHandSide::clear(const LatticeBox& box, int j, int k, std::vector<float>& scratch) const {
  if (values) return;
  for (const JumpRows& along : *jumps)
    for (const JumpRows::Jump& jump : along.row(box.row(j, k))) scratch[size_t(jump.x)] = 0.0f;
}

void relaxField(const LatticeBox& box, const RightHandSide& rightHandSide, WorkMeter& meter, float* values) {
  const size_t slabs = (size_t(box.dims.z) + kPlanesPerSlab - 1) / kPlanesPerSlab;
  // Every second slab runs at a time, so that no slab reads a neighbour that is being written.
  for (const int colour : {0, 1})
    for (const size_t parity : {0, 1})
      parallelFor((slabs + 1 - parity) / 2, 1, [&](size_t task, size_t) {
        const auto begin = int((2 * task + parity) * kPlanesPerSlab), end = begin + int(kPlanesPerSlab);
        relaxSlab(box, rightHandSide, colour, begin, end, values);
        meter.add(box.planeSamples(begin, end) / 2);
      });
}

void overrelaxField(const LatticeBox& box, const RightHandSide& rightHandSide, int sweeps, float* values) {
  const float factor = overrelaxation(box.dims);
  std::vector<float> scratch(size_t(box.dims.x), 0.0f);
  for (int half = 0; half < 2 * sweeps; ++half)
    for (int k = 1; k + 1 < box.dims.z; ++k)
      for (int j = 1; j + 1 < box.dims.y; ++j) {
        float* row = box.row(values, j, k);
        const float *jBefore = box.row(values, j - 1, k), *jAfter = box.row(values, j + 1, k);
        const float *kBefore = box.row(values, j, k - 1), *kAfter = box.row(values, j, k + 1);
        const float* asked = rightHandSide.row(box, j, k, scratch);
        for (int i = 1 + ((j + k + half) & 1); i + 1 < box.dims.x; i += 2) {
          const float sum =
              (row[i - 1] + row[i + 1]) + (jBefore[i] + jAfter[i]) + ((kBefore[i] + kAfter[i]) + asked[i]);
          row[i] += factor * (sum * (1.0f / 6.0f) - row[i]);
        }
        rightHandSide.clear(box, j, k, scratch);
      }
}

}  // namespace raymap::cpu
