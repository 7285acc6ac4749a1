#pragma once

#include <raymap/error.h>

#include <string>

namespace raymap {

/// Throws `Error(Usage)` unless what the caller asks for holds.
inline void require(bool holds, const char* otherwise) {
  if (!holds) throw Error(ErrorCode::Usage, otherwise);
}
inline void require(bool holds, const std::string& otherwise) {
  if (!holds) throw Error(ErrorCode::Usage, otherwise);
}

}  // namespace raymap
