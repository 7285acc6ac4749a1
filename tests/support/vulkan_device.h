#pragma once

#include <gtest/gtest.h>
#include <raymap/error.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "vulkan/self_test/probe.h"

namespace raymap::vulkan {

/// Returns whether tests run under the validation layer. RAYMAP_VULKAN_VALIDATION=off is for machines without
/// it.
inline bool isValidated() {
  const char* value = std::getenv("RAYMAP_VULKAN_VALIDATION");
  return !value || std::string(value) != "off";
}

/// A test on a device under the validation layer, with guards around every buffer. The layer checks for
/// hazards unless the environment asks for other checks, or for none. The test fails on any message of the
/// layer and on any damaged guard. It is skipped where there is no driver, but fails there if
/// RAYMAP_REQUIRE_VULKAN=1.
class VulkanTest : public ::testing::Test {
 public:
  /// Returns a probe or a stage that all tests share.
  template <class Kept>
  static Kept& kept() {
    shared();  // The device is made before what is kept on it, so it is destroyed after that.
    static Kept kept(device());
    return kept;
  }

 protected:
  /// Returns the device that all tests of a program share. RAYMAP_VULKAN_DEVICE=K selects one.
  static Device& device() { return *shared().device; }

  template <std::ranges::contiguous_range Values>
  static DeviceBuffer upload(const Values& values, const std::string& name = "test") {
    return Probe(device()).upload(values, name);
  }
  template <class T>
  static std::vector<T> download(const DeviceBuffer& buffer) {
    return Probe(device()).download<T>(buffer);
  }
  template <class Record>
  static void run(Record&& record) {
    Probe(device()).run(record);
  }

  void SetUp() override {
    if (shared().device) return;
    const char* required = std::getenv("RAYMAP_REQUIRE_VULKAN");
    if (required && std::string(required) == "1") FAIL() << shared().problem;
    GTEST_SKIP() << shared().problem;
  }

  void TearDown() override {
    const std::lock_guard lock(shared().mutex);
    for (const std::string& message : shared().messages) ADD_FAILURE() << message;
    shared().messages.clear();
  }

  struct Shared {
    Shared() {
      const char* index = std::getenv("RAYMAP_VULKAN_DEVICE");
      DeviceOptions options{.message =
                                [this](std::string_view message) {
                                  const std::lock_guard lock(mutex);
                                  messages.emplace_back(message);
                                },
                            .guards = true};
      if (index) options.index = std::stoul(index);
      if (isValidated() && options.validation == Validation::Off) options.validation = Validation::Sync;
      try {
        device = std::make_unique<Device>(options);
      } catch (const Error& error) {
        problem = error.what();
      }
    }
    std::unique_ptr<Device> device;
    std::string problem;  ///< Reason why there is no device.
    std::vector<std::string> messages;
    std::mutex mutex;
  };
  static Shared& shared() {
    static Shared shared;
    return shared;
  }
};

}  // namespace raymap::vulkan
