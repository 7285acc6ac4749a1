#pragma once

#include <raymap/field.h>
#include <raymap/options.h>

namespace raymap {

/// Throws `Error(Usage)` for a grid or options that make no sense.
void checkOptions(const Grid& grid, const FieldOptions& options);

}  // namespace raymap
