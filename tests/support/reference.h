#pragma once

// The references that the self-test of a GPU uses, too.

#include "mesh/reference.h"  // IWYU pragma: export
