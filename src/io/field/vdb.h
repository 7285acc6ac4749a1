#pragma once

namespace raymap {

// What our .vdb files say of the field besides OpenVDB's own metadata.
inline constexpr const char* kVdbDimsKey = "raymap_dims";
inline constexpr const char* kVdbBandKey = "raymap_band";

}  // namespace raymap
