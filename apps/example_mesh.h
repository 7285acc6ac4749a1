#pragma once

#include <raymap/mesh.h>

namespace raymap {

/// Returns a demanding globe: a gyroid labyrinth around a loose gem, a thin toothed disc, a twisted square
/// ring, a fluted column and a drilled base. It is closed, or has holes torn into every part.
Mesh makeExampleMesh(bool holes);

}  // namespace raymap
