#pragma once

#include <raymap/generate.h>

#include "progress.h"
#include "ray_map.h"
#include "winding_dipoles.h"

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
  /// Where the harmonic mode comes close to the threshold it asks for the surface, and looks at the distance
  /// to it, in cells.
  WindingSummary compute(const RayMap& map, const SurfaceSource& surface, const Buffer<float>& distance,
                         const Options& options, Progress& progress, Buffer<float>& winding);
  /// The winding numbers of the triangles themselves at some points, whatever the mode.
  std::vector<float> numbersAt(const SurfaceSource& surface, std::span<const glm::vec3> points,
                               Progress& progress);
  size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap
