#pragma once

#include "cpu/sign/ray_map.h"

namespace raymap::cpu {

/// §3.5, end: negates the distance where |winding| > threshold, or everywhere else if `invert`.
void applySign(const Buffer<float>& winding, double threshold, bool invert, Buffer<float>& distance);

/// How sure the sign of each sample is, 0 to 1: m (1 + a) / 2. m says how far |w| lies from the threshold, 1
/// at 0 and from 1 on; a is the share of the six rays that, each for itself, give the same sign.
void computeConfidence(const RayMap& map, const Buffer<float>& winding, double threshold,
                       Buffer<float>& confidence);

}  // namespace raymap::cpu
