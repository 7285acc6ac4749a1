#include "vulkan/device/instance.h"

#include <filesystem>
#include <fstream>
#include <string>

#include "environment.h"
#include "files.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

constexpr const char* kNoLayer = "needs the validation layer, but RAYMAP_VULKAN_VALIDATION is off";

class VulkanInstance : public VulkanTest {
 protected:
  /// Returns the messages of the validation layer since the test began, which then do not fail it.
  static std::string takeMessages() {
    const std::lock_guard lock(shared().mutex);
    std::string all;
    for (const std::string& message : shared().messages) all += message + "\n";
    shared().messages.clear();
    return all;
  }
};

TEST_F(VulkanInstance, ReportsMessagesOfTheValidationLayer) {
  if (!isValidated()) GTEST_SKIP() << kNoLayer;
  const VkBufferCreateInfo empty{
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 0, .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
  BufferHandle buffer;
  try {
    create(buffer, device().handle(), vkCreateBuffer, empty, "making an empty buffer");
  } catch (const Error&) {  // The driver may fail or not.
  }
  EXPECT_NE(takeMessages().find("VUID-VkBufferCreateInfo-size"), std::string::npos);
}

TEST_F(VulkanInstance, ReportsHazards) {
  if (!isValidated()) GTEST_SKIP() << kNoLayer;
  if (validationFromEnvironment() != Validation::Off && validationFromEnvironment() != Validation::Sync)
    GTEST_SKIP() << "looks for other mistakes";
  const DeviceBuffer buffer = upload(std::vector<uint32_t>(1000));
  run([&](Commands& commands) {
    commands.fill(buffer, 1);
    commands.fill(buffer, 2);
  });
  EXPECT_EQ(takeMessages(), "");
  run([&](Commands& commands) {
    commands.concurrent([&] {
      commands.fill(buffer, 1);
      commands.fill(buffer, 2);
    });
  });
  EXPECT_NE(takeMessages().find("SYNC-HAZARD-WRITE-AFTER-WRITE"), std::string::npos);
}

/// Writes copies of the installed drivers' manifests that name each driver as one of a subset of Vulkan.
/// Returns their paths, separated by colons.
std::string portabilityManifests(const std::filesystem::path& folder) {
  const std::filesystem::path installed = "/usr/share/vulkan/icd.d";
  if (!std::filesystem::exists(installed)) return "";
  std::string paths;
  for (const auto& manifest : std::filesystem::directory_iterator(installed)) {
    std::string text = readBytes(manifest.path());
    const std::string driver = "\"ICD\": {";
    const size_t at = text.find(driver);
    if (at == std::string::npos) continue;
    text.insert(at + driver.size(), "\"is_portability_driver\": true,");
    const std::filesystem::path path = folder / manifest.path().filename();
    std::ofstream(path) << text;
    paths += (paths.empty() ? "" : ":") + path.string();
  }
  return paths;
}

TEST_F(VulkanInstance, SeesDriversOfASubsetOfVulkan) {
  const TemporaryFolder folder;
  const std::string manifests = portabilityManifests(folder.path());
  if (manifests.empty()) GTEST_SKIP() << "no manifests of drivers";
  // Newer loaders prefer the first variable, older ones know only the second.
  const ScopedVariable drivers("VK_DRIVER_FILES", manifests), icds("VK_ICD_FILENAMES", manifests);
  VkInstance plain = VK_NULL_HANDLE;
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  if (vkCreateInstance(&info, nullptr, &plain) == VK_SUCCESS) {
    vkDestroyInstance(plain, nullptr);
    GTEST_SKIP() << "the loader hides no drivers";
  }
  const Instance instance;
  EXPECT_FALSE(physicalDevices(instance.handle()).empty());
}

TEST_F(VulkanInstance, SaysWhyADriverDoesNotStart) {
  const TemporaryFolder folder;
  const std::string manifest = folder.path() / "broken.json";
  std::ofstream(manifest) << R"({"file_format_version": "1.0.0",
                                 "ICD": {"library_path": "/absent/libbroken.so", "api_version": "1.3.0"}})";
  const ScopedVariable drivers("VK_DRIVER_FILES", manifest), icds("VK_ICD_FILENAMES", manifest);
  try {
    const Instance instance;
    FAIL() << "a driver without a library starts";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
    EXPECT_NE(std::string(error.what()).find("/absent/libbroken.so"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace raymap::vulkan
