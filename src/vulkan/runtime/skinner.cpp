#include "base/require.h"
#include "vulkan/device/buffer_range.h"
#include "vulkan/stages/skin.h"

#include <raymap/vulkan.h>

namespace raymap::vulkan {

struct Skinner::Impl {
  explicit Impl(const DeviceHandles& handles) : device(handles), skin(device) {}
  Device device;
  SkinStage skin;
};

Skinner::Skinner(const DeviceHandles& device) : impl_(std::make_unique<Impl>(device)) {}
Skinner::~Skinner() = default;
Skinner::Skinner(Skinner&&) noexcept = default;
Skinner& Skinner::operator=(Skinner&&) noexcept = default;

void Skinner::record(VkCommandBuffer commands, const SkinBuffers& skin, const BufferRange& vertices) {
  require(commands != VK_NULL_HANDLE, "no command buffer is given");
  if (!skin.rest.buffer || !skin.matrices.buffer || !vertices.buffer)
    throw Error(ErrorCode::Usage, "a skin needs buffers of rest vertices, matrices and moved vertices");
  if (!skin.joints.buffer != !skin.weights.buffer)
    throw Error(ErrorCode::Usage, "a skin needs joints and weights, or neither");
  const auto address = [&](const BufferRange& range, const char* name, VkDeviceSize alignment) {
    return addressOf(notMoved(impl_).device.handle(), range, name, alignment);
  };
  const SkinStage::Input input{.rest = address(skin.rest, "the rest vertices of a skin", 4),
                               .joints = address(skin.joints, "the joints of a skin", 4),
                               .weights = address(skin.weights, "the weights of a skin", 16),
                               .matrices = address(skin.matrices, "the matrices of a skin", 16),
                               .vertexCount = skin.vertexCount,
                               .jointCount = skin.jointCount};
  const VkDeviceAddress moved = address(vertices, "the moved vertices of a skin", 4);
  Commands work(commands, notMoved(impl_).device.pipelineLayout(), nullptr);
  waitForAll(commands);
  notMoved(impl_).skin.record(work, input, moved);
  showAll(commands);
}

}  // namespace raymap::vulkan
