#pragma once

#include <raymap/field.h>

namespace raymap {

/// Throws `Error`: Usage unless a field has its distances and a surface at `iso`, Input if a sample is not
/// finite.
void checkValues(const Field& field, double iso);

/// Returns whether a sample on the sides of the grid is inside.
bool reachesBox(const Field& field, double iso);

}  // namespace raymap
