#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace raymap {

/// A child process whose standard output is read. The destructor kills it.
class ChildProcess {
 public:
  /// Starts the program. Throws `Error(File)` if that fails. Reading stops `seconds` after the start.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments, int seconds);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Reads up to `bytes` bytes, fewer if the output ends or the time is up. Returns the number of bytes read.
  size_t read(void* data, size_t bytes);
  /// Waits for the process to end, or kills it when its time is up. Returns the reason if it failed, else an
  /// empty text.
  std::string failure();

 private:
  /// Returns false once the time is up.
  bool waitForOutput() const;
  void reap(bool kill);

  pid_t pid_ = -1;
  int output_ = -1;
  int status_ = 0;
  std::chrono::steady_clock::time_point deadline_;
};

}  // namespace raymap
