#pragma once

#include <raymap/generate.h>

#include "progress.h"
#include "ray_map.h"

namespace raymap {

/// What the winding stage found out on its way.
struct WindingSummary {
  double doubtfulShare = 0.0;  ///< Samples whose six rays disagree.
};

/// §3.5, Eq. 9-11, and the harmonic solve: the winding number of every sample, +1 inside an outward-oriented
/// closed surface.
class Winding {
 public:
  Winding();
  ~Winding();
  WindingSummary compute(const RayMap& map, const Options& options, Progress& progress,
                         Buffer<float>& winding);
  size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap
