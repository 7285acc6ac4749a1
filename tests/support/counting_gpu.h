#pragma once

// A GPU backend without a GPU, for tests of how devices are chosen and kept.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "environment.h"
#include "method/gpu_plug_in.h"

namespace raymap {

/// Replaces the GPU backend while it lives and counts what is asked of it. It lists four devices, of which
/// only the last is usable.
class CountingGpu {
 public:
  static constexpr size_t kUsable = 3;

  CountingGpu() : before_(gpuPlugIn() ? *gpuPlugIn() : kNone) {
    lists = opens = runs = tests = 0;
    onGenerate = {};
    onTest = {};
    fingerprint = "made for tests " + std::to_string(++made_);
    kernels = 1;
    plugIn({.list = list,
            .open = open,
            .test = test,
            .mayHaveGpu = [] { return true; },
            .kernelHash = [] { return kernels; }});
  }
  ~CountingGpu() { plugIn(before_); }
  CountingGpu(const CountingGpu&) = delete;
  CountingGpu& operator=(const CountingGpu&) = delete;

  static inline int lists = 0, opens = 0, runs = 0, tests = 0;
  /// Called by every run; it may throw.
  static inline std::function<void()> onGenerate;
  /// Called by every test, which passes without it; it may throw.
  static inline std::function<void(const DeviceTestReport&)> onTest;
  /// Identity of all devices: another one in each test, so that no test of a device counts in the next.
  static inline std::string fingerprint;
  /// Hash of the kernels.
  static inline uint64_t kernels;

 private:
  class FakeDevice final : public GpuDevice {
   public:
    void generate(const Job& job, Stats&) override {
      ++runs;
      job.progress.stage("begin", [] {});
      if (onGenerate) onGenerate();
      job.field.grid = job.grid;
      job.field.distance.resizeUninitialized(job.grid.sampleCount());
      // A small solid in the middle.
      std::fill(job.field.distance.begin(), job.field.distance.end(), 1.0f);
      job.field.distance[job.grid.index(job.grid.dims / 2)] = -1.0f;
    }
    void draw(const DrawnScene&, Progress&, Picture&) override {}
  };

  static std::vector<DeviceInfo> list() {
    ++lists;
    std::vector<DeviceInfo> devices(kUsable + 1);
    for (size_t index = 0; index < devices.size(); ++index) {
      devices[index] = {.id = "vulkan:" + std::to_string(index),
                        .name = "Counting GPU",
                        .type = DeviceType::Discrete,
                        .driver = "Counter 1.0",
                        .fingerprint = fingerprint};
      if (index != kUsable) devices[index].problem = "made for a test";
    }
    return devices;
  }
  static std::unique_ptr<GpuDevice> open(size_t index) {
    ++opens;
    if (index != kUsable) throw Error(ErrorCode::Unsupported, "not usable");
    return std::make_unique<FakeDevice>();
  }

  static void test(size_t index, const DeviceTestReport& report) {
    EXPECT_EQ(index, kUsable);
    ++tests;
    if (onTest) onTest(report);
  }

  static constexpr GpuPlugIn kNone{.list = [] { return std::vector<DeviceInfo>(); },
                                   .open = [](size_t) { return std::unique_ptr<GpuDevice>(); },
                                   .test = [](size_t, const DeviceTestReport&) {},
                                   .mayHaveGpu = [] { return false; },
                                   .kernelHash = [] { return uint64_t{0}; }};
  static inline int made_ = 0;
  GpuPlugIn before_;
  ScopedVariable cache_{"RAYMAP_CACHE", "off"};
};

}  // namespace raymap
