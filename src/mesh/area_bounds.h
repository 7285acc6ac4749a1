#pragma once

#include <raymap/mesh_view.h>

namespace raymap {

/// Returns the bounds of all faces that have an area, as `bounds` rounds them; empty if none has.
Box areaBounds(const MeshView& mesh);

}  // namespace raymap
