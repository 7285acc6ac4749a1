#include "latencies.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>

#include "copy_rate_push.h"
#include "shaders/copy_rate_spv.h"
#include "vulkan/device/command_buffer.h"

namespace raymap::bench {

namespace {

constexpr int kRounds = 7;

/// Buffers and a kernel that copies 16 bytes.
struct Steps {
  explicit Steps(vulkan::Device& device)
      : commands(device),
        copyRate(device, vulkan::shaders::kCopyRate, 64),
        from(device, "from"),
        to(device, "to"),
        arguments(device, "arguments") {
    for (vulkan::DeviceBuffer* buffer : {&from, &to, &arguments}) buffer->resize<float>(4);
    push = {.from = from.address(), .to = to.address(), .count = 1};
  }

  void dispatch(vulkan::Commands& commands) { commands.dispatch(copyRate, push, 1); }

  vulkan::CommandBuffer commands;
  vulkan::Kernel<vulkan::CopyRatePush> copyRate;
  vulkan::DeviceBuffer from, to, arguments;
  vulkan::CopyRatePush push{};
};

struct Times {
  double device = HUGE_VAL, besides = HUGE_VAL;  ///< Microseconds; `besides`: the host's, less the device's.
};

/// Returns the least times of recording, submitting and awaiting `count` steps.
Times timesOf(Steps& on, int count, const std::function<void(vulkan::Commands&)>& step) {
  Times least;
  for (int round = 0; round < kRounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    vulkan::Commands commands = on.commands.begin();
    commands.startStage("steps");
    for (int i = 0; i < count; ++i) step(commands);
    commands.stopStage();
    on.commands.submitAndWait();
    const std::chrono::duration<double, std::micro> wall = std::chrono::steady_clock::now() - start;
    const double device = 1e3 * on.commands.times().front().milliseconds;
    least.device = std::min(least.device, device);
    least.besides = std::min(least.besides, wall.count() - device);
  }
  return least;
}

}  // namespace

void printLatencies(vulkan::Device& device) {
  Steps on(device);
  const auto row = [&](const char* name, const std::function<void(vulkan::Commands&)>& step) {
    std::printf("| %s | %.2f |\n", name, timesOf(on, 1000, step).device / 1000);
  };
  std::puts("| step, 1000 in a row | microseconds |\n|---|---|");
  row("dispatch", [&](vulkan::Commands& c) { on.dispatch(c); });
  for (const uint32_t groups : {1U, 0U}) {
    on.commands.begin().update(on.arguments, std::array{groups, 1U, 1U, 0U});
    on.commands.submitAndWait();
    row(groups == 1 ? "indirect dispatch" : "indirect dispatch of no group",
        [&](vulkan::Commands& c) { c.dispatchIndirect(on.copyRate, on.push, on.arguments, 0); });
  }
  row("fill", [&](vulkan::Commands& c) { c.fill(on.to, 0); });
  row("copy", [&](vulkan::Commands& c) { c.copy(on.from, on.to, 16); });
  row("16 dispatches without barriers between", [&](vulkan::Commands& c) {
    c.concurrent([&] {
      for (int i = 0; i < 16; ++i) on.dispatch(c);
    });
  });
  std::puts("\n| dispatches of a submission | microseconds of the host besides the device's |\n|---|---|");
  for (const int count : {1, 60, 600}) {
    const Times times = timesOf(on, count, [&](vulkan::Commands& c) { on.dispatch(c); });
    std::printf("| %d | %.1f |\n", count, times.besides);
  }
}

}  // namespace raymap::bench
