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
  /// Replaces the winding numbers of these samples of a grid, with ever closer looks as long as the number is
  /// close to the threshold. The tree is in cell units. Returns the samples that remain too close.
  std::vector<uint32_t> settle(const SurfaceTree& tree, const glm::ivec3& dims,
                               std::span<const uint32_t> samples, double threshold, Looks looks,
                               Progress& progress, Buffer<float>& winding);

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
