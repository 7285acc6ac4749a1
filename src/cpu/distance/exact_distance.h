#pragma once

#include <raymap/field.h>

#include "base/progress.h"
#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// The distance, in cell units, of every sample to its closest triangle, and that triangle. With a `band`
/// above zero, samples farther than that get exactly `band` and `kNoTriangle`. `triangle` may be null.
void computeExactDistance(const SurfaceTree& tree, const glm::ivec3& dims, double band, Progress& progress,
                          Buffer<float>& distance, Buffer<uint32_t>* triangle);

/// The same for further triangles: samples that are closer to them than `distance` says get their distance,
/// and `kNoTriangle`. Costs little where few are.
void addExactDistance(const SurfaceTree& tree, const glm::ivec3& dims, Progress& progress,
                      Buffer<float>& distance, Buffer<uint32_t>* triangle);

}  // namespace raymap::cpu
