#pragma once

#include <functional>

#include "base/progress.h"
#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Gives the triangles in cell units, where sample (i, j, k) lies at (i, j, k).
using SurfaceSource = std::function<const SurfaceTree&()>;

/// Winding numbers of the triangles themselves, by a tree of dipoles: Barill et al. 2018, "Fast winding
/// numbers for soups and clouds". What the lattice only samples by its crossings, these see.
class WindingDipoles {
 public:
  /// Replaces every winding number so close to the threshold that the lattice may have put it on the wrong
  /// side. `distance` is the unsigned one, in cells.
  void settle(const SurfaceSource& surface, const glm::ivec3& dims, const Buffer<float>& distance,
              double threshold, Progress& progress, Buffer<float>& winding);

  /// The winding numbers at some points.
  std::vector<float> numbersAt(const SurfaceSource& surface, std::span<const glm::vec3> points,
                               Progress& progress);

  size_t bytes() const { return moments_.capacityBytes(); }

  /// The moments of eight nodes: the solid angle that a distant point sees, about the centres of their discs.
  struct alignas(64) Moments {
    float nx[kPacket], ny[kPacket], nz[kPacket];  ///< Area vector.
    /// Area vector times offset from the centre, the symmetric part.
    float xx[kPacket], yy[kPacket], zz[kPacket], xy[kPacket], yz[kPacket], zx[kPacket];
  };

 private:
  const SurfaceTree& prepare(const SurfaceSource& surface);

  Buffer<Moments> moments_;  // by packet of nodes
};

}  // namespace raymap::cpu
