#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace raymap::vulkan {

/// A kernel as the product specialised it, and the driver's statistics of the compiled code.
struct CompiledKernel {
  std::string name;                 ///< Stem of the shader's file.
  std::vector<uint32_t> constants;  ///< Specialization constants: group size first.
  uint32_t subgroupSize = 0;        ///< Invocations per subgroup that the driver chose.
  bool hasFullSubgroups = false;
  std::map<std::string, double> statistics;  ///< By the driver's names.
};

/// Adds the statistics extension to devices, and collects the statistics of every kernel that is made.
/// Construct it before the device, once per process. Kernels may be made on several threads.
/// `subgroupSize` forces the size of their subgroups; 0 leaves it to the driver.
class KernelStatistics {
 public:
  explicit KernelStatistics(uint32_t subgroupSize = 0);
  ~KernelStatistics();
  KernelStatistics(const KernelStatistics&) = delete;
  KernelStatistics& operator=(const KernelStatistics&) = delete;

  /// Returns all kernels made so far, each once, by name and constants.
  std::vector<CompiledKernel> kernels() const;

 private:
  struct Entries;
  Entries* entries_;
};

}  // namespace raymap::vulkan
