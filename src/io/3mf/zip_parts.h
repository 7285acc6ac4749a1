#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// The parts of an OPC package: the files of a zip in memory. Their names ignore case and begin without a
/// slash.
class ZipParts {
 public:
  /// Reads the directory. Fails if it is damaged or names a part twice.
  explicit ZipParts(const MeshFile& file);
  ~ZipParts();
  ZipParts(const ZipParts&) = delete;
  ZipParts& operator=(const ZipParts&) = delete;

  const MeshFile& file() const { return file_; }
  bool has(std::string_view name) const;
  /// Gives the content of a part to `take`, piece by piece. Fails if there is no such part, if it is damaged
  /// or encrypted, or if all that was read inflates to far more than a model does.
  void read(std::string_view name, const std::function<void(std::string_view piece)>& take);

 private:
  struct Source;
  struct Place {
    uint64_t position = 0, number = 0;  ///< Where minizip finds the part.
    bool isEncrypted = false;
  };

  const MeshFile& file_;
  std::unique_ptr<Source> source_;
  std::unique_ptr<void, int (*)(void*)> zip_;  ///< Closed before the source goes.
  std::map<std::string, Place> places_;
  uint64_t inflated_ = 0;
};

}  // namespace raymap
