#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "io/mesh/mesh_file.h"
#include "io/zip/zip_reader.h"

namespace raymap {

/// The parts of an OPC package: the files of a zip in memory. Their names ignore case and begin without a
/// slash.
class ZipParts {
 public:
  /// Reads the directory. Fails if it is damaged or names a part twice.
  explicit ZipParts(const MeshFile& file);

  const MeshFile& file() const { return file_; }
  bool has(std::string_view name) const;
  /// Gives the content of a part to `take`, piece by piece. Fails if there is no such part, if it is damaged
  /// or encrypted, or if all that was read inflates to far more than a model does.
  void read(std::string_view name, const std::function<void(std::string_view piece)>& take);

 private:
  const MeshFile& file_;
  ZipReader zip_;
  std::map<std::string, size_t> indices_;
  uint64_t inflated_ = 0;
};

}  // namespace raymap
