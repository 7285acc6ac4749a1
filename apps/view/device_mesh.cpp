#include "device_mesh.h"

#include <cstddef>

namespace raymap::view {

namespace {

template <class T>
Buffer bufferFor(const Gpu& gpu, const std::vector<T>& values) {
  return gpu.makeBuffer(std::max<size_t>(values.size(), 1) * sizeof(T));
}

}  // namespace

DeviceMesh::DeviceMesh(const Gpu& gpu, const Content& content)
    : content_(content),
      skinner_(gpu.handles()),
      triangles_(bufferFor(gpu, content.mesh.triangles)),
      vertices_(bufferFor(gpu, content.mesh.vertices)) {
  if (!isSkinnedHere()) return;
  const AnimatedMesh& mesh = *content.animated;
  rest_ = bufferFor(gpu, mesh.rest.vertices);
  joints_ = bufferFor(gpu, mesh.joints);
  weights_ = bufferFor(gpu, mesh.weights);
  matrices_ = gpu.makeBuffer(std::max<size_t>(mesh.skeleton.size(), 1) * sizeof(JointMatrix));
}

void DeviceMesh::uploadAll(Frame& frame) {
  frame.upload(std::as_bytes(std::span(content_.mesh.triangles)), triangles_);
  if (!content_.animated) frame.upload(std::as_bytes(std::span(content_.mesh.vertices)), vertices_);
  if (!isSkinnedHere()) return;
  const AnimatedMesh& mesh = *content_.animated;
  frame.upload(std::as_bytes(std::span(mesh.rest.vertices)), rest_);
  frame.upload(std::as_bytes(std::span(mesh.joints)), joints_);
  frame.upload(std::as_bytes(std::span(mesh.weights)), weights_);
}

void DeviceMesh::record(Frame& frame, double seconds) {
  if (!isUploaded_) uploadAll(frame);
  isUploaded_ = true;
  if (!content_.animated || seconds_ == seconds) return;
  seconds_ = seconds;
  const AnimatedMesh& mesh = *content_.animated;
  if (!isSkinnedHere()) {  // The device moves joints only.
    posed(mesh, seconds, pose_);
    frame.upload(std::as_bytes(std::span(pose_.vertices)), vertices_);
    return;
  }
  const std::vector<JointMatrix> matrices = jointMatrices(mesh, seconds);
  frame.upload(std::as_bytes(std::span(matrices)), matrices_);
  skinner_.record(frame.commands(),
                  {.rest = rest_.range(),
                   .joints = mesh.joints.empty() ? vulkan::BufferRange{} : joints_.range(),
                   .weights = mesh.weights.empty() ? vulkan::BufferRange{} : weights_.range(),
                   .matrices = matrices_.range(),
                   .vertexCount = uint32_t(mesh.rest.vertices.size()),
                   .jointCount = uint32_t(mesh.skeleton.size())},
                  vertices_.range());
}

vulkan::MeshBuffers DeviceMesh::buffers() const {
  return {.vertices = vertices_.range(),
          .vertexCount = uint32_t(content_.mesh.vertices.size()),
          .triangles = triangles_.range(),
          .triangleCount = triangleCount(),
          .origin = origin()};
}

}  // namespace raymap::view
