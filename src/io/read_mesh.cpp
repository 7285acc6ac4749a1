#include <raymap/animation.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>

#include "io/mesh/mesh_file.h"
#ifdef RAYMAP_ASSIMP
#include "io/import/import_mesh.h"
#endif

namespace raymap {

namespace {

struct Format {
  std::string_view extension;
  Mesh (*read)(const MeshFile& file);  ///< Null if Assimp reads the format, in a child process.
};

constexpr std::array kFormats{Format{".obj", readObj}, Format{".ply", readPly},   Format{".stl", readStl},
                              Format{".off", readOff}, Format{".gltf", readGltf}, Format{".glb", readGltf},
                              Format{".3mf", read3mf}, Format{".fbx", nullptr},   Format{".dae", nullptr}};

#ifdef RAYMAP_ASSIMP
constexpr bool kHasAssimp = true;
#else
constexpr bool kHasAssimp = false;
Mesh importMesh(const std::filesystem::path& path, const WarningCallback&) {
  throw Error(ErrorCode::Unsupported,
              path.string() + ": raymap was built without Assimp; build it with RAYMAP_ASSIMP=ON");
}
#endif

[[noreturn]] void failExtension(const std::filesystem::path& path) {
  std::string known;
  for (const std::string& each : meshExtensions()) known.append(" ").append(each);
  throw Error(ErrorCode::Unsupported,
              path.string() + ": cannot tell the format of this file by its name; known are" + known);
}

}  // namespace

Mesh readMesh(const std::filesystem::path& path, const WarningCallback& warn) {
  const auto* format = std::ranges::find(kFormats, lowerExtension(path), &Format::extension);
  if (format == kFormats.end()) failExtension(path);
  if (!format->read) return importMesh(path, warn);
  const Buffer<std::byte> bytes = loadFile(path);
  return format->read({bytes, path, warn});
}

AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, size_t animation,
                              const WarningCallback& warn) {
  if (const std::string extension = lowerExtension(path); extension != ".gltf" && extension != ".glb")
    throw Error(ErrorCode::Unsupported, path.string() + ": animations are read from .gltf and .glb only");
  const Buffer<std::byte> bytes = loadFile(path);
  return readAnimatedGltf({bytes, path, warn}, animation);
}

std::optional<LengthUnit> meshUnit(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".3mf") return LengthUnit::Millimetre;
  if (extension == ".gltf" || extension == ".glb" || extension == ".dae") return LengthUnit::Metre;
  return std::nullopt;
}

std::vector<std::string> meshExtensions() {
  std::vector<std::string> extensions;
  extensions.reserve(kFormats.size());
  for (const Format& format : kFormats)
    if (format.read || kHasAssimp) extensions.emplace_back(format.extension);
  return extensions;
}

}  // namespace raymap
