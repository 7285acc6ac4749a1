#pragma once

#include <functional>
#include <string_view>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Which checks of the validation layer to run.
enum class Validation {
  Off,
  On,
  Sync,  ///< And hazards between commands.
  Gpu    ///< And accesses out of bounds, by code added to the shaders; without those between commands.
};

/// What the environment variable RAYMAP_VULKAN_VALIDATION asks for: 1, sync or gpu; else Off.
Validation validationFromEnvironment();

/// Gets the validation layer's warnings and errors; called from any thread that calls Vulkan.
using MessageCallback = std::function<void(std::string_view message)>;

/// An instance of our own, with the validation layer if asked for. Neither copied nor moved: the layer keeps
/// the address of the callback.
class Instance {
 public:
  /// Throws `Error(Unsupported)` if there is no loader, no driver, or not the layer asked for.
  explicit Instance(Validation validation = Validation::Off, MessageCallback message = nullptr);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  VkInstance handle() const { return instance_; }

 private:
  void listen();

  MessageCallback message_;
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

/// The instance of the whole process, without validation. Made by the first call that succeeds and never
/// destroyed: at the program's end drivers may be gone before us. Throws as the constructor does.
const Instance& sharedInstance();

/// A function of an extension, or null where the instance was made without it.
template <class Function>
Function extensionFunction(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

}  // namespace raymap::vulkan
