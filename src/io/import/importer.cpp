#include "io/import/importer.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstdlib>

#include "base/memory.h"
#include "io/field/field_array.h"
#include "io/import/companion.h"
#include "io/import/import_stream.h"

namespace raymap {

namespace {

constexpr const char* kProgram = "raymap-import";

std::filesystem::path findProgram(const std::filesystem::path& file) {
  if (const char* given = std::getenv("RAYMAP_IMPORT")) return given;
  if (const auto found = findCompanion(kProgram)) return *found;
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
