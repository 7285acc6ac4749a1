#include "io/import/importer.h"

#include <dlfcn.h>
#include <raymap/error.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>

#include "io/field/field_array.h"
#include "io/import/import_stream.h"

namespace raymap {

namespace {

constexpr const char* kProgram = "raymap-import";

/// The file of the program or library that holds this code, as the dynamic loader names it; empty if it has
/// no name.
std::string ownFile() {
  Dl_info here{};
  const bool isKnown = dladdr(reinterpret_cast<const void*>(&ownFile), &here) != 0 && here.dli_fname;
  return isKnown ? here.dli_fname : "";
}

/// Returns the folders in which the dynamic loader looks for libraries of the program or library that holds
/// this code. Its run path is among them. Programs that link the static raymap::io have the folder of
/// `raymap-import` there, as src/io/CMakeLists.txt and raymap.pc ask.
std::vector<std::filesystem::path> loaderFolders() {
  std::vector<std::filesystem::path> folders;
#ifdef __GLIBC__
  void* own = dlopen(ownFile().c_str(), RTLD_LAZY | RTLD_NOLOAD);
  if (!own) own = dlopen(nullptr, RTLD_LAZY);  // A program has no name for dlopen.
  Dl_serinfo size{};
  if (own && dlinfo(own, RTLD_DI_SERINFOSIZE, &size) == 0) {
    std::vector<std::max_align_t> memory(size.dls_size / sizeof(std::max_align_t) + 1);
    auto* info = reinterpret_cast<Dl_serinfo*>(memory.data());
    if (dlinfo(own, RTLD_DI_SERINFOSIZE, info) == 0 && dlinfo(own, RTLD_DI_SERINFO, info) == 0)
      for (unsigned i = 0; i < info->dls_cnt; ++i) folders.emplace_back(info->dls_serpath[i].dls_name);
  }
  if (own) dlclose(own);
#endif
  return folders;
}

std::filesystem::path findProgram(const std::filesystem::path& file) {
  if (const char* given = std::getenv("RAYMAP_IMPORT")) return given;
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::filesystem::path own = std::filesystem::absolute(ownFile(), error).parent_path();
  std::vector<std::filesystem::path> folders{program, own, program / RAYMAP_LIBEXEC_FROM_PROGRAMS,
                                             own / RAYMAP_LIBEXEC_FROM_LIBRARIES};
  std::ranges::copy(loaderFolders(), std::back_inserter(folders));
  folders.emplace_back(RAYMAP_LIBEXEC);
  for (const std::filesystem::path& folder : folders)
    if (std::filesystem::exists(folder / kProgram, error)) return folder / kProgram;
  throwUnsupported(file, std::string("the program ") + kProgram +
                             " that reads this format is missing; install it beside this one, or set "
                             "RAYMAP_IMPORT to its path");
}

/// Its memory is twenty times what ordinary files of the kinds take, packed ones included.
std::vector<std::string> argumentsFor(const SourceFile& file, std::string_view format, uint64_t fileBytes,
                                      const GridChoice& grid) {
  return {std::string(format),
          file.place().string(),
          std::to_string((uint64_t{48} << 20) + 128 * fileBytes),
          std::to_string(1 + (fileBytes >> 20)),
          std::string(grid.name),
          std::to_string(grid.mostDense)};
}

}  // namespace

Importer::Importer(const SourceFile& file, std::string_view format, uint64_t fileBytes,
                   const GridChoice& grid)
    : file_(file.path()),
      child_(findProgram(file_), argumentsFor(file, format, fileBytes, grid),
             static_cast<int>(10 * (1 + (fileBytes >> 20)))) {
  constexpr uint64_t kLongestMessage = 1 << 20;
  ImportHeader header;
  receive(&header, sizeof header);
  if (header.magic != kImportMagic || header.messageBytes > kLongestMessage)
    throwInvalid(file_, "the importer speaks another version; reinstall raymap");
  message_.resize(header.messageBytes);
  receive(message_.data(), message_.size());
  if (header.failure != 0)
    throw Error(static_cast<ErrorCode>(header.failure - 1), file_.string() + ": " + message_);
}

void Importer::receive(void* data, size_t bytes) {
  if (child_.read(data, bytes) == bytes) return;
  const std::string failure = child_.failure();
  throwInvalid(file_, "cannot read it: " + (failure.empty() ? "the importer stopped early" : failure));
}

}  // namespace raymap
