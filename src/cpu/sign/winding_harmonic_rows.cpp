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
  if (lanes >= 2) {
    // Changes every second lane; the others keep their value.
    const hn::RebindToSigned<decltype(d)> di;
    const auto chosen = hn::MaskFromVec(
        hn::BitCast(d, hn::VecFromMask(di, hn::Eq(hn::And(hn::Iota(di, 0), hn::Set(di, 1)), hn::Zero(di)))));
    for (; i + lanes + 1 <= count; i += lanes) {
      const auto alongX = hn::Add(hn::LoadU(d, row + i - 1), hn::LoadU(d, row + i + 1));
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {
HWY_EXPORT(relaxRow);

void relaxRow(const RowStencil& around, size_t first, size_t count, float* row) {
  HWY_DYNAMIC_DISPATCH(relaxRow)(around, first, count, row);
}
}  // namespace raymap::cpu
#endif
