#pragma once

#include <raymap/buffer.h>

namespace raymap::cpu {

/// Clamps distances in cell units to the band, if it is above zero, and scales them to the mesh's units.
void finishDistance(double band, double spacing, Buffer<float>& distance);

}  // namespace raymap::cpu
