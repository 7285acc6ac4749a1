// Transfers fields between the lattices of the harmonic winding number.

#include "cpu/sign/winding_harmonic_transfer.h"

#include <algorithm>

#include "base/parallel.h"
#include "cpu/sign/winding_harmonic_rows.h"

namespace raymap::cpu {

namespace {

constexpr size_t kPairsPerTask = 4;

/// Interpolates from a coarse lattice to the next finer one, plane by plane, with or without jumps.
class Interpolation {
 public:
  Interpolation(const LatticeBox& coarse, const float* from, const LatticeBox& fine,
                const std::array<JumpRows, 3>* jumps, WorkMeter& meter)
      : coarse_(coarse),
        from_(from),
        fine_(fine),
        jumps_(jumps),
        meter_(meter),
        shift_(fine.low / 2 - coarse.low) {}

  /// Calls `write(before, after, j, k)` for all rows. Row (j, k) is the mean of both rows, which are equal in
  /// even planes.
  template <class Write>
  void run(Write&& write) const {
    parallelFor((size_t(fine_.dims.z) + 1) / 2, kPairsPerTask, [&](size_t begin, size_t end) {
      const size_t planeSize = size_t(fine_.dims.x) * (size_t(fine_.dims.y) + 1);
      std::vector<float> plane(planeSize), next(planeSize);
      fillPlane(int(2 * begin), plane.data());
      for (int k = int(2 * begin); k < std::min(int(2 * end), fine_.dims.z); k += 2) {
        for (int j = 0; j < fine_.dims.y; ++j) {
          const float* row = fine_.row(plane.data(), j, 0);
          write(row, row, j, k);
        }
        if (k + 1 == fine_.dims.z) break;
        fillPlane(k + 2, next.data());
        for (int j = 0; j < fine_.dims.y; ++j)
          write(fine_.row(plane.data(), j, 0), fine_.row(next.data(), j, 0), j, k + 1);
        plane.swap(next);
      }
      meter_.add(fine_.planeSamples(int(2 * begin), int(2 * end)));
    });
  }

 private:
  /// Fills plane k, which is even. The plane and its last row may lie just beyond the box.
  void fillPlane(int k, float* plane) const {
    for (int j = 0; j <= fine_.dims.y; j += 2) fillRow(j, k, fine_.row(plane, j, 0));
    for (int j = 1; j < fine_.dims.y; j += 2) {
      const float *before = fine_.row(plane, j - 1, 0), *after = fine_.row(plane, j + 1, 0);
      float* row = fine_.row(plane, j, 0);
      for (int i = 0; i < fine_.dims.x; ++i) row[i] = 0.5f * (before[i] + after[i]);
      if (jumps_ && k < fine_.dims.z) (*jumps_)[1].addTo(row, fine_.row(j, k), 0.5f);
    }
  }

  void fillRow(int j, int k, float* row) const {
    const float* from = coarse_.row(from_, j / 2 + shift_.y, k / 2 + shift_.z) + shift_.x;
    const size_t pairs = size_t(fine_.dims.x) / 2;
    for (size_t i = 0; i < pairs; ++i) {
      row[2 * i] = from[i];
      row[2 * i + 1] = 0.5f * (from[i] + from[i + 1]);
    }
    if (fine_.dims.x % 2) row[2 * pairs] = from[pairs];
    if (!jumps_ || j >= fine_.dims.y || k >= fine_.dims.z) return;
    for (const JumpRows::Jump& jump : (*jumps_)[0].row(fine_.row(j, k)))
      if (jump.x % 2) row[jump.x] += 0.5f * jump.height;
  }

  const LatticeBox& coarse_;
  const float* from_;
  const LatticeBox& fine_;
  const std::array<JumpRows, 3>* jumps_;
  WorkMeter& meter_;
  glm::ivec3 shift_;
};

/// Restricts planes of residuals, with weights 1/4, 1/2, 1/4 along x and y.
class ResidualPlanes {
 public:
  ResidualPlanes(const LatticeBox& fine, const RightHandSide& rightHandSide, const float* values)
      : fine_(fine),
        rightHandSide_(rightHandSide),
        values_(values),
        size_((fine.dims + 1) / 2),
        scratch_(size_t(fine.dims.x), 0.0f),
        residual_(size_t(fine.dims.x) + 2, 0.0f) {}

  const glm::ivec3& size() const { return size_; }

