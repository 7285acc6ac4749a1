#include "count_work.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>

#include "api/devices.h"
#include "base/memory.h"
#include "counters/vulkan_entry.h"
#include "counters/work_counter.h"
#include "meshes.h"
#include "method/pipeline.h"
#include "vulkan/runtime/backend.h"

namespace raymap::bench {

namespace {

using vulkan::CountedCommand;

constexpr double kWarp = 32.0;
/// Machine instructions of an AMD card per operation that is counted: the median over the kernels without
/// loops.
constexpr double kInstructionsPerOperation = 1.15;
constexpr double kWorthARow = 0.02;  ///< Share of all instructions that a kernel needs for a row of its own.
/// What an NVIDIA H200 showed: bytes and warp instructions of a millisecond, and the milliseconds of a step,
/// of an instruction that waits for the one before, and of a load.
constexpr double kBytes = 4.17e9, kIssued = 0.92e9, kStep = 3e-3, kInstruction = 2e-6, kLoad = 1.5e-4;
/// Share of the instructions that the card issued in stages that keep it busy.
const std::map<std::string, double> kIssueRates{
    {"distance_transform", 0.37}, {"exact_distance", 0.48}, {"refine", 0.6}};
constexpr const char* kReadBack = "read_back";
constexpr int kMeasuredRuns = 5;

/// Tells the counter which stage is being recorded.
class CountedBackend : public vulkan::Backend {
 public:
  CountedBackend(vulkan::Device& device, vulkan::WorkCounter& counter) : Backend(device), counter_(&counter) {
    counter_->setStage(kReadBack);
  }

 protected:
  void startStage(const char* name) override {
    counter_->setStage(name);
    Backend::startStage(name);
  }
  void stopStage() override {
    Backend::stopStage();
    counter_->setStage(kReadBack);
  }

