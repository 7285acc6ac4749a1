#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>

#include "io/mesh/mesh_file.h"
#include "io/mesh/mesh_formats.h"

namespace raymap {

namespace {

struct Format {
  std::string_view extension;
  void (*write)(std::ostream& out, const PackedMesh& mesh);
};

constexpr std::array kFormats{Format{".ply", writePly}, Format{".obj", writeObj}, Format{".stl", writeStl},
                              Format{".glb", writeGlb}};

}  // namespace

void writeMesh(const std::filesystem::path& path, const MeshView& view) {
  const auto* format = std::ranges::find(kFormats, lowerExtension(path), &Format::extension);
  if (format == kFormats.end()) {
    std::string known;
    for (const Format& f : kFormats) known.append(" ").append(f.extension);
    throw Error(ErrorCode::Usage, path.string() + ": meshes are written as" + known);
  }
  validate(view);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  try {
    writeAtomically(path, [&](std::ostream& out) { format->write(out, mesh); });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Unsupported) throw;
    throw Error(error.code(), path.string() + ": " + error.what());
  }
}

std::vector<std::string> writableMeshExtensions() {
  std::vector<std::string> extensions;
  extensions.reserve(kFormats.size());
  for (const Format& format : kFormats) extensions.emplace_back(format.extension);
  return extensions;
}

}  // namespace raymap
