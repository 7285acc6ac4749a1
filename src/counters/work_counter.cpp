#include "counters/work_counter.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>

#include "counters/races.h"
#include "counters/shader_names.h"
#include "counters/vulkan_entry.h"
#include "vulkan/device/command_buffer.h"
#include "vulkan/device/spirv.h"

namespace raymap::vulkan {

namespace {

/// Record of a dispatch in the log, which the host reads.
struct LogEntry {
  WorkCounters work;
  VkDispatchIndirectCommand groups;
  uint32_t unused;
};
constexpr uint32_t kLogEntries = 8192;
constexpr uint32_t kMostAccesses = 1U << 25;  // Of a submission.

struct PipelineInfo {
  std::string name;
  uint32_t groupSize;
};

}  // namespace

struct WorkCounter::State {
  Measured measured = Measured::Work;
  DeviceBuffer counters, log;
  QueryPool stamps;             // Times of the commands, and of each beginning of a command buffer.
  std::vector<size_t> stamped;  // Of each query, the number of commands until then.
  double period = 0.0;
  VkDevice device = VK_NULL_HANDLE;
  VkFence lastFence = VK_NULL_HANDLE;  // Of the last submission, until its work is known.
  size_t submitted = 0;                // Number of commands until then.
  size_t harvested = 0;                // Number of commands whose races are known.
  size_t stampedThen = 0;              // Number of queries until then.
  std::mutex mutex;                    // Kernels may be made on several threads.
  std::map<VkShaderModule, std::string> modules;
  std::map<VkPipeline, PipelineInfo> pipelines;
  std::map<VkBuffer, VkDeviceSize> sizes;
  std::map<VkDeviceAddress, std::pair<VkDeviceSize, VkBuffer>> addresses;
  std::map<std::string, std::span<const uint32_t>> replaced;  // Code, by the shader's name.
  const Guards* guards = nullptr;
  Races races;
  std::vector<CountedCommand> commands;
  std::vector<size_t> pending;  // Dispatches by index in the log, as indices of commands.
  PipelineInfo bound;
  std::vector<VkDeviceAddress> pointers;        // Push constants that may be addresses.
  std::vector<VkDeviceAddress> pointersBefore;  // Those of the dispatch before.
  std::string stage;
  uint32_t step = 0, submission = 0;

