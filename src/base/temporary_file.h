#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "base/descriptor.h"

namespace raymap {

/// A file that is written in the folder of its target and takes the target's name when it is whole. If the
/// object ends before, nothing is left.
///
/// Where the file system can, the file has no name until then, so that even a killed process leaves nothing.
/// Elsewhere it has a hidden name and is locked. What a killed process left is not locked: the next object of
/// the same target removes it.
class TemporaryFile {
 public:
  enum class Name { None, Hidden };

  /// Makes the file. `path` stands for the target in messages. Only tests of hidden names want one.
  TemporaryFile(const std::filesystem::path& target, const std::filesystem::path& path,
                Name wanted = Name::None);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return file_.get(); }
  /// Gives the file its target's name, in place of a file that has it.
  void publish();

  /// Removes the files of this process that have hidden names. Safe in a signal handler.
  static void removeAll() noexcept;

 private:
  int make(Name wanted);
  template <class Take>
  bool takeHiddenName(Take&& take);
  void setName(std::string name);
  void forgetName();

  std::filesystem::path target_, path_;
  std::string name_;  ///< Hidden name, if there is one.
  std::atomic<const char*>* slot_ = nullptr;
  Descriptor file_;
};

}  // namespace raymap
