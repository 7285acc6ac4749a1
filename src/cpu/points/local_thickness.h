#pragma once

#include <raymap/local_thickness.h>

#include "base/progress.h"
#include "cpu/points/point_query.h"

namespace raymap::cpu {

/// Measures the thickness of a surface with a sign at points of its faces, as far as `most`, with all threads
/// of the caller's arena.
void measureThickness(const PreparedSurface& surface, std::span<const FacePoint> points, double most,
                      Progress& progress, std::span<Thickness> thickness);

}  // namespace raymap::cpu
