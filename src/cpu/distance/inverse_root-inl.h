// A guess of 1 / sqrt(v) in SIMD lanes. Compiled once per instruction set.

#if defined(RAYMAP_INVERSE_ROOT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMAP_INVERSE_ROOT_INL_H
#undef RAYMAP_INVERSE_ROOT_INL_H
#else
#define RAYMAP_INVERSE_ROOT_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns 1 / sqrt(v) with a relative error of at most 2^-11. ARM's own guess has one of 2^-8, which a step
/// of Newton's method squares.
template <class D>
HWY_INLINE hn::Vec<D> guessInverseRoot([[maybe_unused]] D d, hn::Vec<D> v) {
  const hn::Vec<D> guess = hn::ApproximateReciprocalSqrt(v);
#if HWY_ARCH_ARM
  return hn::Mul(guess, hn::NegMulAdd(hn::Mul(hn::Mul(v, hn::Set(d, 0.5f)), guess), guess, hn::Set(d, 1.5f)));
#else
  return guess;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#endif
