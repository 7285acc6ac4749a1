// Checks that any bytes give points, or an Error.

#include <raymap/error.h>

#include <cstdlib>
#include <string_view>

#include "io/points/point_formats.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const raymap::MeshFile file{std::as_bytes(std::span(data, size)), "points.csv", {}};
    if (raymap::RAYMAP_READER(file).size() > size) std::abort();
  } catch (const raymap::Error& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
