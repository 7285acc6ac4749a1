#pragma once

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// The corners of eight triangles: corner, axis, lane.
struct alignas(64) CornerPacket {
  float v[3][3][kPacket];
};

/// Where a triangle lies: x, y and z of its centroid in 16 bits each, from the highest on, and an index in
/// the lowest.
using Place = uint64_t;

/// The triangles of a run of the curve: so many as an index of 16 bits and the cache of a core take.
inline constexpr size_t kRun = size_t{kPacket} * kPacket * kPacket * kPacket;

/// Puts `count` <= kRun places into an order in which each aligned power of two of them is compact, from
/// eight on.
void sortRun(Place* places, size_t count);

/// Writes a leaf's triangles in frames of their own, and the disc around them into a lane of `discs`.
void writeLeaf(const CornerPacket& corners, TrianglePacket& triangles, uint32_t lane, DiscPacket& discs);

}  // namespace raymap::cpu
