#pragma once

#include <raymap/mesh.h>

namespace raymap {

/// A globe of our own design, and no easy one: a gyroid labyrinth around a loose gem, a thin toothed disc, a
/// twisted square ring, a fluted column and a drilled base. Closed, or with holes torn into every part.
Mesh makeExampleMesh(bool holes);

}  // namespace raymap
