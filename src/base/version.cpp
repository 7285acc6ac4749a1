#include <raymap/version.h>

#include <string_view>

namespace raymap {

namespace {

#define RAYMAP_QUOTE_(text) #text
#define RAYMAP_QUOTE(text) RAYMAP_QUOTE_(text)
constexpr const char* kText = RAYMAP_QUOTE(RAYMAP_VERSION_MAJOR) "." RAYMAP_QUOTE(
    RAYMAP_VERSION_MINOR) "." RAYMAP_QUOTE(RAYMAP_VERSION_PATCH);

// RAYMAP_PROJECT_VERSION comes from CMakeLists.txt.
static_assert(std::string_view(kText) == RAYMAP_PROJECT_VERSION,
              "raymap/version.h and the project's version in CMakeLists.txt differ");

}  // namespace

Version version() {
  return {RAYMAP_VERSION_MAJOR, RAYMAP_VERSION_MINOR, RAYMAP_VERSION_PATCH, kText};
}

}  // namespace raymap
