#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "io/import/child_process.h"

namespace raymap {

/// Reads a file with the program `raymap-import`, in a child process with limits on its memory and time, so
/// that whatever a damaged file does to the libraries in there becomes an Error here. The program is looked
/// for where the environment variable RAYMAP_IMPORT says, then beside this program or library, then where it
/// was installed.
class Importer {
 public:
  enum class Kind { Mesh, Vdb };
  /// Throws the error that the program reports.
  Importer(const std::filesystem::path& file, uint64_t fileBytes, Kind kind);

  const std::string& warning() const { return message_; }
  /// The next `bytes` of what it gives; throws `Error(Input)` if there are fewer.
  void receive(void* data, size_t bytes);

 private:
  std::filesystem::path file_;
  ChildProcess child_;
  std::string message_;
};

}  // namespace raymap
