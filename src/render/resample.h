#pragma once

#include <raymap/field.h>

namespace raymap {

/// Returns the finest grid over the same box that has at most `most` samples along a side.
Grid coarserGrid(const Grid& grid, int most);

/// Returns a field's distances at the samples of another grid, and its winding numbers and confidences if it
/// has them: trilinear within its box. Outside, distances are bounds (raymap/sample.h), and other numbers
/// those of the closest point of the box.
Field resampled(const Field& field, const Grid& grid);

}  // namespace raymap
