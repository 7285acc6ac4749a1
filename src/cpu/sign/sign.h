#pragma once

#include "cpu/sign/ray_map.h"

namespace raymap::cpu {

/// Negates the distance where |winding| > threshold, or everywhere else if `invert` (§3.5, end).
void applySign(const Buffer<float>& winding, double threshold, bool invert, Buffer<float>& distance);

/// Returns the margin of a winding number w. It grows with the distance of |w| from the threshold, and is 1
/// at |w| = 0 and from |w| = 1 on.
float marginOf(float winding, float threshold);

/// Computes the confidence m (1 + a) / 2 of each sample's sign, 0 to 1: m is the margin, and the agreement a
/// the share of the six rays that alone give the same sign.
void computeConfidence(const RayMap& map, const Buffer<float>& winding, double threshold,
                       Buffer<float>& confidence);

}  // namespace raymap::cpu
