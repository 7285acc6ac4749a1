#include "io/import/importer.h"

#include <dlfcn.h>
#include <raymap/error.h>

#include <cstdlib>

#include "io/field/field_array.h"
#include "io/import/import_stream.h"

namespace raymap {

namespace {

constexpr const char* kProgram = "raymap-import";

std::filesystem::path findProgram(const std::filesystem::path& file) {
  if (const char* given = std::getenv("RAYMAP_IMPORT")) return given;
  std::vector<std::filesystem::path> folders;
  std::error_code error;
  folders.push_back(std::filesystem::read_symlink("/proc/self/exe", error).parent_path());
  Dl_info here{};
  if (dladdr(reinterpret_cast<const void*>(&findProgram), &here) != 0 && here.dli_fname)
    folders.push_back(std::filesystem::absolute(here.dli_fname, error).parent_path());
  for (size_t i = 0, count = folders.size(); i < count; ++i)
    folders.push_back(folders[i].parent_path() / "libexec/raymap");
  folders.emplace_back(RAYMAP_LIBEXEC);
  for (const std::filesystem::path& folder : folders)
    if (std::filesystem::exists(folder / kProgram, error)) return folder / kProgram;
  throwUnsupported(file, std::string("the program ") + kProgram +
                             " that reads this format is missing; install it beside this one, or set "
                             "RAYMAP_IMPORT to its path");
}

/// Its memory is twenty times what ordinary files of the kinds take, packed ones included.
std::vector<std::string> argumentsFor(const std::filesystem::path& file, uint64_t fileBytes,
                                      Importer::Kind kind) {
  return {kind == Importer::Kind::Mesh ? "mesh" : "vdb", file.string(),
          std::to_string((uint64_t{48} << 20) + 128 * fileBytes), std::to_string(1 + (fileBytes >> 20))};
}

}  // namespace

Importer::Importer(const std::filesystem::path& file, uint64_t fileBytes, Kind kind)
    : file_(file),
      child_(findProgram(file), argumentsFor(file, fileBytes, kind),
             static_cast<int>(10 * (1 + (fileBytes >> 20)))) {
  constexpr uint64_t kLongestMessage = 1 << 20;
  ImportHeader header;
  receive(&header, sizeof header);
  if (header.magic != kImportMagic || header.messageBytes > kLongestMessage)
    throwInvalid(file_, "the importer speaks another version; reinstall raymap");
  message_.resize(header.messageBytes);
  receive(message_.data(), message_.size());
  if (header.errorCode != 0)
    throw Error(static_cast<ErrorCode>(header.errorCode), file_.string() + ": " + message_);
}

void Importer::receive(void* data, size_t bytes) {
  if (child_.read(data, bytes) == bytes) return;
  const std::string failure = child_.failure();
  throwInvalid(file_, "cannot read it: " + (failure.empty() ? "the importer stopped early" : failure));
}

}  // namespace raymap
