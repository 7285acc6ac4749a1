// Inner loop of the harmonic winding number, compiled for every instruction set.

#include "cpu/sign/winding_harmonic_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/sign/winding_harmonic_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

void relaxRow(const RowStencil& around, size_t first, size_t count, float* row) {
  const hn::ScalableTag<float> d;
  const size_t lanes = hn::Lanes(d);
  const auto sixth = hn::Set(d, 1.0f / 6.0f);
  size_t i = first;
  if (lanes >= 2 && i + lanes + 1 <= count) {
    // Changes every second lane; the others keep their value.
    const hn::RebindToSigned<decltype(d)> di;
    const auto chosen = hn::MaskFromVec(
        hn::BitCast(d, hn::VecFromMask(di, hn::Eq(hn::And(hn::Iota(di, 0), hn::Set(di, 1)), hn::Zero(di)))));
    // The next samples are loaded before these are stored: a load that overlaps a store in part has to wait.
    auto before = hn::LoadU(d, row + i - 1);
    for (; i + lanes + 1 <= count; i += lanes) {
      const auto alongX = hn::Add(before, hn::LoadU(d, row + i + 1));
      if (i + 2 * lanes + 1 <= count) before = hn::LoadU(d, row + i + lanes - 1);
      const auto alongY = hn::Add(hn::LoadU(d, around.jBefore + i), hn::LoadU(d, around.jAfter + i));
      const auto alongZ = hn::Add(hn::LoadU(d, around.kBefore + i), hn::LoadU(d, around.kAfter + i));
      const auto sum =
          hn::Add(hn::Add(alongX, alongY), hn::Add(alongZ, hn::LoadU(d, around.rightHandSide + i)));
      hn::StoreU(hn::IfThenElse(chosen, hn::Mul(sum, sixth), hn::LoadU(d, row + i)), d, row + i);
    }
  }
  for (; i + 1 < count; i += 2) {
    const float alongX = row[i - 1] + row[i + 1];
    const float alongY = around.jBefore[i] + around.jAfter[i];
    const float alongZ = around.kBefore[i] + around.kAfter[i];
    row[i] = ((alongX + alongY) + (alongZ + around.rightHandSide[i])) * (1.0f / 6.0f);
  }
}

void residualRow(const RowStencil& around, size_t count, const float* row, float* residual) {
  const auto between = [&](auto d, size_t i) {
    const auto alongX = hn::Add(hn::LoadU(d, row + i - 1), hn::LoadU(d, row + i + 1));
    const auto alongY = hn::Add(hn::LoadU(d, around.jBefore + i), hn::LoadU(d, around.jAfter + i));
    const auto alongZ = hn::Add(hn::LoadU(d, around.kBefore + i), hn::LoadU(d, around.kAfter + i));
    const auto sum =
        hn::Add(hn::Add(alongX, alongY), hn::Add(alongZ, hn::LoadU(d, around.rightHandSide + i)));
    hn::StoreU(hn::Sub(sum, hn::Mul(hn::Set(d, 6.0f), hn::LoadU(d, row + i))), d, residual + i);
  };
  const hn::ScalableTag<float> d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 1;
  for (; i + lanes + 1 <= count; i += lanes) between(d, i);
  for (; i + 1 < count; ++i) between(hn::CappedTag<float, 1>(), i);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {
HWY_EXPORT(relaxRow);
HWY_EXPORT(residualRow);

void relaxRow(const RowStencil& around, size_t first, size_t count, float* row) {
  HWY_DYNAMIC_DISPATCH(relaxRow)(around, first, count, row);
}
void residualRow(const RowStencil& around, size_t count, const float* row, float* residual) {
  HWY_DYNAMIC_DISPATCH(residualRow)(around, count, row, residual);
}
}  // namespace raymap::cpu
#endif
