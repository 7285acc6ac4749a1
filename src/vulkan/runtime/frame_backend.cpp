#include "vulkan/runtime/frame_backend.h"

#include <cstring>

namespace raymap::vulkan {

FrameBackend::FrameBackend(Device& device)
    : StageRecorder(device), image_(device), findings_(device, "findings for the host", MemoryUse::ReadBack) {
  findings_.resize<Findings>(1);
}

void FrameBackend::reserve(const Room& room) {
  Extent extent{.vertices = room.vertices,
                .triangles = room.triangles,
                .dims = room.dims,
                .distance = room.distance,
                .sign = room.sign,
                .lattices = coverBounds(glm::vec3(-0.5 - room.outside),
                                        glm::vec3(glm::dvec3(room.dims) - 0.5 + room.outside), room.dims),
                .outside = room.outside};
  extent.lists.fill(room.lists);
  StageRecorder::reserve(extent);
  image_.reserve(room.dims, room.image);
  findings_.mapped<Findings>().front() = {};
}

void FrameBackend::take(const Frame& frame, const Grid& grid, const FieldOptions& options) {
  frame_ = frame;
  Results results = frame.results;
  if (results.distance == 0) results.distance = image_.distance();
  start(frame.commands, grid, options);
  setResults(results);
}

void FrameBackend::begin() {
  waitForAll(frame_->commands.handle());
  recordMesh(frame_->mesh);
}

void FrameBackend::finish() {
  recordFinish();
  if (frame_->image) image_.record(commands(), frame_->image, frame_->imageLayout);
  recordFindings(findings_.handle(), findings_.offset());
  if (frame_->status.buffer) recordFindings(frame_->status.buffer, frame_->status.offset);
  showAll(frame_->commands.handle());
}

}  // namespace raymap::vulkan
