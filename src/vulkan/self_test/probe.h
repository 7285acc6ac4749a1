#pragma once

#include <algorithm>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include "method/cell_mesh.h"
#include "vulkan/device/command_buffer.h"
#include "vulkan/self_test/difference.h"
#include "vulkan/stages/device_mesh.h"

namespace raymap::vulkan {

/// A mesh in cell units on the device.
struct UploadedMesh {
  DeviceBuffer vertices;
  DeviceBuffer triangles;

  DeviceMesh addresses() const {
    return {.vertices = vertices.address(),
            .triangles = triangles.address(),
            .vertexCount = static_cast<uint32_t>(vertices.bytes() / sizeof(glm::vec3)),
            .triangleCount = static_cast<uint32_t>(triangles.bytes() / sizeof(glm::uvec3))};
  }
};

/// Runs single stages on a device, with input from the host and results back to it.
class Probe {
 public:
  explicit Probe(Device& device) : device_(&device) {}

  Device& device() const { return *device_; }

  template <std::ranges::contiguous_range Values>
  DeviceBuffer upload(const Values& values, const std::string& name = "test") const {
    DeviceBuffer staging(*device_, name + " upload", MemoryUse::Upload);
    staging.fill(values);
    DeviceBuffer buffer = room<std::ranges::range_value_t<Values>>(std::ranges::size(values), name);
    run([&](Commands& commands) { commands.copy(staging, buffer, buffer.bytes()); });
    return buffer;
  }

  template <class T>
  DeviceBuffer room(size_t count, const std::string& name) const {
    DeviceBuffer buffer(*device_, name);
    buffer.resize<T>(count);
    return buffer;
  }

  UploadedMesh upload(const CellMesh& mesh) const {
    return {upload(mesh.vertices, "vertices"), upload(mesh.triangles, "triangles")};
  }

  template <class T>
  std::vector<T> download(const DeviceBuffer& buffer) const {
    DeviceBuffer staging(*device_, "download", MemoryUse::ReadBack);
    staging.resize<T>(buffer.bytes() / sizeof(T));
    run([&](Commands& commands) { commands.copy(buffer, staging, buffer.bytes()); });
    const std::span<T> values = staging.mapped<T>();
    return {values.begin(), values.end()};
  }

  /// Runs what `record` records. Throws a `Difference` if it damaged a guard.
  template <class Record>
  void run(Record&& record) const {
    CommandBuffer buffer(*device_);
    Commands commands = buffer.begin();
    record(commands);
    buffer.submitAndWait();
    if (const Guards* guards = device_->guards()) {
      const std::string damaged = guards->damaged();
      require(damaged.empty(), damaged);
    }
  }

 private:
  Device* device_;
};

}  // namespace raymap::vulkan
