#pragma once

#include <raymap/buffer.h>
#include <raymap/export.h>
#include <raymap/grid.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace raymap {

/// Where the values of a narrow band lie. Leaves hold those of 8 x 8 x 8 samples each. Every other sample is
/// known to lie inside or outside. The memory grows with the surface, so a grid may have more samples than
/// any memory holds.
struct RAYMAP_API NarrowBand {
  static constexpr int kLeafSide = 8;  ///< Samples along the side of a leaf.
  static constexpr size_t kLeafSamples = size_t(kLeafSide) * kLeafSide * kLeafSide;  ///< Samples of a leaf.

  /// A cube of samples without leaves that all lie inside.
  struct Tile {
    glm::ivec3 low{0};  ///< Its first sample, a multiple of its side.
    int32_t side = 0;   ///< Number of samples along its side, 8 times a power of two.
  };

  /// Distances are clamped to these, in the mesh's units; inside may be infinite. Samples whose distance is
  /// smaller are active.
  double outside = 0.0, inside = 0.0;
  /// First sample of each leaf, a multiple of 8. Leaves and tiles are ordered along a Morton curve, x lowest,
  /// and may reach beyond the last samples of the grid.
  Buffer<glm::ivec3> leaves = {};
  std::vector<Tile> tiles = {};  ///< All that lies inside and in no leaf.

  /// Returns the place of a sample's values, if it lies in a leaf.
  std::optional<size_t> find(const glm::ivec3& sample) const;
  bool isActive(float value) const { return value < float(outside) && value > -float(inside); }
};

/// One of a field's arrays.
enum class FieldArray { Distance, Winding, Confidence, Triangle };

/// A sampled signed distance field. Arrays that were not asked for are empty.
///
/// Arrays hold one value per sample, x fastest; see `Grid::index`. Those of a narrow band hold 512 values per
/// leaf instead, x fastest. There, samples that are not active have `kNoTriangle`, and those beyond the grid
/// are far outside.
struct RAYMAP_API Field {
  Grid grid = {};
  Buffer<float> distance = {};     ///< In the mesh's units, negative inside, positive outside.
  Buffer<uint32_t> triangle = {};  ///< Index of the closest triangle, or `kNoTriangle`.
  Buffer<float> winding = {};      ///< Winding number, +1 inside a closed surface that faces outwards.
  Buffer<float> confidence = {};   ///< Confidence in the sign, 0 to 1.
  /// Distances are clamped to +-this, in the mesh's units; 0 = not clamped. `FieldOptions::band` times the
  /// spacing. A narrow band has widths of its own instead.
  double clampDistance = 0.0;
  /// Bounds of the surface that distances lead to, in the mesh's units; empty if they are not known. They
  /// tell what may lie outside the grid; see raymap/sample.h.
  Box surfaceBounds = {};
  std::optional<NarrowBand> narrow = {};  ///< Leaves of a narrow band; none if the arrays hold all samples.

  /// Returns whether the field has an array. A narrow band has distances.
  bool has(FieldArray array) const;
  /// Returns the arrays that the field has, the distance first.
  std::vector<FieldArray> arrays() const;
  /// Returns the distance of a sample. Only the sign of one without a leaf is known: it is `outside`, or
  /// minus `inside`.
  float distanceAt(const glm::ivec3& sample) const;
  /// Returns the magnitude to which distances are clamped, in a narrow band on its narrower side; 0 if they
  /// are not.
  double clamp() const;
  /// Returns the number of samples with values whose distance is not clamped.
  size_t activeCount() const;
  /// Returns the bytes that the field holds.
  size_t bytes() const;
};

/// Value of `Field::triangle` where the distance is clamped, and where surface that closes a hole is closer.
inline constexpr uint32_t kNoTriangle = 0xffffffffu;

}  // namespace raymap
