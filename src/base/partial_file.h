#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "base/descriptor.h"

namespace raymap {

/// A file that is written in steps, by runs that may be stopped. Until it is whole, its name is `PATH.part`.
/// `PATH.part.done` holds the key of the work, the number of steps that are whole, and their bytes.
class PartialFile {
 public:
  /// State that earlier runs left.
  enum class Left : uint8_t {
    Nothing,
    Start,      ///< The start of the file, which this run goes on with.
    OtherWork,  ///< A file with another key. It is dropped.
    TooLittle,  ///< Less than was noted. It is dropped.
  };

  /// Opens the file. Throws `Error(File)` if it cannot, if another process writes it, or if there is a
  /// `PATH.part` of another program.
  PartialFile(const std::filesystem::path& path, uint64_t key);
  /// Removes the file if no step is noted.
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  Left left() const { return left_; }
  const std::filesystem::path& part() const { return part_; }
  /// Returns the number of steps that are noted as whole.
  uint64_t noted() const { return noted_; }
  /// Writes bytes at their place in the file.
  void write(uint64_t place, std::span<const std::byte> bytes);
  /// Flushes the file to the disk and notes that so many steps are whole.
  void note(uint64_t steps);
  /// Flushes the file to the disk and gives it its name, in place of a file that has it.
  void publish();

 private:
  void findLeft();
  void writeNote();

  std::filesystem::path path_, target_, part_, note_;
  uint64_t key_;
  Descriptor file_;
  Left left_ = Left::Nothing;
  uint64_t end_ = 0;    ///< Number of bytes up to the last that was written.
  uint64_t noted_ = 0;  ///< Number of steps.
  bool isPublished_ = false;
};

}  // namespace raymap
