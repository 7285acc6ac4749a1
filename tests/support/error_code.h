#pragma once

#include <raymap/error.h>

#include <optional>
#include <string>

namespace raymap {

/// Returns the code of the error that `work` throws; none if it throws none.
template <class Work>
std::optional<ErrorCode> codeOf(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code();
  }
  return std::nullopt;
}

/// Returns the message of the error of this code that `work` throws; another text if it throws none.
inline std::string messageOf(ErrorCode code, auto&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code() == code ? error.what() : "another error";
  }
  return "no error";
}

inline std::string usageMessage(auto&& work) {
  return messageOf(ErrorCode::Usage, work);
}

/// Returns the exit code of the command line for an error, as docs/cli.md promises it.
constexpr int exitCode(ErrorCode code) {
  switch (code) {
    case ErrorCode::Usage:
      return 2;
    case ErrorCode::Input:
      return 3;
    case ErrorCode::File:
      return 4;
    case ErrorCode::Memory:
      return 5;
    case ErrorCode::Cancelled:
      return 6;
    case ErrorCode::Unsupported:
      return 7;
    case ErrorCode::DeviceLost:
      return 8;
    case ErrorCode::DeviceMemory:
      return 10;
  }
  return 1;
}

}  // namespace raymap
