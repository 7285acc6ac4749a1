#pragma once

#include <optional>

#include "cpu/backend.h"

namespace raymap::cpu {

/// Runs the pipeline on the CPU. A copy of the caller's mesh holds `meshBytes` bytes; 0 if there is none.
/// `frames` is as for `Backend::take`. Throws `Error(Memory)` if the run may need more than the options
/// allow.
Stats runOnCpu(Backend& backend, const Job& job, size_t meshBytes, std::optional<Frames> frames = {});

}  // namespace raymap::cpu
