#include "vulkan/device/instance.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace raymap::vulkan {

namespace {

constexpr const char* kLayer = "VK_LAYER_KHRONOS_validation";

void requireLayer() {
  uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "listing Vulkan's layers");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "listing Vulkan's layers");
  if (std::none_of(layers.begin(), layers.end(),
                   [](const VkLayerProperties& layer) { return std::strcmp(layer.layerName, kLayer) == 0; }))
    throw Error(ErrorCode::Unsupported,
                "the requested validation layer is not installed; install vulkan-validationlayers");
}

VKAPI_ATTR VkBool32 VKAPI_CALL passMessage(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                           VkDebugUtilsMessageTypeFlagsEXT,
                                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* callback) {
  const auto& message = *static_cast<const MessageCallback*>(callback);
  if (message) message(std::string(data->pMessageIdName ? data->pMessageIdName : "") + ": " + data->pMessage);
  return VK_FALSE;
}

bool hasExtension(const char* name) {
  uint32_t count = 0;
  check(vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr), "listing Vulkan's extensions");
  std::vector<VkExtensionProperties> found(count);
  check(vkEnumerateInstanceExtensionProperties(nullptr, &count, found.data()), "listing Vulkan's extensions");
  return std::any_of(found.begin(), found.end(), [name](const VkExtensionProperties& extension) {
    return std::strcmp(extension.extensionName, name) == 0;
  });
}

/// Returns whether the loader lists drivers that are not all of Vulkan, such as MoltenVK, only if it is asked
/// to.
bool hidesPortabilityDrivers() {
  return hasExtension(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
}

VKAPI_ATTR VkBool32 VKAPI_CALL keepFirst(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                         VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* kept) {
  auto& first = *static_cast<std::string*>(kept);
  if (first.empty() && !std::strstr(data->pMessage, "Found no drivers")) first = data->pMessage;
  return VK_FALSE;
}

/// Starts Vulkan once more, and returns what the loader has against the first driver; empty if there is none.
/// A driver of a container often lacks another library.
std::string reasonAgainstDriver() {
  if (!hasExtension(VK_EXT_DEBUG_UTILS_EXTENSION_NAME)) return {};
  std::string reason;
  const VkDebugUtilsMessengerCreateInfoEXT listener{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
      .pfnUserCallback = keepFirst,
      .pUserData = &reason};
  const char* const extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = &listener,
                                  .enabledExtensionCount = 1,
                                  .ppEnabledExtensionNames = &extension};
  VkInstance instance = VK_NULL_HANDLE;
  if (vkCreateInstance(&info, nullptr, &instance) == VK_SUCCESS)
    extensionFunction<PFN_vkDestroyInstance>(instance, "vkDestroyInstance")(instance, nullptr);
  return reason;
}

[[noreturn]] void throwNoDriver() {
  const std::string reason = reasonAgainstDriver();
  throw Error(ErrorCode::Unsupported,
              "there is no Vulkan driver that starts; install the GPU's, or mesa-vulkan-drivers for one in "
              "software" +
                  (reason.empty() ? "" : "; Vulkan's loader says: " + reason));
}

VkResult createInstance(Validation validation, VkInstance* instance) {
  const VkApplicationInfo application{
      .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pEngineName = "raymap", .apiVersion = VK_API_VERSION_1_3};
  const VkValidationFeatureEnableEXT extra =
      validation == Validation::Gpu ? VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT
                                    : VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT features{
      .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
      .enabledValidationFeatureCount = validation == Validation::On ? 0U : 1U,
      .pEnabledValidationFeatures = &extra};
  std::vector<const char*> extensions;
  VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                            .pApplicationInfo = &application};
  if (hidesPortabilityDrivers()) {
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    info.flags = VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  }
  if (validation != Validation::Off) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kLayer;
    extensions.insert(extensions.end(),
                      {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME});
  }
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  return vkCreateInstance(&info, nullptr, instance);
}

}  // namespace

Validation validationFromEnvironment() {
  const char* value = std::getenv("RAYMAP_VULKAN_VALIDATION");
  const std::string_view asked = value ? value : "";
  if (asked == "sync") return Validation::Sync;
  if (asked == "gpu") return Validation::Gpu;
  return asked == "1" ? Validation::On : Validation::Off;
}

const Instance& sharedInstance() {
  static const auto* const instance = new Instance();
  return *instance;
}

Instance::Instance(Validation validation, MessageCallback message) : message_(std::move(message)) {
  openLoader();
  if (validation != Validation::Off) requireLayer();
  const VkResult result = createInstance(validation, &instance_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throwNoDriver();
  check(result, "starting Vulkan");
  loadFunctions(instance_);
  if (validation != Validation::Off) listen();
}

void Instance::listen() {
  const VkDebugUtilsMessengerCreateInfoEXT info{
      .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
      .messageSeverity =
          VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
      .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
      .pfnUserCallback = passMessage,
      .pUserData = &message_};
  const auto create =
      extensionFunction<PFN_vkCreateDebugUtilsMessengerEXT>(instance_, "vkCreateDebugUtilsMessengerEXT");
  check(create(instance_, &info, nullptr, &messenger_), "listening to the validation layer");
}

Instance::~Instance() {
  if (messenger_)
    extensionFunction<PFN_vkDestroyDebugUtilsMessengerEXT>(instance_, "vkDestroyDebugUtilsMessengerEXT")(
        instance_, messenger_, nullptr);
  vkDestroyInstance(instance_, nullptr);
}

}  // namespace raymap::vulkan
