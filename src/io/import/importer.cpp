#include "io/import/importer.h"

#include <dlfcn.h>
#include <raymap/error.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>

#include "base/memory.h"
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

constexpr uint64_t kMebibyte = uint64_t{1} << 20;

/// Returns the most memory that the program may take for a file: twenty times what ordinary files of the
/// kinds take, packed ones included.
uint64_t fullMemoryFor(uint64_t fileBytes) {
  return 48 * kMebibyte + 128 * fileBytes;
}

/// Returns half of the memory that is left besides the program's code: this process keeps what it sends.
uint64_t halfOfMemoryLeft(const std::filesystem::path& file) {
  constexpr uint64_t kCode = 64 * kMebibyte, kLeast = 96 * kMebibyte;
  const uint64_t left = memoryLeft();
  if (left < kLeast)
    throw Error(ErrorCode::Memory, file.string() + ": a process of its own reads it, which needs " +
                                       neededText(kLeast) + ", but only " + limitText(left) + " are left");
  return (left - kCode) / 2;
}

std::vector<std::string> argumentsFor(const SourceFile& file, std::string_view format, uint64_t fileBytes,
                                      uint64_t memory, const GridChoice& grid) {
  return {std::string(format),    file.place().string(),
          std::to_string(memory), std::to_string(1 + fileBytes / kMebibyte),
          std::string(grid.name), std::to_string(grid.mostDense)};
}

}  // namespace

Importer::Importer(const SourceFile& file, std::string_view format, uint64_t fileBytes,
                   const GridChoice& grid)
    : file_(file.path()),
      fullMemory_(fullMemoryFor(fileBytes)),
      memory_(std::min(fullMemory_, halfOfMemoryLeft(file_))),
      child_(findProgram(file_), argumentsFor(file, format, fileBytes, memory_, grid),
             static_cast<int>(10 * (1 + fileBytes / kMebibyte))) {
  constexpr uint64_t kLongestMessage = 1 << 20;
  ImportHeader header;
  receive(&header, sizeof header);
  if (header.magic != kImportMagic || header.messageBytes > kLongestMessage)
    throwInvalid(file_, "the importer speaks another version; reinstall raymap");
  message_.resize(header.messageBytes);
  receive(message_.data(), message_.size());
  if (header.failure == 1 + static_cast<uint32_t>(ErrorCode::Memory)) failOfMemory();
  if (header.failure != 0)
    throw Error(static_cast<ErrorCode>(header.failure - 1), file_.string() + ": " + message_);
}

void Importer::failOfMemory() const {
  if (memory_ == fullMemory_)
    throwInvalid(file_, "it asks for more memory than a file of its size may take: a count in it is damaged");
  throw Error(ErrorCode::Memory, file_.string() + ": the process that reads it needs more than " +
                                     limitText(memory_) + ", half of what is left; allow more memory");
}

void Importer::receive(void* data, size_t bytes) {
  if (child_.read(data, bytes) == bytes) return;
  const std::string failure = child_.failure();
  throwInvalid(file_, "cannot read it: " + (failure.empty() ? "the importer stopped early" : failure));
}

}  // namespace raymap
