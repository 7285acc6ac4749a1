#pragma once

// Frames that raymap::vulkan::Generator records on the device of the tests, and the same fields from the
// backend whose results the host reads back.

#include <raymap/raymap.h>

#include <cstring>

#include "broken_meshes.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

#include <raymap/vulkan.h>

namespace raymap::vulkan {

inline Room roomFor(const Mesh& mesh, const Grid& grid, const FieldOptions& options) {
  return {.vertices = static_cast<uint32_t>(mesh.vertices.size()),
          .triangles = static_cast<uint32_t>(mesh.triangles.size()),
          .dims = grid.dims,
          .distance = options.distance,
          .sign = options.sign};
}

/// A test of a generator on the caller's device, here that of the tests. The caller's buffers lie between
/// guards.
class VulkanGenerator : public VulkanTest {
 protected:
  /// A mesh in buffers of the caller's.
  struct Uploaded {
    explicit Uploaded(const Mesh& mesh)
        : vertices(upload(mesh.vertices, "vertices")), triangles(upload(mesh.triangles, "triangles")) {
      buffers = {.vertices = {vertices.handle(), vertices.offset()},
                 .vertexCount = static_cast<uint32_t>(mesh.vertices.size()),
                 .triangles = {triangles.handle(), triangles.offset()},
                 .triangleCount = static_cast<uint32_t>(mesh.triangles.size()),
                 .origin = mesh.origin};
    }
    DeviceBuffer vertices, triangles;
    MeshBuffers buffers;
  };

  /// All results that a target may hold, in buffers of the caller's.
  struct Outputs {
    explicit Outputs(size_t samples) {
      for (DeviceBuffer* buffer : {&distance, &triangle, &winding, &confidence})
        buffer->resize<float>(samples);
      status.resize<std::byte>(statusBytes());
    }
    static BufferRange range(const DeviceBuffer& buffer) { return {buffer.handle(), buffer.offset()}; }
    Target target(const FieldOptions& options) const {
      Target target{.distance = range(distance), .status = range(status)};
      if (options.triangle) target.triangle = range(triangle);
      if (options.winding) target.winding = range(winding);
      if (options.confidence) target.confidence = range(confidence);
      return target;
    }
    std::vector<std::byte> written() const { return download<std::byte>(status); }
    DeviceBuffer distance{device(), "distance"}, triangle{device(), "triangle"}, winding{device(), "winding"},
        confidence{device(), "confidence"}, status{device(), "status"};
  };

  /// Makes the field by the backend whose results the host reads back.
  static Field hostField(const Mesh& mesh, const Grid& grid, FieldOptions options) {
    options.orientation = Orientation::Keep;  // As frames do.
    return makeField(kept<Backend>(), mesh, grid, options).field;
  }

  /// Kept from test to test, because making its kernels takes longer than most tests.
  static Generator& generator() {
    shared();
    static Generator generator(device().handles());
    return generator;
  }

  static std::vector<float> distances(const Mesh& mesh, const Grid& grid, const FieldOptions& options) {
    const Uploaded uploaded(mesh);
    const Outputs outputs(grid.sampleCount());
    run([&](Commands& commands) {
      generator().record(commands.handle(), uploaded.buffers, grid, options,
                         {.distance = Outputs::range(outputs.distance)});
    });
    return download<float>(outputs.distance);
  }

  template <class T>
  static void expectSameBits(const std::vector<T>& ours, const Buffer<T>& theirs, const char* what) {
    ASSERT_EQ(ours.size(), theirs.size()) << what;
    EXPECT_EQ(0, std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof(T))) << what;
  }

  /// Records a frame twice and compares all results with those that the host reads back.
  static void expectAsOnTheHostsWay(const Mesh& mesh, const Grid& grid, const FieldOptions& options,
                                    double outside = 0.0) {
    SCOPED_TRACE(::testing::Message()
                 << "distance " << int(options.distance) << " sign " << int(options.sign));
    const Field expected = hostField(mesh, grid, options);
    const Uploaded uploaded(mesh);
    const Outputs outputs(grid.sampleCount());
    Room room = roomFor(mesh, grid, options);
    room.outside = outside;
    generator().reserve(room);
    for (int round = 0; round < 2; ++round) {
      run([&](Commands& commands) {
        generator().record(commands.handle(), uploaded.buffers, grid, options, outputs.target(options));
      });
      const Status status = generator().status(outputs.written());
      EXPECT_FALSE(status.error) << status.error->what();
      EXPECT_EQ(generator().status().lists.entries, status.lists.entries);
      expectSameBits(download<float>(outputs.distance), expected.distance, "distance");
      if (options.triangle)
        expectSameBits(download<uint32_t>(outputs.triangle), expected.triangle, "triangle");
      if (options.winding) expectSameBits(download<float>(outputs.winding), expected.winding, "winding");
      if (options.confidence)
        expectSameBits(download<float>(outputs.confidence), expected.confidence, "confidence");
    }
  }

  static FieldOptions everything(DistanceMode distance, SignMode sign) {
    FieldOptions options{.distance = distance, .sign = sign};
    options.triangle = distance != DistanceMode::Raster;
    options.winding = options.confidence = sign != SignMode::None;
    return options;
  }
};

}  // namespace raymap::vulkan
