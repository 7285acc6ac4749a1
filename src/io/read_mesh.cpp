#include <raymap/animation.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/file_format.h"
#include "io/foreign_file.h"
#include "io/mesh/mesh_file.h"
#ifdef RAYMAP_ASSIMP
#include "io/import/import_mesh.h"
#endif

namespace raymap {

namespace {

constexpr size_t kKindBytes = 256;  // What a file is shows in so many.

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
Mesh importMesh(const SourceFile& source, std::string_view, const MeshFile&) {
  throw Error(ErrorCode::Unsupported,
              source.path().string() + ": raymap was built without Assimp; build it with RAYMAP_ASSIMP=ON");
}
#endif

/// Returns whether a file in this format begins like no other.
bool isPlain(std::string_view format) {
  return format == ".obj" || format == ".ply" || format == ".stl" || format == ".off";
}

[[noreturn]] void failFormat(const SourceFile& source) {
  const std::string path = source.path().string();
  if (!formatOf(source, {}, knownFieldFormats()).empty())
    throw Error(ErrorCode::Usage, path + ": it is a field, and a mesh is needed; make its isosurface");
  throw Error(ErrorCode::Unsupported,
              path + ": neither its name nor its bytes tell the format of this mesh; say which it is: " +
                  listOf(meshExtensions()));
}

}  // namespace

Mesh readMeshAs(const SourceFile& source, std::string_view name, const ReadOptions& options) {
  const auto* format = std::ranges::find(kFormats, name, &Format::extension);
  if (format == kFormats.end()) failFormat(source);
  MeshFile file{{}, source.path(), options.warn, source.folder(), options.allowEmpty, options.exact};
  file.attributes = options.attributes;
  if (file.attributes) *file.attributes = {};
  try {
    if (!format->read) return importMesh(source, format->extension, file);
    const Buffer<std::byte> bytes = loadFile(source);
    file.bytes = bytes;
    return format->read(file);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Input) throw;
    if (const std::string kind = foreignKind(source.head(kKindBytes), name); !kind.empty()) file.fail(kind);
    const std::string content = formatOfContent(source);
    if (content.empty() || content == name || !isPlain(name)) throw;
    file.fail("its bytes are those of a " + content + "; rename it");
  }
}

Mesh readMesh(const std::filesystem::path& path, const ReadOptions& options) {
  const SourceFile source(path);
  return readMeshAs(source, formatOf(source, options.format, knownMeshFormats()), options);
}

std::variant<Mesh, Field> read(const std::filesystem::path& path, const ReadOptions& options) {
  const SourceFile source(path);
  Formats known = knownMeshFormats();
  const Formats fields = knownFieldFormats();
  known.insert(known.end(), fields.begin(), fields.end());
  const std::string found = formatOf(source, options.format, known);
  if (contains(fields, found)) return readFieldAs(source, found, options);
  if (!options.gridName.empty())
    throw Error(ErrorCode::Usage,
                path.string() + ": only a .vdb or .nvdb has grids with names; leave the name out");
  if (contains(known, found)) return readMeshAs(source, found, options);
  throw Error(ErrorCode::Unsupported,
              path.string() + ": neither its name nor its bytes tell whether this is a mesh or a field; " +
                  "known are " + listOf(known));
}

namespace {

template <class Clip>
AnimatedMesh readAnimated(const std::filesystem::path& path, const Clip& clip, const ReadOptions& options) {
  if (const std::string extension = lowerExtension(path); extension != ".gltf" && extension != ".glb")
    throw Error(ErrorCode::Unsupported, path.string() + ": animations are read from .gltf and .glb only");
  const Buffer<std::byte> bytes = loadFile(SourceFile(path));
  return readAnimatedGltf({bytes, path, options.warn}, clip);
}

}  // namespace

AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, size_t animation,
                              const ReadOptions& options) {
  return readAnimated(path, animation, options);
}

AnimatedMesh readAnimatedMesh(const std::filesystem::path& path, const std::string& clip,
                              const ReadOptions& options) {
  return readAnimated(path, clip, options);
}

std::optional<LengthUnit> meshUnit(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".3mf") return LengthUnit::Millimetre;
  if (extension == ".gltf" || extension == ".glb" || extension == ".dae") return LengthUnit::Metre;
  return std::nullopt;
}

Formats knownMeshFormats() {
  Formats formats;
  for (const Format& format : kFormats) formats.emplace_back(format.extension);
  return formats;
}

std::vector<std::string> meshExtensions() {
  std::vector<std::string> extensions;
  extensions.reserve(kFormats.size());
  for (const Format& format : kFormats)
    if (format.read || kHasAssimp) extensions.emplace_back(format.extension);
  return extensions;
}

}  // namespace raymap
