#pragma once

#include <cstdint>

namespace raymap {

/// Resources that a confined process may use.
struct Confinement {
  uint64_t memoryBytes = 0;  ///< Beyond what it has now, for its code and libraries.
  uint64_t seconds = 0;      ///< CPU time since the process started.
  bool canOpen = false;      ///< Whether it may open the file again for reading.
};

/// Confines this process for good, before it looks into a file from anywhere. From now on it can read open
/// files, among them `file`, write to open pipes, compute and end. It can open no file, or if it must, only
/// `file` where the kernel has Landlock, and any for reading where it has not. It can neither start threads
/// or processes, nor signal others, nor use the network. What the kernel or the machine's type lacks is left
/// out; the limits of memory, time and files hold everywhere.
void confine(int file, const Confinement& limits);

}  // namespace raymap
