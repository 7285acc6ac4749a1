#include "import_mesh.h"

#include <dlfcn.h>
#include <raymap/error.h>

#include <cstdlib>

#include "child_process.h"
#include "import_stream.h"
#include "mesh_file.h"

namespace raymap {

namespace {

constexpr const char* kProgram = "raymap-import";

std::filesystem::path findProgram(const std::filesystem::path& file) {
  if (const char* given = std::getenv("RAYMAP_IMPORT")) return given;
  std::vector<std::filesystem::path> folders;
  std::error_code error;
  folders.push_back(std::filesystem::read_symlink("/proc/self/exe", error).parent_path());
  Dl_info here{};
  if (dladdr(reinterpret_cast<const void*>(&importMesh), &here) != 0 && here.dli_fname)
    folders.push_back(std::filesystem::absolute(here.dli_fname, error).parent_path());
  for (size_t i = 0, count = folders.size(); i < count; ++i)
    folders.push_back(folders[i].parent_path() / "libexec/raymap");
  folders.emplace_back(RAYMAP_LIBEXEC);
  for (const std::filesystem::path& folder : folders)
    if (std::filesystem::exists(folder / kProgram, error)) return folder / kProgram;
  throw Error(ErrorCode::Unsupported,
              file.string() + ": the program " + kProgram +
                  " that reads this format is missing; install it beside this one, or set "
                  "RAYMAP_IMPORT to its path");
}

/// Reads what the child says, or fails with why it cannot.
class Importer {
 public:
  Importer(const MeshFile& file, uint64_t fileBytes)
      : file_(file),
        // Twenty times what ordinary files of the kinds take, packed ones included.
        child_(findProgram(file.path),
               {file.path.string(), std::to_string((uint64_t{80} << 20) + 128 * fileBytes),
                std::to_string(1 + (fileBytes >> 20))},
               static_cast<int>(10 * (1 + (fileBytes >> 20)))) {}

  Mesh read() {
    ImportHeader header;
    receive(&header, sizeof header);
    if (header.magic != kImportMagic) file_.fail("the importer speaks another version; reinstall raymap");
    checkMemory(file_, header.messageBytes + header.vertices * sizeof(glm::dvec3) +
                           header.triangles * sizeof(glm::uvec3));
    std::string message(header.messageBytes, ' ');
    receive(message.data(), message.size());
    if (header.failed) file_.fail(message);
    if (!message.empty()) file_.warnThat(message);

    std::vector<glm::dvec3> positions(header.vertices);
    std::vector<glm::uvec3> triangles(header.triangles);
    receive(positions.data(), positions.size() * sizeof(glm::dvec3));
    receive(triangles.data(), triangles.size() * sizeof(glm::uvec3));
    for (size_t t = 0; t < triangles.size(); ++t)
      for (int c = 0; c < 3; ++c)
        if (triangles[t][c] >= positions.size())
          file_.fail("triangle " + std::to_string(t) + ": " + outOfRange(triangles[t][c], positions.size()));
    return finishMesh(file_, std::move(positions), std::move(triangles));
  }

 private:
  void receive(void* data, size_t bytes) {
    if (child_.read(data, bytes) == bytes) return;
    const std::string failure = child_.failure();
    file_.fail("cannot read it: " + (failure.empty() ? "the importer stopped early" : failure));
  }

  const MeshFile& file_;
  ChildProcess child_;
};

}  // namespace

Mesh importMesh(const std::filesystem::path& path, const Warn& warn) {
  const MeshFile file{{}, path, warn};
  return Importer(file, regularFileSize(path)).read();
}

}  // namespace raymap
