// Checks that any XML in a whole 3MF gives a valid mesh, whose attributes a .3mf and a .glb can hold, or an
// Error. Damaged archives are for read_3mf_fuzz. A byte 0xFF, which XML cannot hold, ends the root part and
// begins the part 3D/b.model. A second one begins the files of slicers.

#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/mesh_view.h>

#include <cstdlib>

#include "samples_3mf.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raymap;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const size_t end = text.find('\xff'), second = end == text.npos ? end : text.find('\xff', end + 1);
  samples::Parts parts{{"3D/3dmodel.model", text.substr(0, end)},
                       {"3D/b.model", end == text.npos ? "" : text.substr(end + 1, second - end - 1)}};
  if (second != text.npos)
    for (const char* config : {"Metadata/Slic3r_PE_model.config", "Metadata/model_settings.config"})
      parts.emplace_back(config, text.substr(second + 1));
  const std::string bytes = samples::package3mf(parts, samples::Zip::Stored);
  try {
    MeshAttributes attributes;
    MeshFile file{std::as_bytes(std::span(bytes)), "/nonexistent/mesh", [](const raymap::Warning&) {}};
    file.attributes = &attributes;
    const Mesh mesh = read3mf(file);
    validate(mesh);
    for (const char* format : {".3mf", ".glb"})
      writeMesh("/dev/null", mesh, {.format = format, .attributes = &attributes});
  } catch (const Error& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
