#pragma once

#include "cpu/backend.h"

namespace raymap::cpu {

/// Runs the pipeline on the CPU. A copy of the caller's mesh holds `meshBytes` bytes; 0 if there is none.
/// Throws `Error(Memory)` if the run may need more than the options allow.
Stats runOnCpu(Backend& backend, const Job& job, size_t meshBytes);

}  // namespace raymap::cpu
