#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace raymap {

// The bitstreams of EXT_meshopt_compression and KHR_meshopt_compression. Each function fills `out` and
// returns true, or returns false if the bytes of `in` make no such data.

/// Decodes `out.size() / stride` elements of `stride` bytes: a multiple of 4, up to 256.
bool decodeMeshoptAttributes(std::span<const std::byte> in, std::span<std::byte> out, size_t stride);
/// Decodes the corners of triangles, indices of `stride` bytes: 2 or 4.
bool decodeMeshoptTriangles(std::span<const std::byte> in, std::span<std::byte> out, size_t stride);
/// Decodes any sequence of indices of `stride` bytes: 2 or 4.
bool decodeMeshoptIndices(std::span<const std::byte> in, std::span<std::byte> out, size_t stride);

/// Undoes a filter in place. Returns false if there is no such filter for elements of `stride` bytes.
bool undoMeshoptFilter(std::string_view filter, std::span<std::byte> data, size_t stride);

}  // namespace raymap
