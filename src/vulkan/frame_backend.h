#pragma once

#include "field_image.h"
#include "stage_recorder.h"

namespace raymap {
class Progress;
}

namespace raymap::vulkan {

/// The pipeline from a mesh on the device to its field there, recorded into anybody's command buffer.
class FrameBackend : public StageRecorder {
 public:
  struct Frame {
    Commands commands;
    CellMesh::Source mesh;
    Results results;  ///< Without a distance, an image's.
    VkImage image = VK_NULL_HANDLE;
    VkImageLayout imageLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    BufferRange status;
  };

  explicit FrameBackend(Device& device);

  /// Nothing recorded before may still have to run.
  void reserve(const Room& room);
  /// What the next run of the pipeline is to record.
  void setFrame(const Frame& frame) { frame_ = frame; }

  /// The mesh and field of the host's are not looked at: the frame has them.
  void begin(const Mesh&, const Grid& grid, const Options& options, Progress&, Field&);
  /// Frames never come back to the host, which would have to lay the surface.
  void closeHoles() {
    throw Error(ErrorCode::Unsupported, "holes of a mesh that only the device sees cannot be closed");
  }
  void finish();

  /// Of the last frame that ran, or that `findings` are of.
  Status status() const { return describe(findings_.mapped<Findings>().front()); }
  Status status(const Findings& findings) const { return describe(findings); }

 private:
  std::optional<Frame> frame_;
  FieldImage image_;
  DeviceBuffer findings_;
};

}  // namespace raymap::vulkan
