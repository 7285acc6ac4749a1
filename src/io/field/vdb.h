#pragma once

namespace raymap {

// Keys of our own metadata in .vdb and .nvdb files.
inline constexpr const char* kVdbArrayKey = "raymap_array";  ///< Array that a grid holds; else its name.
inline constexpr const char* kVdbFieldKey = "raymap_field";  ///< Field of a grid, in a file of several.
inline constexpr const char* kVdbDimsKey = "raymap_dims";
inline constexpr const char* kVdbClampKey = "raymap_clamp_distance";
inline constexpr const char* kVdbFormerClampKey = "raymap_band";  ///< In files of before.
// Widths of a narrow band, which the grid's values hold in single precision.
inline constexpr const char* kVdbOutsideKey = "raymap_outside";
inline constexpr const char* kVdbInsideKey = "raymap_inside";
/// Magnitudes of the distances that are stored as the background, outside and inside, where these differ from
/// it: the background is never below the width of the band, nor equal to an active value.
inline constexpr const char* kVdbClampedKey = "raymap_clamped";
inline constexpr const char* kVdbLowKey = "raymap_low";  ///< Index of the first sample; without it 0, 0, 0.
inline constexpr const char* kVdbSurfaceMinKey = "raymap_surface_min";
inline constexpr const char* kVdbSurfaceMaxKey = "raymap_surface_max";
inline constexpr const char* kVdbBackgroundKey =
    "raymap_background";  ///< Meaning of the background, in words.

}  // namespace raymap
