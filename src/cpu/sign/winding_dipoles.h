#pragma once

#include <functional>

#include "base/progress.h"
#include "cpu/distance/surface_tree.h"
#include "method/winding_dipoles_shared.h"

namespace raymap::cpu {

/// Function that returns the tree of the triangles in cell units: sample (i, j, k) lies at (i, j, k).
using SurfaceSource = std::function<const SurfaceTree&()>;

/// Winding numbers of the triangles themselves, by a tree of dipoles: Barill et al. 2018, "Fast winding
/// numbers for soups and clouds". The lattice only samples the triangles by its crossings.
class WindingDipoles {
 public:
  /// Looks from `first` up to `end`, of those in `winding_dipoles_shared.h`.
  struct Looks {
    uint32_t first, end;
  };
  /// Replaces every winding number so close to the threshold that the lattice may have put it on the wrong
  /// side. `distance` is the unsigned distance in cells.
  void settle(const SurfaceSource& surface, const glm::ivec3& dims, const Buffer<float>& distance,
              double threshold, Looks looks, Progress& progress, Buffer<float>& winding);

  /// Returns the winding numbers at points in cell units.
  std::vector<float> numbersAt(const SurfaceSource& surface, std::span<const glm::vec3> points,
                               Progress& progress);

  /// Builds the moments of a tree, for `settleAt`.
  void prepare(const SurfaceTree& tree);
  /// Computes the winding numbers at points in cell units, with ever closer looks as long as the number is
  /// close to the threshold. Needs `prepare` with the same tree.
  void settleAt(const SurfaceTree& tree, std::span<const glm::vec3> points, double threshold, Looks looks,
                std::span<float> winding) const;

  /// Returns whether the moments of a tree are built.
  bool isPrepared() const { return !moments_.empty(); }
  void clear() { moments_.resizeUninitialized(0); }

  size_t bytes() const { return moments_.capacityBytes(); }

  /// Moments of eight nodes about their discs' centres. They give the solid angle that a distant point sees.
  struct alignas(64) Moments {
    float nx[kPacket], ny[kPacket], nz[kPacket];  ///< Area vector.
    /// Symmetric part of the area vector times the offset from the centre.
    float xx[kPacket], yy[kPacket], zz[kPacket], xy[kPacket], yz[kPacket], zx[kPacket];
  };

 private:
  Buffer<Moments> moments_;  // by packet of nodes
};

}  // namespace raymap::cpu
