#pragma once

#include <raymap/mesh.h>

namespace raymap {

/// Returns a demanding globe: a gyroid labyrinth around a loose gem, a thin toothed disc, a twisted square
/// ring, a fluted column and a drilled base. It is closed, or has holes torn into every part. A
/// fine one has 1.6 million triangles instead of 95,000.
Mesh makeExampleMesh(bool holes, bool isFine = false);

}  // namespace raymap
