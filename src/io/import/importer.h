#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/source_file.h"
#include "io/field/field_formats.h"
#include "io/import/child_process.h"

namespace raymap {

/// Reads a file with the program `raymap-import`, a child process with limited memory and time. If a damaged
/// file crashes the libraries there, this process gets an Error. The environment variable RAYMAP_IMPORT names
/// the program. Otherwise it is one beside this program or library, or the installed one: found from this
/// program or library, from the run path, or by the prefix that the build was configured with.
class Importer {
 public:
  /// Starts the program and reads its header. `format` is an extension: ".vdb", ".nvdb", or one of Assimp's.
  /// Throws the error that the program reports.
  Importer(const SourceFile& file, std::string_view format, uint64_t fileBytes, const GridChoice& grid = {});

  const std::string& warning() const { return message_; }
  /// Reads the next `bytes` bytes of its output. Throws `Error(Input)` if there are fewer.
  void receive(void* data, size_t bytes);

 private:
  /// Throws the error for a file that takes more memory than the child has.
  [[noreturn]] void failOfMemory() const;

  std::filesystem::path file_;
  uint64_t fullMemory_, memory_;  ///< Most bytes for a file of this size, and for the child.
  ChildProcess child_;
  std::string message_;
};

}  // namespace raymap
