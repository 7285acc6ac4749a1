#pragma once

// The structs of raymap/c.h that grow in later versions.

#include <raymap/c.h>

#include <cstddef>

#include "c_api/c_handles.h"

namespace raymap::c {

/// Name of such a struct, and its size in its first version. A new member goes to the end; the size stays.
template <class Struct>
struct FirstVersion;

// Without padding at the end, in which callers of the first version cannot be told from those of the next.
#define RAYMAP_FIRST_VERSION(Struct, lastMember)                                               \
  template <>                                                                                  \
  struct FirstVersion<Struct> {                                                                \
    static constexpr const char* kName = #Struct;                                              \
    static constexpr size_t kSize = offsetof(Struct, lastMember) + sizeof(Struct::lastMember); \
    static_assert(offsetof(Struct, size) == 0 && kSize % alignof(Struct) == 0);                \
  };
RAYMAP_FIRST_VERSION(raymap_mesh_arrays, origin)
RAYMAP_FIRST_VERSION(raymap_grid_options, box_max)
RAYMAP_FIRST_VERSION(raymap_stats, patch_area)
RAYMAP_FIRST_VERSION(raymap_query_arrays, confidence)
RAYMAP_FIRST_VERSION(raymap_thickness_arrays, inward)
RAYMAP_FIRST_VERSION(raymap_sample_points_options, seed)
RAYMAP_FIRST_VERSION(raymap_point_sample_arrays, scale)
RAYMAP_FIRST_VERSION(raymap_band_options, inside)
RAYMAP_FIRST_VERSION(raymap_sparse_numbers, inside)
RAYMAP_FIRST_VERSION(raymap_configurations, count)
RAYMAP_FIRST_VERSION(raymap_scene_arrays, distances)
RAYMAP_FIRST_VERSION(raymap_findings, voxel_size)
RAYMAP_FIRST_VERSION(raymap_repair_options, down)
RAYMAP_FIRST_VERSION(raymap_repair_numbers, buried_share)
RAYMAP_FIRST_VERSION(raymap_simplify_options, triangles)
RAYMAP_FIRST_VERSION(raymap_simplified, undone)
RAYMAP_FIRST_VERSION(raymap_view, frame_max)
RAYMAP_FIRST_VERSION(raymap_page_options, max_size)
RAYMAP_FIRST_VERSION(raymap_device, test_problem)

/// Copies a caller's struct of any version to one of this version. Members that the caller does not have
/// become 0. Throws `Error(Usage)` if the size cannot be right, or if members that this version does not know
/// are not 0.
void readStruct(const void* given, void* known, size_t knownSize, size_t firstSize, const char* name);

/// Copies a struct of this version to a caller's of any version, but its size. Members that this version does
/// not know become 0. Throws `Error(Usage)` if the size cannot be right.
void writeStruct(const void* known, size_t knownSize, void* given, size_t firstSize, const char* name);

/// Returns a caller's struct as one of this version; the defaults for null.
template <class Struct>
Struct read(const Struct* given) {
  using First = FirstVersion<Struct>;
  Struct known{};
  if (given) readStruct(given, &known, sizeof known, First::kSize, First::kName);
  return known;
}

/// Copies a struct of this version to the caller's. Throws `Error(Usage)` if that is null.
template <class Struct>
void write(const Struct& known, Struct* given) {
  using First = FirstVersion<Struct>;
  writeStruct(&known, sizeof known, &need(given, First::kName), First::kSize, First::kName);
}

}  // namespace raymap::c
