#pragma once

#include <functional>
#include <string_view>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Checks of the validation layer to run.
enum class Validation {
  Off,
  On,
  Sync,  ///< Also hazards between commands.
  Gpu    ///< Also accesses out of bounds, by code added to the shaders; not hazards between commands.
};

/// Reads the environment variable RAYMAP_VULKAN_VALIDATION: 1, sync or gpu; else Off.
Validation validationFromEnvironment();

/// Receives the validation layer's warnings and errors. Called from any thread that calls Vulkan.
using MessageCallback = std::function<void(std::string_view message)>;

/// Instance of our own, with the validation layer if requested. Neither copied nor moved: the layer keeps the
/// callback's address.
class Instance {
 public:
  /// Throws `Error(Unsupported)` if there is no loader, no driver, or not the requested layer.
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

/// Returns the instance of the whole process, without validation. The first call that succeeds makes it. It
/// is never destroyed, because drivers may unload before us at the program's end. Throws as the constructor
/// does.
const Instance& sharedInstance();

/// Returns a function of an extension; null if the instance lacks the extension.
template <class Function>
Function extensionFunction(VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

}  // namespace raymap::vulkan