  void add(const std::string& name, uint64_t groups, uint32_t groupSize, const WorkCounters& work,
           std::vector<TouchedRange> ranges = {}) {
    commands.push_back({.name = name,
                        .stage = stage,
                        .step = step,
                        .submission = submission,
                        .groups = groups,
                        .groupSize = groupSize,
                        .ranges = std::move(ranges),
                        .work = work});
  }
  TouchedRange range(VkBuffer buffer, VkDeviceSize offset, VkDeviceSize bytes, Access::Kind kind) const;
  std::string placeOf(const CountedCommand& command, const Access& access) const;
  std::span<const uint32_t> codeOf(const std::string& name) const;
  uint64_t touchableBytes() const;
  void stamp(VkCommandBuffer buffer);
  void dropUnsubmitted();
  void harvest();
  void harvestWork();
  void harvestTimes();
  void harvestRaces();
};

/// Sums the sizes of the buffers from the pointers on, each buffer once.
uint64_t WorkCounter::State::touchableBytes() const {
  std::map<VkBuffer, uint64_t> touched;
  for (const VkDeviceAddress pointer : pointers) {
    const auto above = addresses.upper_bound(pointer);
    if (above == addresses.begin()) continue;
    const auto& [address, buffer] = *std::prev(above);
    if (pointer >= address + buffer.first) continue;
    uint64_t& bytes = touched[buffer.second];
    bytes = std::max<uint64_t>(bytes, address + buffer.first - pointer);
  }
  uint64_t sum = 0;
  for (const auto& [buffer, bytes] : touched) sum += bytes;
  return sum;
}

/// Writes the time at which the last command ends.
void WorkCounter::State::stamp(VkCommandBuffer buffer) {
  if (measured != Measured::Time) return;
  const size_t query = stamped.size();
  if (query >= kLogEntries) throw std::length_error("more commands than there are queries for their times");
  vkCmdWriteTimestamp2(buffer, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, stamps.get(), uint32_t(query));
  stamped.push_back(commands.size());
}

/// Forgets commands that were recorded but not submitted: a recording that begins replaces the one before.
void WorkCounter::State::dropUnsubmitted() {
  commands.resize(submitted);
  std::erase_if(pending, [this](size_t command) { return command >= submitted; });
  stamped.resize(stampedThen);
}

void WorkCounter::State::harvest() {
  if (measured == Measured::Time) harvestTimes();
  harvestWork();
  if (measured == Measured::Races) harvestRaces();
  lastFence = VK_NULL_HANDLE;
  ++submission;
}

void WorkCounter::State::harvestTimes() {
  std::vector<uint64_t> ticks(stamped.size());
  check(vkGetQueryPoolResults(device, stamps.get(), 0, uint32_t(ticks.size()),
                              ticks.size() * sizeof(uint64_t), ticks.data(), sizeof(uint64_t),
                              VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "reading the times of commands");
  for (size_t i = 1; i < ticks.size(); ++i)
    if (stamped[i] > stamped[i - 1])
      commands[stamped[i] - 1].milliseconds = 1e-6 * period * double(ticks[i] - ticks[i - 1]);
  stamped.clear();
  stampedThen = 0;
}

/// Reads the log of a completed submission.
void WorkCounter::State::harvestWork() {
  const std::span<const LogEntry> entries = log.mapped<const LogEntry>();
  for (size_t i = 0; i < pending.size(); ++i) {
    CountedCommand& command = commands[pending[i]];
    command.work = entries[i].work;
    if (command.groups > 0) continue;
    const VkDispatchIndirectCommand& groups = entries[i].groups;
    command.groups = uint64_t{groups.x} * groups.y * groups.z;
  }
  if (measured != Measured::Races) pending.clear();
}

/// Finds the races of a completed submission. The dispatches' logs lie one behind the other.
void WorkCounter::State::harvestRaces() {
  const std::span<std::byte> memory = counters.mapped<std::byte>();
  const auto* const entries = reinterpret_cast<const Access*>(memory.data() + kAccessHeader);
  std::vector<LoggedCommand> logged(commands.size() - harvested);
  for (size_t i = 0; i < logged.size(); ++i) logged[i].command = &commands[harvested + i];
  uint64_t begin = 0;
  for (const size_t p : pending) {
    const uint64_t end = commands[p].work.operations;
    if (end > kMostAccesses) {
      races["log"] =
          commands[p].name + ": with it, there are more accesses than the log holds: " + std::to_string(end);
      break;
    }
    logged[p - harvested].accesses = {entries + begin, end - begin};
    begin = end;
  }
  findRaces(
      logged, [this](const CountedCommand& c, const Access& a) { return placeOf(c, a); }, races);
  std::fill_n(memory.begin(), sizeof(uint64_t), std::byte{});
  harvested = commands.size();
  pending.clear();
}

TouchedRange WorkCounter::State::range(VkBuffer buffer, VkDeviceSize offset, VkDeviceSize bytes,
                                       Access::Kind kind) const {
  for (const auto& [address, known] : addresses)
    if (known.second == buffer) return {address + offset, bytes, kind};
  return {0, 0, kind};
}

std::span<const uint32_t> WorkCounter::State::codeOf(const std::string& name) const {
  if (const auto found = replaced.find(name); found != replaced.end()) return found->second;
  const auto found = std::ranges::find(shaders::kAll, name, &Shader::name);
  return found == std::end(shaders::kAll) ? std::span<const uint32_t>() : found->code;
}

/// Returns the name of a buffer or of a shared variable, and the offset in it.
std::string WorkCounter::State::placeOf(const CountedCommand& command, const Access& access) const {
  constexpr uint32_t kOpName = 5;
  const uint64_t place = access.place();
  if (access.isShared()) {
    std::string name = "shared memory";
    forEachInstruction(codeOf(command.name), [&](std::span<const uint32_t> words) {
      if (opOf(words) == kOpName && words[1] == place >> 32)
        name = "shared " + std::string(reinterpret_cast<const char*>(words.data() + 2));
    });
    return name + " + " + std::to_string(uint32_t(place));
  }
  const auto above = addresses.upper_bound(place);
  if (above == addresses.begin()) return "unknown memory";
  const auto& [address, buffer] = *std::prev(above);
  const uint64_t offset = place - address - (guards ? Guards::kBytes : 0);
  return "buffer '" + (guards ? guards->nameOf(buffer.second) : "") + "' + " + std::to_string(offset);
}

/// The entries of Vulkan's function table that are counted.
struct WorkCounter::Entries {
  static inline State* state = nullptr;
  static inline Entries* current = nullptr;

  ReplacedEntry<PFN_vkCreateShaderModule> createModule{vkCreateShaderModule, makeModule};
  ReplacedEntry<PFN_vkCreateComputePipelines> createPipelines{vkCreateComputePipelines, makePipelines};
  ReplacedEntry<PFN_vkCreateBuffer> createBuffer{vkCreateBuffer, makeBuffer};
  ReplacedEntry<PFN_vkDestroyBuffer> destroyBuffer{vkDestroyBuffer, forgetBuffer};
  ReplacedEntry<PFN_vkGetBufferDeviceAddress> getAddress{vkGetBufferDeviceAddress, addressOf};
  ReplacedEntry<PFN_vkCmdBindPipeline> bind{vkCmdBindPipeline, bindPipeline};
  ReplacedEntry<PFN_vkCmdPushConstants> push{vkCmdPushConstants, pushConstants};
  ReplacedEntry<PFN_vkCmdDispatchBase> dispatch{vkCmdDispatchBase, dispatchGroups};
  ReplacedEntry<PFN_vkCmdDispatchIndirect> dispatchIndirect{vkCmdDispatchIndirect, dispatchFrom};
  ReplacedEntry<PFN_vkCmdFillBuffer> fill{vkCmdFillBuffer, fillBuffer};
  ReplacedEntry<PFN_vkCmdUpdateBuffer> update{vkCmdUpdateBuffer, updateBuffer};
  ReplacedEntry<PFN_vkCmdCopyBuffer> copy{vkCmdCopyBuffer, copyBuffer};
  ReplacedEntry<PFN_vkCmdPipelineBarrier2> barrier{vkCmdPipelineBarrier2, placeBarrier};
  ReplacedEntry<PFN_vkBeginCommandBuffer> begin{vkBeginCommandBuffer, beginCommands};
  ReplacedEntry<PFN_vkQueueSubmit2> submit{vkQueueSubmit2, submitCommands};
  ReplacedEntry<PFN_vkWaitForFences> wait{vkWaitForFences, waitForFences};

  static VKAPI_ATTR VkResult VKAPI_CALL makeModule(VkDevice device, const VkShaderModuleCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator,
                                                   VkShaderModule* module) {
    const std::string name = shaderName(*info);
    std::span<const uint32_t> code(info->pCode, info->codeSize / sizeof(uint32_t));
    if (const auto other = state->replaced.find(name); other != state->replaced.end()) code = other->second;
    std::vector<uint32_t> changed;
    if (state->measured == Measured::Work) changed = withCounters(code, state->counters.address());
    if (state->measured == Measured::Races)
      changed = withAccessLog(code, state->counters.address(), kMostAccesses);
    if (!changed.empty()) code = changed;
    VkShaderModuleCreateInfo counting = *info;
    counting.codeSize = code.size_bytes();
    counting.pCode = code.data();
    const VkResult result = current->createModule.real()(device, &counting, allocator, module);
    const std::lock_guard lock(state->mutex);
    if (result == VK_SUCCESS) state->modules[*module] = name;
    return result;
  }

  static VKAPI_ATTR VkResult VKAPI_CALL makePipelines(VkDevice device, VkPipelineCache cache, uint32_t count,
                                                      const VkComputePipelineCreateInfo* infos,
                                                      const VkAllocationCallbacks* allocator,
                                                      VkPipeline* pipelines) {
    const VkResult result =
        current->createPipelines.real()(device, cache, count, infos, allocator, pipelines);
    if (result != VK_SUCCESS) return result;
    const std::lock_guard lock(state->mutex);
    for (uint32_t i = 0; i < count; ++i) {
      const VkPipelineShaderStageCreateInfo& stage = infos[i].stage;
      state->pipelines[pipelines[i]] = {state->modules.at(stage.module),
                                        *static_cast<const uint32_t*>(stage.pSpecializationInfo->pData)};
    }
    return result;
  }

  static VKAPI_ATTR VkResult VKAPI_CALL makeBuffer(VkDevice device, const VkBufferCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkBuffer* buffer) {
    const VkResult result = current->createBuffer.real()(device, info, allocator, buffer);
    if (result == VK_SUCCESS) state->sizes[*buffer] = info->size;
    return result;
  }

  static VKAPI_ATTR void VKAPI_CALL forgetBuffer(VkDevice device, VkBuffer buffer,
                                                 const VkAllocationCallbacks* allocator) {
    state->sizes.erase(buffer);
    std::erase_if(state->addresses, [buffer](const auto& entry) { return entry.second.second == buffer; });
    current->destroyBuffer.real()(device, buffer, allocator);
  }

  static VKAPI_ATTR VkDeviceAddress VKAPI_CALL addressOf(VkDevice device,
                                                         const VkBufferDeviceAddressInfo* info) {
    const VkDeviceAddress address = current->getAddress.real()(device, info);
    state->addresses[address] = {state->sizes[info->buffer], info->buffer};
    return address;
  }

  static VKAPI_ATTR void VKAPI_CALL bindPipeline(VkCommandBuffer buffer, VkPipelineBindPoint point,
                                                 VkPipeline pipeline) {
    state->bound = state->pipelines.at(pipeline);
    current->bind.real()(buffer, point, pipeline);
  }

  static VKAPI_ATTR void VKAPI_CALL pushConstants(VkCommandBuffer buffer, VkPipelineLayout layout,
                                                  VkShaderStageFlags stages, uint32_t offset, uint32_t size,
                                                  const void* values) {
    state->pointers.resize(size / sizeof(VkDeviceAddress));
    std::memcpy(state->pointers.data(), values, state->pointers.size() * sizeof(VkDeviceAddress));
    current->push.real()(buffer, layout, stages, offset, size, values);
  }

  static VKAPI_ATTR void VKAPI_CALL dispatchGroups(VkCommandBuffer buffer, uint32_t firstX, uint32_t firstY,
                                                   uint32_t firstZ, uint32_t x, uint32_t y, uint32_t z) {
    current->dispatch.real()(buffer, firstX, firstY, firstZ, x, y, z);
    logDispatch(buffer, uint64_t{x} * y * z);
  }

  static VKAPI_ATTR void VKAPI_CALL dispatchFrom(VkCommandBuffer buffer, VkBuffer arguments,
                                                 VkDeviceSize offset) {
    if (state->measured == Measured::Time) {
      current->dispatchIndirect.real()(buffer, arguments, offset);
      return addDispatch(buffer, 0);
    }
    const VkBufferCopy region{.srcOffset = offset,
                              .dstOffset = logOffset() + offsetof(LogEntry, groups),
                              .size = sizeof(VkDispatchIndirectCommand)};
    wholeBarrier(buffer);
    current->copy.real()(buffer, arguments, state->log.handle(), 1, &region);
    current->dispatchIndirect.real()(buffer, arguments, offset);
    logDispatch(buffer, 0);
    state->commands.back().ranges = {
        state->range(arguments, offset, sizeof(VkDispatchIndirectCommand), Access::Kind::Read)};
  }

  static VKAPI_ATTR void VKAPI_CALL fillBuffer(VkCommandBuffer buffer, VkBuffer to, VkDeviceSize offset,
                                               VkDeviceSize size, uint32_t value) {
    current->fill.real()(buffer, to, offset, size, value);
    state->add("fill", 0, 0, {.bytesWritten = size}, {state->range(to, offset, size, Access::Kind::Write)});
    state->stamp(buffer);
  }

  static VKAPI_ATTR void VKAPI_CALL updateBuffer(VkCommandBuffer buffer, VkBuffer to, VkDeviceSize offset,
                                                 VkDeviceSize size, const void* values) {
    current->update.real()(buffer, to, offset, size, values);
    state->add("update", 0, 0, {.bytesWritten = size}, {state->range(to, offset, size, Access::Kind::Write)});
    state->stamp(buffer);
  }

  static VKAPI_ATTR void VKAPI_CALL copyBuffer(VkCommandBuffer buffer, VkBuffer from, VkBuffer to,
                                               uint32_t count, const VkBufferCopy* regions) {
    current->copy.real()(buffer, from, to, count, regions);
    state->add("copy", 0, 0, {.bytesRead = regions->size, .bytesWritten = regions->size},
               {state->range(from, regions->srcOffset, regions->size, Access::Kind::Read),
                state->range(to, regions->dstOffset, regions->size, Access::Kind::Write)});
    state->stamp(buffer);
  }

  static VKAPI_ATTR void VKAPI_CALL placeBarrier(VkCommandBuffer buffer, const VkDependencyInfo* info) {
    current->barrier.real()(buffer, info);
    ++state->step;
  }

  static VKAPI_ATTR VkResult VKAPI_CALL beginCommands(VkCommandBuffer buffer,
                                                      const VkCommandBufferBeginInfo* info) {
    const VkResult result = current->begin.real()(buffer, info);
    if (result != VK_SUCCESS) return result;
    state->dropUnsubmitted();
    if (!state->stamps) return result;
    if (state->stamped.empty()) vkCmdResetQueryPool(buffer, state->stamps.get(), 0, kLogEntries);
    state->stamp(buffer);
    return result;
  }

  static VKAPI_ATTR VkResult VKAPI_CALL submitCommands(VkQueue queue, uint32_t count,
                                                       const VkSubmitInfo2* infos, VkFence fence) {
    state->lastFence = fence;
    state->submitted = state->commands.size();
    state->stampedThen = state->stamped.size();
    return current->submit.real()(queue, count, infos, fence);
  }

  static VKAPI_ATTR VkResult VKAPI_CALL waitForFences(VkDevice device, uint32_t count, const VkFence* fences,
                                                      VkBool32 all, uint64_t timeout) {
    const VkResult result = current->wait.real()(device, count, fences, all, timeout);
    // Commands that were recorded since then may not be done. They are read with those that follow.
    const bool areAllDone = *fences == state->lastFence && state->submitted == state->commands.size();
    if (result == VK_SUCCESS && areAllDone) state->harvest();
    return result;
  }

  static VkDeviceSize logOffset() { return state->log.offset() + state->pending.size() * sizeof(LogEntry); }

  static void logDispatch(VkCommandBuffer buffer, uint64_t groups) {
    if (state->measured != Measured::Time) logCounters(buffer);
    addDispatch(buffer, groups);
  }

  /// Moves the counters of the dispatch before into the log, and clears them. Of a log of accesses, that
  /// moves the number of all so far.
  static void logCounters(VkCommandBuffer buffer) {
    if (state->pending.size() == kLogEntries) throw std::length_error("more dispatches than the log holds");
    const DeviceBuffer& counters = state->counters;
    const VkBufferCopy region{
        .srcOffset = counters.offset(), .dstOffset = logOffset(), .size = sizeof(WorkCounters)};
    wholeBarrier(buffer);
    current->copy.real()(buffer, counters.handle(), state->log.handle(), 1, &region);
    wholeBarrier(buffer);
    if (state->measured == Measured::Work) {
      current->fill.real()(buffer, counters.handle(), counters.offset(), counters.bytes(), 0);
      wholeBarrier(buffer);
    }
    state->pending.push_back(state->commands.size());
  }

  static void addDispatch(VkCommandBuffer buffer, uint64_t groups) {
    const bool isMore = !state->commands.empty() && state->commands.back().step == state->step &&
                        state->commands.back().name == state->bound.name &&
                        state->pointers == state->pointersBefore;
    state->pointersBefore = state->pointers;
    state->add(state->bound.name, groups, state->bound.groupSize, {});
    state->commands.back().touchableBytes = state->touchableBytes();
    state->commands.back().isMore = isMore;
    state->stamp(buffer);
  }

  static void wholeBarrier(VkCommandBuffer buffer) {
    const VkMemoryBarrier2 memory{
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
        .srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT,
        .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
        .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
    const VkDependencyInfo info{
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &memory};
    current->barrier.real()(buffer, &info);
  }
};

WorkCounter::WorkCounter(Measured measured) : state_(std::make_unique<State>()) {
  state_->measured = measured;
  sharedInstance();  // Loads the functions.
  Entries::state = state_.get();
  entries_ = std::make_unique<Entries>();
  Entries::current = entries_.get();
}

WorkCounter::~WorkCounter() {
  entries_.reset();
  Entries::current = nullptr;
  Entries::state = nullptr;
}

void WorkCounter::start(Device& device) {
  if (state_->measured == Measured::Time) {
    state_->device = device.handle();
    state_->period = device.limits().timestampPeriod;
    const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                     .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                     .queryCount = kLogEntries};
    create(state_->stamps, device.handle(), vkCreateQueryPool, info, "making queries for times");
    return clear();
  }
  const bool isLog = state_->measured == Measured::Races;
  state_->guards = device.guards();
  state_->counters = DeviceBuffer(device, "work counters", isLog ? MemoryUse::ReadBack : MemoryUse::Device);
  if (isLog)
    state_->counters.resize<std::byte>(kAccessHeader + (kMostAccesses + kLostAccesses) * sizeof(Access));
  else
    state_->counters.resize<WorkCounters>(1);
  state_->log = DeviceBuffer(device, "log of the work counters", MemoryUse::ReadBack);
  state_->log.resize<LogEntry>(kLogEntries);
  CommandBuffer own(device);
  own.begin().fill(state_->counters, 0);
  own.submitAndWait();
  clear();
}

void WorkCounter::stop() {
  state_->stamps = {};
  state_->counters.release();
  state_->log.release();
}

void WorkCounter::replace(const Shader& shader) {
  state_->replaced[std::string(shader.name)] = shader.code;
}

void WorkCounter::setStage(const std::string& stage) {
  state_->stage = stage;
}

void WorkCounter::clear() {
  state_->commands.clear();
  state_->races.clear();
  state_->pending.clear();
  state_->stamped.clear();
  state_->harvested = state_->submitted = state_->stampedThen = 0;
  state_->lastFence = VK_NULL_HANDLE;
  state_->step = state_->submission = 0;
}

const std::vector<CountedCommand>& WorkCounter::commands() const {
  return state_->commands;
}

std::vector<std::string> WorkCounter::races() const {
  std::vector<std::string> all;
  for (const auto& [key, race] : state_->races) all.push_back(race);
  return all;
}

}  // namespace raymap::vulkan
