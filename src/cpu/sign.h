#pragma once

#include "ray_map.h"

namespace raymap {

/// §3.5, end: negates the distance where |winding| > threshold, or everywhere else if `invert`.
void applySign(const Buffer<float>& winding, double threshold, bool invert, Buffer<float>& distance);

/// How sure the sign of each sample is, 0 to 1: how far |winding| lies from the threshold, and whether the
/// six rays agreed.
void computeConfidence(const RayMap& map, const Buffer<float>& winding, double threshold,
                       Buffer<float>& confidence);

}  // namespace raymap
