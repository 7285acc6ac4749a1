#pragma once

#include <array>
#include <span>

#include "method/cell_mesh.h"

namespace raymap::cpu {

/// Points, and the closest triangle of each so far.
struct PointBatch {
  static constexpr size_t kCapacity = 512;

  size_t count = 0;
  alignas(64) std::array<float, kCapacity> x;
  alignas(64) std::array<float, kCapacity> y;
  alignas(64) std::array<float, kCapacity> z;
  alignas(64) std::array<float, kCapacity> squared;
  alignas(64) std::array<uint32_t, kCapacity> triangle;

  /// Sets all coordinates to 0: those beyond `count` in the last vector are used too, and must be numbers.
  PointBatch() {
    x.fill(0.0f);
    y.fill(0.0f);
    z.fill(0.0f);
  }
};

/// Replaces a point's closest triangle if one of `triangles` is closer. Measures like
/// `triangleSquaredDistance`, from all points at once.
void findClosestTriangles(const CellMesh& mesh, std::span<const uint32_t> triangles, PointBatch& batch);

}  // namespace raymap::cpu
