#pragma once

#include "surface_tree.h"

namespace raymap {

/// The corners of eight triangles: corner, axis, lane.
struct alignas(64) CornerPacket {
  float v[3][3][kPacket];
};

/// The triangles of a run of the curve. Runs are short enough to be sorted in a thread's own memory.
inline constexpr size_t kRun = size_t{kPacket} * kPacket * kPacket * kPacket;

/// Puts `count` <= kRun triangles into an order in which each aligned power of two of them is compact, from
/// eight on. `centroids` holds x, y and z of each, in any unit; `order` receives their indices.
void sortRun(const float (&centroids)[3][kRun], size_t count, uint16_t* order);

/// Writes a leaf's triangles in frames of their own, and the disc around them into a lane of `discs`.
void writeLeaf(const CornerPacket& corners, TrianglePacket& triangles, uint32_t lane, DiscPacket& discs);

}  // namespace raymap
