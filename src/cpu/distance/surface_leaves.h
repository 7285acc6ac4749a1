#pragma once

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Corners of eight triangles, by corner, axis and lane.
struct alignas(64) CornerPacket {
  float v[3][3][kPacket];
};

/// Position of a triangle: x, y and z of its centroid in 16 bits each, from the highest on. The lowest 16
/// bits are an index.
using Place = uint64_t;

/// Number of triangles in a run of the curve: few enough for an index of 16 bits and for the cache of a core.
inline constexpr size_t kRun = size_t{kPacket} * kPacket * kPacket * kPacket;

/// Sorts `count` <= kRun places so that each aligned power of two of them, from eight on, is compact.
void sortRun(Place* places, size_t count);

/// Writes a leaf's triangles in their own frames, but not their indices.
void makeFrames(const CornerPacket& corners, TrianglePacket& triangles);

/// Writes the disc around a leaf's triangles to a lane of `discs`.
void boundLeaf(const CornerPacket& corners, uint32_t lane, DiscPacket& discs);

}  // namespace raymap::cpu
