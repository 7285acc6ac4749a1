#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace raymap {

/// A running program whose standard output we read. It is ended when this object goes.
class ChildProcess {
 public:
  /// Throws `Error(File)` if it cannot be started. `seconds`: after these, reading gives up.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, int seconds);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads up to `bytes`; fewer if the output ends or the time is up.
  size_t read(void* data, size_t bytes);
  /// Waits for the end (or ends it, if its time is up) and says how it went wrong; empty if it did not.
  std::string failure();

 private:
  /// False once the time is up.
  bool waitForOutput() const;
  void reap(bool kill);

  pid_t pid_ = -1;
  int output_ = -1;
  int status_ = 0;
  std::chrono::steady_clock::time_point deadline_;
};

}  // namespace raymap
