#pragma once

#include <gtest/gtest.h>

#include "testing/mesh_rows.h"  // IWYU pragma: export

/// Leaves a test that needs the folder where there is none. Fails it where RAYMAP_REQUIRE_MESHES is set.
#define RAYMAP_NEED_MESHES()                                                                         \
  if (raymap::meshRows().empty()) {                                                                  \
    if (std::getenv("RAYMAP_REQUIRE_MESHES")) FAIL() << "no MESHES.tsv in " << raymap::meshFolder(); \
    GTEST_SKIP() << "no MESHES.tsv in " << raymap::meshFolder();                                     \
  }                                                                                                  \
  static_assert(true)
