#pragma once

#include <cstddef>

namespace raymap {

/// Bytes that this process can still get without swapping: the least of what the system has left and the
/// limit of its control group; SIZE_MAX if neither is known.
size_t availableMemory();

}  // namespace raymap
