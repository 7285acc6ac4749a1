#pragma once

#include "content.h"

namespace raymap::view {

/// Prepares two shapes to be compared. Both get the bounds of both, and so meshes the same grid; the field of
/// a mesh gets the grid of a field beside it. If two fields have different grids, the second one is sampled
/// on that of the first. Narrow bands become dense.
void makeComparable(Content& first, Content& second);

}  // namespace raymap::view
