// Checks that any bytes give a valid mesh with attributes that fit it and can be written, or an Error.

#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/mesh_view.h>
#include <raymap/warning.h>

#include <cstdlib>

#include "io/mesh/mesh_file.h"

namespace {

template <class AnyMesh>
void check(const AnyMesh& mesh, const raymap::MeshAttributes& attributes) {
  validate(mesh);
  if constexpr (requires { mesh.triangles; })
    writeMesh("/dev/null", mesh, {.format = ".glb", .attributes = &attributes});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    raymap::MeshAttributes attributes;
    raymap::MeshFile file{std::as_bytes(std::span(data, size)), "/nonexistent/mesh",
                          [](const raymap::Warning&) {}};
    file.attributes = &attributes;
    check(raymap::RAYMAP_READER(file), attributes);
  } catch (const raymap::Error& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
