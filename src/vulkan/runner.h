#pragma once

#include <raymap/generate.h>

#include <cstddef>
#include <memory>

namespace raymap::vulkan {

/// A device and what a generator keeps on it. Knows nothing of Vulkan's types, so that others may include it.
class Runner {
 public:
  /// `index` as in `listDevices`. Throws `Error`: Unsupported, Memory, DeviceLost.
  explicit Runner(size_t index);
  ~Runner();

  /// Fills `field` and `stats`. After an error other than Usage, Input and Cancelled it must not be used
  /// again.
  void run(const Mesh& mesh, const Grid& grid, const Options& options, Field& field, Stats& stats);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap::vulkan
