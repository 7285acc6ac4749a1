#pragma once

#include <raymap/options.h>

#include "base/parallel.h"
#include "base/progress.h"
#include "cpu/sign/ray_map.h"

namespace raymap::cpu {

/// Winding number of every sample, by §3.5, Eq. 9-11, or by the harmonic solve. It is +1 inside an
/// outward-oriented closed surface.
class Winding {
 public:
  Winding();
  ~Winding();
  /// Computes the winding number, with the passes and offsets of `options`. If rays disagree, first calls
  /// `ask` with the bytes to allocate, which throws if there are not so many. Returns the share of samples
  /// whose six rays disagree.
  double compute(const RayMap& map, SignMode mode, const FieldOptions& options, FunctionView<size_t> ask,
                 Progress& progress, Buffer<float>& winding);
  size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap::cpu
