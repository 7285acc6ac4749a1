#pragma once

#include <raymap/field.h>

#include "base/progress.h"
#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Computes the distance of every sample to its closest triangle, in cell units, and that triangle's index.
/// With a `band` above zero, farther samples get exactly `band` and `kNoTriangle`. `triangle` may be null.
void computeExactDistance(const SurfaceTree& tree, const glm::ivec3& dims, double band, Progress& progress,
                          Buffer<float>& distance, Buffer<uint32_t>* triangle);

/// Adds further triangles to a result. Samples that are closer to them than `distance` get the new distance
/// and `kNoTriangle`. The cost is small if there are few such samples.
void addExactDistance(const SurfaceTree& tree, const glm::ivec3& dims, Progress& progress,
                      Buffer<float>& distance, Buffer<uint32_t>* triangle);

}  // namespace raymap::cpu