 private:
  vulkan::WorkCounter* counter_;
};

/// Work of one step, or of all steps of a stage.
struct Work {
  uint32_t steps = 0, commands = 0;
  double bytes = 0, instructions = 0;
  double longest = 0, rounds = 0;  ///< Instructions and rounds of loads of the longest invocations, added up.
};

Work workOf(const CountedCommand& command) {
  const auto most = [&](uint64_t bytes) {
    return double(command.touchableBytes == 0 ? bytes : std::min(bytes, command.touchableBytes));
  };
  const auto& work = command.work;
  return {.commands = 1,
          .bytes = most(work.bytesRead) + most(work.bytesWritten),
          .instructions = kInstructionsPerOperation * double(work.steppedOperations) / kWarp,
          .longest = kInstructionsPerOperation * work.longest,
          .rounds = double(work.mostRounds)};
}

/// Adds a command to its step: both run at the same time.
void addToStep(Work& step, const Work& command) {
  step.commands += command.commands;
  step.bytes += command.bytes;
  step.instructions += command.instructions;
  step.longest = std::max(step.longest, command.longest);
  step.rounds = std::max(step.rounds, command.rounds);
}

/// Adds work that waits for the work before.
void addUp(Work& sum, const Work& next) {
  sum.steps += next.steps;
  sum.commands += next.commands;
  sum.bytes += next.bytes;
  sum.instructions += next.instructions;
  sum.longest += next.longest;
  sum.rounds += next.rounds;
}

/// Work of a stage, and of its kernels, fills and copies.
struct StageWork {
  std::string name;
  Work work;
  std::vector<StageWork> parts;
};

/// The stages that cross the bus, which the aims leave out.
bool crossesTheBus(const StageWork& stage) {
  return stage.name == kReadBack || stage.name == "begin";
}

StageWork& find(std::vector<StageWork>& stages, const std::string& name) {
  const auto found = std::ranges::find(stages, name, &StageWork::name);
  return found != stages.end() ? *found : stages.emplace_back(StageWork{name, {}, {}});
}

/// Returns a dispatch and its further parts, from command `i` on, as one; then `i` is the next. They share
/// the limit of the bytes.
Work takeDispatch(const std::vector<CountedCommand>& commands, size_t& i) {
  CountedCommand whole = commands[i];
  const size_t first = i;
  for (++i; i < commands.size() && commands[i].isMore; ++i) {
    const auto& part = commands[i].work;
    whole.work.steppedOperations += part.steppedOperations;
    whole.work.bytesRead += part.bytesRead;
    whole.work.bytesWritten += part.bytesWritten;
    whole.work.longest = std::max(whole.work.longest, part.longest);
    whole.work.mostRounds = std::max(whole.work.mostRounds, part.mostRounds);
  }
  Work work = workOf(whole);
  work.commands = static_cast<uint32_t>(i - first);
  return work;
}

std::vector<StageWork> stagesOf(const std::vector<CountedCommand>& commands) {
  std::vector<StageWork> stages;
  for (size_t i = 0; i < commands.size();) {
    const CountedCommand& first = commands[i];
    Work step{.steps = 1};
    while (i < commands.size() && commands[i].step == first.step) addToStep(step, takeDispatch(commands, i));
    StageWork& stage = find(stages, first.stage);
    addUp(stage.work, step);
    addUp(find(stage.parts, first.name).work, step);
  }
  return stages;
}

/// Drops what only drivers in software run: the rest of the exact distance, and its arguments.
void dropSoftwareOnly(std::vector<CountedCommand>& commands) {
  const auto isRest = [](const CountedCommand& command) { return command.name == "exact_distance_rest"; };
  const auto first = std::ranges::find_if(commands, isRest);
  if (first == commands.end()) return;
  commands.erase(std::prev(first));
  std::erase_if(commands, isRest);
}

/// Returns how often the device waits for the host before the field is complete.
uint32_t waitsOf(const std::vector<CountedCommand>& commands) {
  uint32_t last = 0;
  for (const CountedCommand& command : commands)
    if (command.stage != kReadBack) last = std::max(last, command.submission);
  return last;
}

FieldOptions optionsOf(const std::string& setting) {
  if (setting == "default") return {};
  if (setting == "quick") return {.distance = DistanceMode::Cell, .sign = SignMode::Rays};
  throw Error(ErrorCode::Usage, "there is no setting '" + setting + "'; use default or quick");
}

PFN_vkGetPhysicalDeviceMemoryProperties realMemory = nullptr;

/// Gives a driver in software all free memory of the host. Mesa's (22.3) says that it has 2 GiB.
VKAPI_ATTR void VKAPI_CALL growHeaps(VkPhysicalDevice device, VkPhysicalDeviceMemoryProperties* memory) {
  realMemory(device, memory);
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  if (properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) return;
  for (VkMemoryHeap& heap : memory->memoryHeaps) heap.size = memoryLeft();
}

/// Stops a counter before its device is destroyed, also where the grid does not fit.
struct StopAtEnd {
  vulkan::WorkCounter& counter;
  ~StopAtEnd() { counter.stop(); }
};

std::vector<CountedCommand> count(const vulkan::DeviceOptions& where, const Model& mesh, const Grid& grid,
                                  const FieldOptions& options) {
  const vulkan::ReplacedEntry grown(vkGetPhysicalDeviceMemoryProperties, growHeaps);
  realMemory = grown.real();
  vulkan::WorkCounter counter;
  vulkan::Device device(where);
  const StopAtEnd end{counter};
  counter.start(device);
  CountedBackend backend(device, counter);
  Field field;
  Progress progress;
  // The lists of the paper's distances grow in the first run.
  for (int run = options.distance == DistanceMode::Exact ? 1 : 0; run < 2; ++run) {
    counter.clear();
    backend.setJob({mesh, grid, options, progress, field});
    runPipeline(backend);
  }
  std::vector<CountedCommand> commands = counter.commands();
  dropSoftwareOnly(commands);
  return commands;
}

/// Returns the name of a stage's kernel among measured times.
std::string partName(const std::string& stage, const std::string& part) {
  return stage + "/" + part;
}

/// Returns the milliseconds of each stage's kernels, fills and copies: the least of a few runs.
std::map<std::string, double> measureParts(const vulkan::DeviceOptions& where, const Model& mesh,
                                           const Grid& grid, const FieldOptions& options) {
  vulkan::WorkCounter timer(vulkan::Measured::Time);
  vulkan::Device device(where);
  const StopAtEnd end{timer};
  std::map<std::string, double> least;
  timer.start(device);
  CountedBackend backend(device, timer);
  Field field;
  Progress progress;
  for (int run = 0; run < kMeasuredRuns; ++run) {
    timer.clear();
    backend.setJob({mesh, grid, options, progress, field});
    runPipeline(backend);
    if (run == 0) continue;  // It allocates.
    std::map<std::string, double> times;
    for (const CountedCommand& command : timer.commands())
      times[partName(command.stage, command.name)] += command.milliseconds;
    for (const auto& [name, milliseconds] : times) {
      const auto [at, isNew] = least.try_emplace(name, milliseconds);
      if (!isNew) at->second = std::min(at->second, milliseconds);
    }
  }
  return least;
}

bool isSoftware(const vulkan::DeviceOptions& where) {
  return vulkan::Device(where).info().type == DeviceType::Software;
}

/// Returns the milliseconds of each stage, and of all from the mesh to the field, without counters.
std::map<std::string, double> measure(const vulkan::DeviceOptions& where, const Model& mesh, const Grid& grid,
                                      const FieldOptions& options) {
  vulkan::Device device(where);
  std::map<std::string, double> times;
  vulkan::Backend backend(device);
  Field field;
  Progress progress;
  for (int run = 0; run < kMeasuredRuns; ++run) {
    backend.setJob({mesh, grid, options, progress, field});
    runPipeline(backend);
    if (run == 0) continue;  // It allocates.
    const auto keepLeast = [&](const std::string& name, double milliseconds) {
      const auto [at, isNew] = times.try_emplace(name, milliseconds);
      if (!isNew) at->second = std::min(at->second, milliseconds);
    };
    for (const Stats::Stage& stage : backend.stages()) keepLeast(stage.name, stage.milliseconds);
    keepLeast("all", backend.milliseconds());
  }
  return times;
}

/// Returns the milliseconds that a model of an NVIDIA H200 gives: a step waits for the one before, and a
/// stage takes as long as its bytes, its instructions or its longest invocations.
double predict(const std::string& stage, const Work& work) {
  const auto rate = kIssueRates.find(stage);
  const double issued = kIssued * (rate == kIssueRates.end() ? 1.0 : rate->second);
  return kStep * work.steps + std::max({work.bytes / kBytes, work.instructions / issued,
                                        kInstruction * work.longest + kLoad * work.rounds});
}

/// Prints a row. `key` is its name among the measured times.
void printRow(const std::string& name, const std::string& key, const Work& work, double predicted,
              const std::map<std::string, double>& times) {
  std::printf("| %s | %u | %u | %.1f | %.2f | %.0f | %.0f | %.3f |", name.c_str(), work.steps, work.commands,
              1e-6 * work.bytes, 1e-6 * work.instructions, work.longest, work.rounds, predicted);
  if (const auto time = times.find(key); time != times.end()) std::printf(" %.3f |", time->second);
  std::puts(times.contains(key) ? "" : " |");
}

void printTable(const std::vector<CountedCommand>& commands, const std::map<std::string, double>& times) {
  std::puts(
      "| stage | steps | commands | MB | million warp instructions | longest, instructions | longest, rounds "
      "of loads | predicted ms | measured ms |\n|---|---|---|---|---|---|---|---|---|");
  const std::vector<StageWork> stages = stagesOf(commands);
  Work all;
  double predicted = 0.0;
  for (const StageWork& stage : stages)
    if (!crossesTheBus(stage)) {
      addUp(all, stage.work);
      predicted += predict(stage.name, stage.work);
    }
  for (const auto& [name, work, parts] : stages) {
    printRow(name, name, work, predict(name, work), times);
    for (const StageWork& part : parts)
      if (parts.size() > 1 && part.work.instructions > kWorthARow * all.instructions)
        printRow("– " + part.name, partName(name, part.name), part.work, predict(name, part.work), times);
  }
  printRow("all", "all", all, predicted, times);
  std::printf("\nwaits for the host: %u\n", waitsOf(commands));
}

void printTimes(const std::map<std::string, double>& times) {
  std::puts("| stage/kernel | ms |\n|---|---|");
  for (const auto& [name, milliseconds] : times) std::printf("| %s | %.3f |\n", name.c_str(), milliseconds);
}

void countCase(const vulkan::DeviceOptions& where, const Model& mesh, int resolution,
               const FieldOptions& options, bool timesOnly) {
  const Grid grid = fitGrid(mesh, {.resolution = resolution});
  std::map<std::string, double> times;
  if (timesOnly || !isSoftware(where)) {
    times = measure(where, mesh, grid, options);
    times.merge(measureParts(where, mesh, grid, options));
  }
  if (timesOnly) return printTimes(times);
  printTable(count(where, mesh, grid, options), times);
}

}  // namespace

void countWork(const CountOptions& options) {
  setenv("RAYMAP_CACHE", "off", 1);  // Changed kernels are of no use to other runs.
  const std::optional<size_t> index = chooseDevice({.device = options.device});
  if (!index) throw Error(ErrorCode::Usage, options.device + " is no Vulkan device");
  for (const std::string& name : options.meshes) {
    const Mesh mesh = benchMesh(name);
    for (const std::string& setting : options.settings)
      for (const int resolution : options.resolutions) {
        std::fprintf(stderr, "counting %s, %s, %d\n", name.c_str(), setting.c_str(), resolution);
        std::printf("\n%s, %zu triangles, %s, %d samples:\n\n", name.c_str(), mesh.triangles.size(),
                    setting.c_str(), resolution);
        try {
          countCase({.index = index}, Model(mesh), resolution, optionsOf(setting), options.timesOnly);
        } catch (const Error& error) {
          if (error.code() != ErrorCode::Memory) throw;
          std::puts(error.what());
        }
        std::fflush(stdout);
      }
  }
}

}  // namespace raymap::bench
