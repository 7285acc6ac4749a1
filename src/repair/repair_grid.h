#pragma once

#include <raymap/mesh.h>

namespace raymap {

/// Returns about how many samples a grid has along each side that covers a box by default.
glm::dvec3 samplesFor(const Box& box, double voxelSize);

}  // namespace raymap
