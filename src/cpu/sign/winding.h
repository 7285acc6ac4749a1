#pragma once

#include <raymap/generate.h>

#include "base/progress.h"
#include "cpu/sign/ray_map.h"

namespace raymap::cpu {

/// §3.5, Eq. 9-11, and the harmonic solve: the winding number of every sample, +1 inside an outward-oriented
/// closed surface.
class Winding {
 public:
  Winding();
  ~Winding();
  /// Returns the share of samples whose six rays disagree. The options say how many passes and which offsets.
  double compute(const RayMap& map, SignMode mode, const Options& options, Progress& progress,
                 Buffer<float>& winding);
  size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap::cpu
