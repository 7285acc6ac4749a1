#pragma once

#include <raymap/generate.h>

namespace raymap {

// A solid around an open surface, made of the unsigned distance.

/// What to run instead: no sign, and a band that holds the whole wall.
Options withoutThickness(const Options& options, const Grid& grid);

/// Turns the unsigned distance into that to the solid of `options.thickness`, and applies `band` and
/// `invert`.
void thicken(const Options& options, Field& field);

}  // namespace raymap