  /// Restricts plane k along x and y. The residual is taken as zero outside the box and on its border.
  void restrictPlane(int k, float* plane) {
    std::fill_n(plane, size_t(size_.x) * size_t(size_.y), 0.0f);
    if (k < 1 || k + 1 >= fine_.dims.z) return;
    for (int j = 1; j + 1 < fine_.dims.y; ++j) {
      computeRow(j, k);
      if (j % 2 == 0) {
        addRow(0.5f, plane + size_t(j / 2) * size_t(size_.x));
      } else {
        addRow(0.25f, plane + size_t(j / 2) * size_t(size_.x));
        if (j / 2 + 1 < size_.y) addRow(0.25f, plane + size_t(j / 2 + 1) * size_t(size_.x));
      }
    }
  }

 private:
  /// Fills `residual_`: element 1 + i is sample i's, with a zero before the first and after the last.
  void computeRow(int j, int k) {
    const RowStencil around{.jBefore = fine_.row(values_, j - 1, k),
                            .jAfter = fine_.row(values_, j + 1, k),
                            .kBefore = fine_.row(values_, j, k - 1),
                            .kAfter = fine_.row(values_, j, k + 1),
                            .rightHandSide = rightHandSide_.row(fine_, j, k, scratch_)};
    residualRow(around, size_t(fine_.dims.x), fine_.row(values_, j, k), residual_.data() + 1);
    rightHandSide_.clear(fine_, j, k, scratch_);
  }

  void addRow(float weight, float* row) const {
    const float* r = residual_.data() + 1;
    for (ptrdiff_t i = 0; i < size_.x; ++i)
      row[i] += weight * (0.5f * r[2 * i] + 0.25f * (r[2 * i - 1] + r[2 * i + 1]));
  }

  const LatticeBox& fine_;
  const RightHandSide& rightHandSide_;
  const float* values_;
  glm::ivec3 size_;
  std::vector<float> scratch_, residual_;
};

}  // namespace

void prolongField(const LatticeBox& coarse, const float* from, const LatticeBox& fine,
                  const std::array<JumpRows, 3>& jumps, WorkMeter& meter, float* to) {
  Interpolation(coarse, from, fine, &jumps, meter)
      .run([&](const float* before, const float* after, int j, int k) {
        float* row = fine.row(to, j, k);
        for (int i = 0; i < fine.dims.x; ++i) row[i] = 0.5f * (before[i] + after[i]);
        if (k % 2) jumps[2].addTo(row, fine.row(j, k), 0.5f);
      });
}

void addCorrection(const LatticeBox& coarse, const float* from, const LatticeBox& fine, WorkMeter& meter,
                   float* to) {
  Interpolation(coarse, from, fine, nullptr, meter)
      .run([&](const float* before, const float* after, int j, int k) {
        float* row = fine.row(to, j, k);
        for (int i = 0; i < fine.dims.x; ++i) row[i] += 0.5f * (before[i] + after[i]);
      });
}

void restrictResidual(const LatticeBox& fine, const RightHandSide& rightHandSide, const float* values,
                      const LatticeBox& coarse, WorkMeter& meter, float* residual) {
  const glm::ivec3 shift = fine.low / 2 - coarse.low, size = (fine.dims + 1) / 2;
  std::fill_n(residual, coarse.sampleCount(), 0.0f);
  parallelFor(size_t(size.z), kPairsPerTask, [&](size_t begin, size_t end) {
    ResidualPlanes planes(fine, rightHandSide, values);
    const size_t planeSize = size_t(size.x) * size_t(size.y);
    std::vector<float> before(planeSize), at(planeSize), after(planeSize);
    planes.restrictPlane(int(2 * begin) - 1, before.data());
    for (int k = int(begin); k < int(end); ++k) {
      planes.restrictPlane(2 * k, at.data());
      planes.restrictPlane(2 * k + 1, after.data());
      for (int j = 0; j < size.y; ++j) {
        float* row = coarse.row(residual, j + shift.y, k + shift.z) + shift.x;
        const size_t first = size_t(j) * size_t(size.x);
        // The coarse equations are four times the fine ones, because their cells are twice as wide.
        for (int i = 0; i < size.x; ++i)
          row[i] = 2.0f * at[first + i] + (before[first + i] + after[first + i]);
      }
      before.swap(after);
    }
    meter.add(fine.planeSamples(int(2 * begin), int(2 * end)));
  });
}

}  // namespace raymap::cpu
