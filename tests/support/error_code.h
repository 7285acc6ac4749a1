#pragma once

#include <raymap/error.h>

namespace raymap {

/// Returns the code of the error that `work` throws, or 0 if it throws none.
template <class Work>
ErrorCode codeOf(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code();
  }
  return {};
}

}  // namespace raymap
