#pragma once

#include <raymap/options.h>

#include <functional>
#include <memory>

#include "base/progress.h"
#include "cpu/sign/ray_map.h"
#include "method/winding_rims_lattices.h"

namespace raymap::cpu {

/// Winding number of every sample, by §3.5, Eq. 9-11, or by the harmonic solve. It is +1 inside an
/// outward-oriented closed surface.
class Winding {
 public:
  Winding();
  ~Winding();
  /// Functions that `compute` calls if rays disagree.
  struct Source {
    /// Throws if there are not so many bytes to allocate.
    std::function<void(size_t)> ask;
    /// Returns the rims for a mode that `usesRims`.
    std::function<const RimLattices&(SignMode)> rims;
  };
  /// Computes the winding number, with the passes and offsets of `options`. Returns the share of samples
  /// whose six rays disagree.
  double compute(const RayMap& map, SignMode mode, const FieldOptions& options, const Source& source,
                 Progress& progress, Buffer<float>& winding);
  size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap::cpu
