#pragma once

#include <raymap/options.h>

#include "base/progress.h"

namespace raymap {

/// Appends the stages that have ended, with their times.
inline void addStages(const Progress& progress, Stats& stats) {
  for (const Progress::Time& time : progress.times()) stats.stages.push_back({time.stage, time.milliseconds});
}

}  // namespace raymap
