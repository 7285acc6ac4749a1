// Checks that any bytes give a valid mesh or an Error.

#include <raymap/error.h>
#include <raymap/mesh_view.h>
#include <raymap/warning.h>

#include <cstdlib>

#include "io/mesh/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const raymap::MeshFile file{std::as_bytes(std::span(data, size)), "/nonexistent/mesh",
                                [](const raymap::Warning&) {}};
    validate(raymap::RAYMAP_READER(file));
  } catch (const raymap::Error& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
