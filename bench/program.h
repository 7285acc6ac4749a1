#pragma once

#include <cstdio>
#include <exception>

namespace raymap::bench {

/// Runs the body of main() and reports its errors.
inline int runProgram(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace raymap::bench
