#include "vulkan/runtime/frame_backend.h"

#include <bit>

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
  extent.castsRaysFirst =
      room.sign != SignMode::None && areFewSamples(CellLattice{room.dims}.count(), room.distance);
  extent.lists.fill(room.lists);
  StageRecorder::reserve(extent);
  image_.reserve(room.dims, room.image);
  findings_.mapped<Findings>().front() = {};
}

void FrameBackend::setFrame(const Frame& frame, const Grid& grid, const FieldOptions& options) {
  frame_ = frame;
  Results results = frame.results;
  if (results.distance == 0) results.distance = image_.distance();
  start(frame.commands, grid, options);
  setResults(results);
}

void FrameBackend::recordFar(Commands commands, const Target& target, float distance) {
  const auto fill = [&](const BufferRange& range, uint32_t value) {
    if (range.buffer) commands.fill(range.buffer, range.offset, sampleCount() * sizeof value, value);
  };
  waitForAll(commands.handle());
  fill(target.distance, std::bit_cast<uint32_t>(distance));
  fill(target.triangle, kNoTriangle);
  fill(target.winding, std::bit_cast<uint32_t>(0.0f));
  fill(target.confidence, std::bit_cast<uint32_t>(1.0f));
  if (target.image) {
    commands.fill(image_.buffer(), std::bit_cast<uint32_t>(distance));
    image_.record(commands, target.image, target.imageLayout);
  }
  commands.fill(findings_, 0);
  if (target.status.buffer) commands.fill(target.status.buffer, target.status.offset, sizeof(Findings), 0);
  showAll(commands.handle());
}

void FrameBackend::begin() {
  waitForAll(frame_->commands.handle());
  recordMesh(frame_->mesh);
}

void FrameBackend::finish() {
  recordFinish();
  if (frame_->image) image_.record(commands(), frame_->image, frame_->imageLayout);
  recordFindings({{findings_.handle(), findings_.offset()}, frame_->status});
  showAll(frame_->commands.handle());
}

}  // namespace raymap::vulkan
