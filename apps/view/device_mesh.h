#pragma once

#include <raymap/vulkan.h>

#include "content.h"
#include "frame.h"

namespace raymap::view {

/// A mesh on the device, in the pose of a time.
class DeviceMesh {
 public:
  DeviceMesh(const Gpu& gpu, const Content& content);

  /// Records the commands that move its vertices to the pose of a time. The first call uploads the mesh.
  void record(Frame& frame, double seconds);

  vulkan::MeshBuffers buffers() const;
  const Buffer& vertices() const { return vertices_; }
  const Buffer& triangles() const { return triangles_; }
  uint32_t triangleCount() const { return uint32_t(content_.mesh.triangles.size()); }
  const glm::dvec3& origin() const {
    return content_.animated ? content_.animated->origin : content_.mesh.origin;
  }

 private:
  bool isSkinnedHere() const { return content_.animated && content_.animated->morphs.empty(); }
  void uploadAll(Frame& frame);

  const Content& content_;
  vulkan::Skinner skinner_;
  Buffer triangles_, vertices_, rest_, joints_, weights_, matrices_;
  bool isUploaded_ = false;
  double seconds_ = -1.0;  ///< Time of the pose that the vertices have.
  Mesh pose_;
};

}  // namespace raymap::view
