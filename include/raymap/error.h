#pragma once

#include <raymap/export.h>

#include <stdexcept>
#include <string>

namespace raymap {

/// Kinds of failure. The command line and raymap/c.h have numbers of their own for them.
enum class ErrorCode {
  Usage,        ///< An option or argument makes no sense.
  Input,        ///< A file or array was read, but its content is not valid.
  File,         ///< A file cannot be opened, read or written.
  Memory,       ///< The work needs more memory than allowed.
  Cancelled,    ///< A progress callback asked to stop.
  Unsupported,  ///< Valid, but beyond what this build or this machine can do.
  DeviceLost,   ///< The GPU stopped answering while it worked.
  DeviceMemory  ///< The GPU has no memory left, whatever is allowed.
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
