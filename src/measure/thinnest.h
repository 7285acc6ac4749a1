#pragma once

#include <raymap/mesh_thickness.h>

namespace raymap {

/// Adds the thickness of a mesh's thinnest part to the verdict on it, as `judge` does.
void addThinnest(const MeshView& mesh, const Diagnostics& found, const MachineOptions& machine,
                 Verdict& verdict);

}  // namespace raymap
