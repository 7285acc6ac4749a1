#pragma once

namespace raymap {

// Keys of our own metadata in .vdb files.
inline constexpr const char* kVdbDimsKey = "raymap_dims";
inline constexpr const char* kVdbBandKey = "raymap_band";

}  // namespace raymap
