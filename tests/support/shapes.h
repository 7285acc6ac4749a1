#pragma once

// The meshes that the self-test of a GPU makes, too.

#include "mesh/shapes.h"  // IWYU pragma: export
