#pragma once

#include <raymap/buffer.h>
#include <raymap/grid.h>

#include <cstdint>

namespace raymap {

/// A sampled signed distance field and what else was asked for; arrays are indexed by `Grid::index`.
struct Field {
  Grid grid;
  Buffer<float> distance;     ///< In the mesh's units, negative inside, positive outside.
  Buffer<uint32_t> triangle;  ///< Closest triangle of each sample, or empty. kNoTriangle beyond a band, and
                              ///< where surface that closes a hole is closer.
  Buffer<float> winding;      ///< Winding number, +1 inside an outward-oriented closed surface, or empty.
  Buffer<float> confidence;   ///< How sure the sign is, 0 to 1, or empty.
  double band = 0.0;          ///< Distances are clamped to +-band (mesh units); 0 = not clamped.
};

inline constexpr uint32_t kNoTriangle = 0xffffffffu;

}  // namespace raymap
