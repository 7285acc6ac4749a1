#pragma once

#include <raymap/device_info.h>

#include <filesystem>
#include <optional>
#include <string>

namespace raymap {

/// Result of the last test of a device, as it is kept between processes.
struct DeviceRecord {
  DeviceTestState state = DeviceTestState::Untested;
  std::string problem = {};  ///< First difference, or the check in which the test ended.
};

/// Returns what this process remembers, or what is kept in the user's cache folder, of a device with this
/// driver, this version of raymap and these kernels. A file that is damaged or of another device is taken as
/// none.
DeviceRecord readResult(const DeviceInfo& device);
/// The same; but if a test of the device runs or has not ended, returns that.
DeviceRecord readRecord(const DeviceInfo& device);
/// Keeps the result of a test in the user's cache folder, and in this process where that cannot be written.
void writeRecord(const DeviceInfo& device, const DeviceRecord& record);

/// Mark of a test that runs, in the user's cache folder: a locked file with the name of the check. A process
/// that ends during the test leaves the file behind and unlocked. Later processes see by it that the test did
/// not end (`DeviceTestState::Unfinished`).
class TestMark {
 public:
  /// Waits up to `seconds` for a test of the same device in another process. Throws `Error(Unsupported)` if
  /// that does not end. Makes no mark where the folder cannot be written.
  TestMark(const DeviceInfo& device, double seconds);
  /// Removes the mark.
  ~TestMark();
  TestMark(const TestMark&) = delete;
  TestMark& operator=(const TestMark&) = delete;

  void write(const std::string& check) const;

 private:
  std::filesystem::path path_;
  int file_ = -1;  ///< -1: no mark.
};

}  // namespace raymap
