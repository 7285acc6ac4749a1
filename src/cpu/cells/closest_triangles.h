#pragma once

#include <array>
#include <span>

#include "method/cell_mesh.h"

namespace raymap::cpu {

/// Some points and the closest triangle of each so far.
struct PointBatch {
  static constexpr size_t kCapacity = 512;

  size_t count = 0;
  alignas(64) std::array<float, kCapacity> x;
  alignas(64) std::array<float, kCapacity> y;
  alignas(64) std::array<float, kCapacity> z;
  alignas(64) std::array<float, kCapacity> squared;
  alignas(64) std::array<uint32_t, kCapacity> triangle;

  /// What lies beyond `count` in the last vector is measured too, and must be a number.
  PointBatch() {
    x.fill(0.0f);
    y.fill(0.0f);
    z.fill(0.0f);
  }
};

/// Replaces the batch's triangles wherever one of `triangles` is closer. As `triangleSquaredDistance`, for
/// all points at once.
void findClosestTriangles(const CellMesh& mesh, std::span<const uint32_t> triangles, PointBatch& batch);

}  // namespace raymap::cpu
