#pragma once

#include <raymap/field.h>
#include <raymap/options.h>

namespace raymap {

// The field of a mesh without triangles, whose samples are all outside.

/// Returns the distance of every sample: the band, or without one the largest float.
float farDistance(const FieldOptions& options, double spacing);

/// Fills the field.
void fillFar(const Grid& grid, const FieldOptions& options, Field& field);

}  // namespace raymap
