#include "vulkan/device/buffer.h"

#include <raymap/error.h>

#include <tuple>

#include "base/memory.h"
#include "vulkan/device/scratch_memory.h"

namespace raymap::vulkan {

namespace {

constexpr VkBufferUsageFlags kUsage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
    VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

/// `most` says what there is at most: "only 5 MiB is available". `remedy` says what helps, too.
[[noreturn]] void throwTooLarge(const std::string& name, uint64_t bytes, const std::string& most,
                                const std::string& remedy = "another device",
                                ErrorCode code = ErrorCode::Memory) {
  throw Error(code, "the device's buffer '" + name + "' needs " + neededText(bytes) + ", but " + most +
                        "; use a lower resolution or " + remedy);
}

}  // namespace

VkBuffer DeviceBuffer::handle() const {
  return scratch_ ? scratch_->at(place_).handle() : buffer_.get();
}

VkDeviceSize DeviceBuffer::offset() const {
  return scratch_ ? scratch_->at(place_).offset() : offset_;
}

VkDeviceAddress DeviceBuffer::address() const {
  return scratch_ && size_ > 0 ? scratch_->at(place_).address() : address_;
}

void DeviceBuffer::release() {
  if (!buffer_) return;
  if (device_->guards()) device_->guards()->forget(buffer_.get());
  device_->changeHeldMemory(-static_cast<int64_t>(heldMemory_));
  buffer_ = {};
  memory_ = {};
  mapped_ = nullptr;
  size_ = capacity_ = heldMemory_ = offset_ = address_ = 0;
}

void DeviceBuffer::resizeBytes(uint64_t bytes) {
  if (scratch_) {
    place_ = scratch_->reserveNext(bytes);
    size_ = bytes;
    return;
  }
  if (bytes > capacity_) {
    release();
    try {
      allocate(bytes);
    } catch (...) {
      release();
      throw;
    }
  }
  size_ = bytes;
  if (Guards* guards = device_->guards(); guards && buffer_)
    guards->watch(buffer_.get(), {name_, mapped_ - offset_, size_, capacity_ + 2 * Guards::kBytes});
}

void DeviceBuffer::allocate(uint64_t bytes) {
  const DeviceLimits& limits = device_->limits();
  const uint64_t guardBytes = device_->guards() ? 2 * Guards::kBytes : 0;
  if (bytes > limits.bufferSize - guardBytes)
    throwTooLarge(name_, bytes, "one buffer can have at most " + limitText(limits.bufferSize - guardBytes));
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                .size = bytes + guardBytes,
                                .usage = kUsage,
                                .sharingMode = VK_SHARING_MODE_EXCLUSIVE};
  create(buffer_, device_->handle(), vkCreateBuffer, info, "making the buffer " + name_);
  device_->setName(VK_OBJECT_TYPE_BUFFER, handle(), name_);
  const uint32_t type = allocateMemory();
  capacity_ = bytes;
  offset_ = guardBytes / 2;
  if (use_ != MemoryUse::Device || device_->guards() || device_->isShared(type)) {
    void* mapped = nullptr;
    check(vkMapMemory(device_->handle(), memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped),
          "mapping the buffer " + name_);
    mapped_ = static_cast<std::byte*>(mapped) + offset_;
  }
  const VkBufferDeviceAddressInfo at{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                     .buffer = handle()};
  address_ = vkGetBufferDeviceAddress(device_->handle(), &at) + offset_;
}

uint32_t DeviceBuffer::allocateMemory() {
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_->handle(), handle(), &needs);
  const uint32_t type = device_->memoryType(use_, needs.memoryTypeBits);
  if (const uint64_t left = device_->memoryLeft(); needs.size > left)
    throwTooLarge(name_, needs.size, "only " + limitText(left) + " of the limit is left", "a higher limit");
  const uint64_t available = device_->availableMemory(type);
  if (needs.size > available)
    throwTooLarge(name_, needs.size, "only " + limitText(available) + " is available", "another device",
                  ErrorCode::DeviceMemory);
  const VkMemoryAllocateFlagsInfo flags{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                        .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .pNext = &flags,
                                  .allocationSize = needs.size,
                                  .memoryTypeIndex = type};
  create(memory_, device_->handle(), vkAllocateMemory, info, "allocating the buffer " + name_);
  heldMemory_ = needs.size;
  device_->changeHeldMemory(static_cast<int64_t>(heldMemory_));
  check(vkBindBufferMemory(device_->handle(), handle(), memory_.get(), 0), "binding the buffer " + name_);
  return type;
}

void DeviceBuffer::swap(DeviceBuffer& other) noexcept {
  const auto members = [](DeviceBuffer& b) {
    return std::tie(b.device_, b.name_, b.use_, b.scratch_, b.size_, b.capacity_, b.heldMemory_, b.offset_,
                    b.place_, b.address_, b.mapped_, b.memory_, b.buffer_);
  };
  auto ours = members(*this), theirs = members(other);
  ours.swap(theirs);
}

}  // namespace raymap::vulkan
