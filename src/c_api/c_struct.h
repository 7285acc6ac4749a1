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
RAYMAP_FIRST_VERSION(raymap_field_files, grid_name)
RAYMAP_FIRST_VERSION(raymap_query_arrays, confidence)
RAYMAP_FIRST_VERSION(raymap_thickness_arrays, inward)
RAYMAP_FIRST_VERSION(raymap_point_sample_arrays, scale)
RAYMAP_FIRST_VERSION(raymap_configurations, count)
RAYMAP_FIRST_VERSION(raymap_scene_arrays, distances)

/// Copies a caller's struct of any version to one of this version. Members that the caller does not have
/// become 0. Throws `Error(Usage)` if the size cannot be right, or if members that this version does not know
/// are not 0.
void readStruct(const void* given, void* known, size_t knownSize, size_t firstSize, const char* name);

/// Returns a caller's struct as one of this version; the defaults for null.
template <class Struct>
Struct read(const Struct* given) {
  using First = FirstVersion<Struct>;
  Struct known{};
  if (given) readStruct(given, &known, sizeof known, First::kSize, First::kName);
  return known;
}

}  // namespace raymap::c
