#pragma once

#include <raymap/diagnostics.h>

#include "bindings.h"

namespace raymap::python {

/// Returns what `raymap info --json` prints but the verdict, and all holes.
nb::dict describe(const Diagnostics& found, const SelfIntersections& crossings);

}  // namespace raymap::python
