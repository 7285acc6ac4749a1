#pragma once

#include <raymap/field.h>
#include <raymap/options.h>

namespace raymap {

/// Throws `Error(Usage)` for options that make no sense.
void checkOptions(const FieldOptions& options);
/// Does so for a grid, too, and for one with more samples than can be numbered.
void checkOptions(const Grid& grid, const FieldOptions& options);

}  // namespace raymap
