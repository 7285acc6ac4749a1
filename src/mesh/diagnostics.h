#pragma once

#include <raymap/diagnostics.h>

#include <cstdint>
#include <vector>

#include "mesh/components.h"
#include "mesh/model.h"

namespace raymap {

/// Do what the public functions of these names do, for a mesh that is valid and that others read, too.
Diagnostics diagnose(const Model& mesh, const DiagnoseOptions& options = {},
                     const MachineOptions& machine = {});
Arrangement arrangeParts(const Model& mesh, const Diagnostics& found, const SelfIntersections& crossings,
                         const MachineOptions& machine = {});
SheetFaces findSheets(const Model& mesh);

}  // namespace raymap
