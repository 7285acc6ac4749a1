#pragma once

#include <raymap/field.h>
#include <raymap/machine.h>

namespace raymap {

/// Returns a field's distances at the samples of another grid, and its winding numbers and confidences if it
/// has them: trilinear within its box. Outside, distances are bounds (raymap/sample.h), and other numbers
/// those of the closest point of the box. Of a narrow band, returns the distances to its surface; see
/// raymap/page.h.
Field resampled(const Field& field, const Grid& grid, const MachineOptions& machine);

}  // namespace raymap
