#pragma once

#include <raymap/buffer.h>
#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/grid.h>
#include <raymap/machine.h>
#include <raymap/region.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace raymap {

/// How wide a narrow band is, and which arrays it has besides the distance.
struct BandOptions {
  double outside = 3.0;     ///< Width of the band outside of the surface, in samples.
  double inside = 3.0;      ///< Width of the band inside, in samples; infinite for the whole interior.
  bool triangle = false;    ///< Whether to compute closest triangles.
  bool winding = false;     ///< Whether to compute winding numbers. Needs a sign.
  bool confidence = false;  ///< Whether to compute the confidence in the sign. Needs a sign.
};

/// A signed distance field near a surface alone: a narrow band. Leaves hold the values of 8 x 8 x 8 samples
/// each. Every other sample is known to lie inside or outside. The memory grows with the surface, so a
/// lattice may have more samples than any memory holds.
struct RAYMAP_API SparseField {
  static constexpr int kLeafSide = 8;  ///< Samples along the side of a leaf.
  static constexpr size_t kLeafSamples = size_t(kLeafSide) * kLeafSide * kLeafSide;  ///< Samples of a leaf.

  /// A cube of samples without leaves that all lie inside.
  struct Tile {
    glm::ivec3 low{0};  ///< Its first sample, a multiple of its side.
    int32_t side = 0;   ///< Number of samples along its side, 8 times a power of two.
  };

  Grid grid = {};  ///< The lattice. Leaves and tiles may reach beyond its last samples.
  /// Distances are clamped to these, in the mesh's units; inside may be infinite. Samples whose distance is
  /// smaller are active.
  double outside = 0.0, inside = 0.0;
  /// First sample of each leaf, a multiple of 8. Leaves and tiles are ordered along a Morton curve, x lowest.
  Buffer<glm::ivec3> leaves = {};
  // 512 values per leaf, x fastest. Arrays that were not asked for are empty.
  /// In the mesh's units, negative inside, positive outside. Samples beyond the lattice are far outside.
  Buffer<float> distance = {};
  Buffer<uint32_t> triangle = {};  ///< Index of the closest triangle; `kNoTriangle` where not active.
  Buffer<float> winding = {};     ///< Winding number, +1 inside a closed surface that faces outwards; else 0.
  Buffer<float> confidence = {};  ///< Confidence in the sign, 0 to 1.
  std::vector<Tile> tiles = {};   ///< All that lies inside and in no leaf.

  /// Bounds of the surface, in the mesh's units; empty if they are not known.
  Box surfaceBounds = {};

  /// Returns the place of a sample's values, if it lies in a leaf.
  std::optional<size_t> find(const glm::ivec3& sample) const;
  /// Returns the distance of a sample, of which without a leaf only the sign is known: `outside`, or minus
  /// `inside`.
  float distanceAt(const glm::ivec3& sample) const;
  bool isActive(float value) const { return value < float(outside) && value > -float(inside); }
  /// Returns the number of active samples.
  size_t activeCount() const;
  /// Returns the bytes that the field holds.
  size_t bytes() const;
};

/// A narrow band, and the name of its grid in a file.
struct NamedBand {
  std::string_view name;
  const SparseField* band = nullptr;
};

/// Throws `Error(Usage)` unless the grid and the widths make sense, each array that is not empty has 512
/// values per leaf, and leaves and tiles lie on the lattice, in their order. Fields from this library are
/// valid.
RAYMAP_API void validate(const SparseField& band);

/// Returns the field of all samples. Distances are those of `SparseField::distanceAt`. `clampDistance` is the
/// smaller of both widths: on the wider side, distances beyond it are kept, and are right. Samples in no leaf
/// have `kNoTriangle` and NaN for winding number and confidence. `machine.threads` and `memoryLimit` are
/// used. Throws `Error`: Usage if the band is not valid, Memory if the field does not fit.
RAYMAP_API Field toDense(const SparseField& band, const MachineOptions& machine = {});
/// Returns the field of a box of samples. Throws `Error(Usage)`, too, if it does not lie on the lattice.
RAYMAP_API Field toDense(const SparseField& band, const Region& region, const MachineOptions& machine = {});

/// Returns the samples of a field near its surface. Leaves are those cubes of 8 x 8 x 8 samples that have an
/// active sample, or samples of both sides. Distances are clamped to the band. `machine.threads` and
/// `memoryLimit` are used. Throws `Error`: Usage for a band that makes no sense or is wider than the field's
/// `clampDistance`, and for arrays that the field lacks; Input if a distance is NaN; Memory.
RAYMAP_API SparseField toSparse(const Field& field, const BandOptions& options = {},
                                const MachineOptions& machine = {});

}  // namespace raymap
