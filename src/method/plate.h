#pragma once

#include <raymap/field.h>
#include <raymap/options.h>

namespace raymap {

// Makes a solid around an open surface from the unsigned distance.

/// Returns the options of the run that `thicken` needs: no sign, and a band that holds the whole wall.
FieldOptions withoutThickness(const FieldOptions& options, const Grid& grid);

/// Converts the unsigned distance to the distance to the solid of `options.thickness`, in mesh units. Applies
/// `band` and `invert`, on so many threads.
void thicken(const FieldOptions& options, int threads, Field& field);

}  // namespace raymap
