#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/patches.h"

namespace raymap {

/// Returns the part of each patch: the lowest patch of a set in which every patch has a vertex near a vertex
/// of another one. Vertices are near if they differ by less than `distance` along every axis; vertices that
/// differ by more than three times as much along any axis are not. Only the vertices of `faces` are looked
/// at.
std::vector<uint32_t> findParts(const PackedMesh& mesh, std::span<const uint32_t> faces,
                                const Patches& patches, double distance);

}  // namespace raymap
