#pragma once

#include <raymap/error.h>

#include <cstdint>
#include <memory>
#include <string>

namespace raymap {

/// Throws `Error(Usage)` unless what the caller asks for holds.
inline void require(bool holds, const char* otherwise) {
  if (!holds) throw Error(ErrorCode::Usage, otherwise);
}
inline void require(bool holds, const std::string& otherwise) {
  if (!holds) throw Error(ErrorCode::Usage, otherwise);
}

/// Throws `Error(Usage)` unless an enumerator is one of those from 0 to `last`.
template <class Enum>
void requireKnown(Enum value, Enum last, const char* kind) {
  const auto number = static_cast<int64_t>(value);
  require(number >= 0 && number <= static_cast<int64_t>(last),
          std::string("there is no ") + kind + " with the value " + std::to_string(number));
}

/// Returns what an object holds. Throws `Error(Usage)` if it was moved from.
template <class Impl>
Impl& notMoved(const std::unique_ptr<Impl>& impl) {
  require(impl != nullptr, "this object was moved from; assign another to it, or use that other one");
  return *impl;
}

}  // namespace raymap
