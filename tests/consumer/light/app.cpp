// Formats whose libraries were switched off are refused, by errors that name the option; all others work.

#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace {

template <class Work>
bool isRefused(const std::string& option, Work&& work) {
  try {
    work();
  } catch (const raymap::Error& error) {
    std::printf("%s\n", error.what());
    return error.code() == raymap::ErrorCode::Unsupported &&
           std::string(error.what()).find(option + "=ON") != std::string::npos;
  }
  return false;
}

bool isListed(const std::vector<std::string>& extensions, const char* extension) {
  return std::ranges::find(extensions, extension) != extensions.end();
}

}  // namespace

int main() {
  raymap::Field field;
  field.grid.dims = {2, 2, 2};
  field.grid.spacing = 1.0;
  field.distance.resizeUninitialized(8);
  std::ranges::fill(field.distance, 1.0f);
  raymap::writeField("field.nrrd", field);
  const bool works = std::ranges::equal(raymap::readField("field.nrrd").distance, field.distance);
  const bool refuses = isRefused("RAYMAP_OPENVDB", [&] { raymap::writeField("field.vdb", field); }) &&
                       isRefused("RAYMAP_OPENVDB", [] { raymap::readField("field.vdb"); }) &&
                       isRefused("RAYMAP_ASSIMP", [] { raymap::readMesh("tetrahedron.dae"); });
  const bool lists =
      isListed(raymap::fieldExtensions(), ".nrrd") && !isListed(raymap::fieldExtensions(), ".vdb") &&
      isListed(raymap::meshExtensions(), ".3mf") && !isListed(raymap::meshExtensions(), ".dae");
  return works && refuses && lists ? 0 : 1;
}
