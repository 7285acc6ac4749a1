#pragma once

#include <raymap/callbacks.h>

#include <cstddef>
#include <string>

namespace raymap {

/// Device, limits and callbacks of a call. They do not define the result. Every long
/// call takes it as its last argument, and says which members it uses. The others may hold anything.
struct MachineOptions {
  /// Device that computes: `cpu`; `vulkan:K`, the Kth Vulkan device; `vulkan`, the best of them, which may be
  /// a software rasterizer; `auto`, a real GPU if one is usable, else the CPU.
  std::string device = "auto";
  int threads = 0;  ///< Number of CPU threads; 0 = `defaultThreads`.
  /// Most bytes that the call and its result may hold; 0 = what is available.
  size_t memoryLimit = 0;
  WarningCallback warn = {};       ///< Called with what is odd, but does not stop the call.
  ProgressCallback progress = {};  ///< Called every few milliseconds. It can cancel the call.
};

}  // namespace raymap
