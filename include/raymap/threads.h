#pragma once

#include <raymap/export.h>

namespace raymap {

/// Sets how many CPU threads all calls use whose options leave the number at 0, in this process; 0 = all. For
/// one process of many, such as a worker of a data loader. Throws `Error(Usage)` if it is negative.
RAYMAP_API void setDefaultThreads(int threads);

/// Returns that number: the one set last, else the environment variable RAYMAP_THREADS, else 0. Throws
/// `Error(Usage)` if the variable holds something else than a number.
RAYMAP_API int defaultThreads();

}  // namespace raymap
