#pragma once

#include <optional>
#include <vector>

#include "vulkan/device/handle.h"
#include "vulkan/device/pipeline_cache_file.h"
#include "vulkan/device/shader.h"

namespace raymap::vulkan {

class Device;

/// Shader and constants of a compute pipeline.
struct PipelineSource {
  Shader shader;
  std::vector<uint32_t> constants;  ///< Specialization constants from 0 on.
  bool hasFullSubgroups = false;    ///< Whether all subgroups must be full.

  bool operator==(const PipelineSource& other) const;
};

/// Compute pipelines of a device. Equal ones are made once. They live as long as this object.
class Pipelines {
 public:
  /// `device` must outlive this object. With a cache file, starts from what the driver compiled in earlier
  /// runs, and stores what it compiles.
  Pipelines(const Device& device, const std::optional<PipelineCacheFile>& file);
  ~Pipelines();
  Pipelines(const Pipelines&) = delete;
  Pipelines& operator=(const Pipelines&) = delete;

  /// Adds a pipeline that may be needed. Returns its number.
  size_t add(PipelineSource source);
  /// Returns a pipeline by its number. If it is not made yet, makes all that are not, on all threads: drivers
  /// take up to a tenth of a second for each. Throws if the driver cannot make this one.
  VkPipeline at(size_t number);

 private:
  struct Entry {
    PipelineSource source;
    Pipeline pipeline;
  };

  void makeMissing();
  Pipeline make(const PipelineSource& source) const;
  void save() const;

  const Device& device_;
  std::optional<PipelineCacheFile> file_;
  PipelineCache cache_;
  std::vector<Entry> entries_;
  bool hasMade_ = false;
};

}  // namespace raymap::vulkan
