#pragma once

#include <raymap/export.h>

// Version of these headers. raymap's own build stops if it differs from the project's version in
// CMakeLists.txt. Plain C, so that raymap/c.h includes it too.

#define RAYMAP_VERSION_MAJOR 0
#define RAYMAP_VERSION_MINOR 1
#define RAYMAP_VERSION_PATCH 0

/// The version as one number that grows, for `#if`: 100 for 0.1.0.
#define RAYMAP_VERSION (RAYMAP_VERSION_MAJOR * 10000 + RAYMAP_VERSION_MINOR * 100 + RAYMAP_VERSION_PATCH)

#ifdef __cplusplus
namespace raymap {

/// Version of the linked library, which may differ from that of the headers.
struct Version {
  int major = 0;
  int minor = 0;
  int patch = 0;
  const char* text = "";  ///< "0.1.0"; lives as long as the program.
};

/// Returns the version of the linked library.
RAYMAP_API Version version();

}  // namespace raymap
#endif
