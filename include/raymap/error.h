#pragma once

#include <raymap/export.h>

#include <stdexcept>
#include <string>

namespace raymap {

/// Kinds of failure. The command line exits with the value of the code, and with 9 if a GPU failed its test;
/// raymap/c.h returns it.
enum class ErrorCode {
  Usage = 2,         ///< An option or argument makes no sense.
  Input = 3,         ///< A file or array was read, but its content is not valid.
  File = 4,          ///< A file cannot be opened, read or written.
  Memory = 5,        ///< The work needs more memory than allowed.
  Cancelled = 6,     ///< A progress callback asked to stop.
  Unsupported = 7,   ///< Valid, but beyond what this build or this machine can do.
  DeviceLost = 8,    ///< The GPU stopped answering while it worked.
  DeviceMemory = 10  ///< The GPU has no memory left, whatever is allowed.
};

/// The one exception type of the library. `what()` says what is wrong, where, and what to do.
class RAYMAP_API_EXCEPTION Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace raymap
