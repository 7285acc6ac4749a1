#pragma once

#include <raymap/field.h>
#include <raymap/options.h>

namespace raymap {

// Makes a solid around an open surface from the unsigned distance.

/// Returns the options of the run that `thicken` needs: no sign, and a band that holds the whole wall.
Options withoutThickness(const Options& options, const Grid& grid);

/// Converts the unsigned distance to the distance to the solid of `options.thickness`, in mesh units. Applies
/// `band` and `invert`.
void thicken(const Options& options, Field& field);

}  // namespace raymap
