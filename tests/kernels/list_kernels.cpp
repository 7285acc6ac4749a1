// Makes every kernel as the product specialises it, on the first Vulkan device, and prints the driver's
// statistics: a line of JSON per kernel. The device need not exist: Mesa's RADV also compiles for cards that
// are absent (RADV_FORCE_FAMILY). Nothing runs. scripts/check_kernels.py calls it and makes the table.
//   list_kernels [invocations per subgroup]

#include <raymap/error.h>

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "counters/shader_names.h"
#include "counters/vulkan_entry.h"
#include "kernel_statistics.h"
#include "method/pipeline.h"
#include "picture/drawn_scene.h"
#include "vulkan/runtime/frame_backend.h"
#include "vulkan/stages/render_field.h"
#include "vulkan/stages/skin.h"

namespace raymap::vulkan {

namespace {

/// Stands in for the memory of a card that is absent, and drops all commands.
class AbsentCard {
 public:
  AbsentCard() { realNeeds = needs_.real(); }

 private:
  static constexpr VkDeviceSize kMemory = VkDeviceSize{8} << 30;
  static constexpr VkMemoryPropertyFlags kEveryUse =
      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
      VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

  static VKAPI_ATTR void VKAPI_CALL describe(VkPhysicalDevice, VkPhysicalDeviceMemoryProperties* memory) {
    *memory = {.memoryTypeCount = 1,
               .memoryTypes = {{kEveryUse, 0}},
               .memoryHeapCount = 1,
               .memoryHeaps = {{kMemory, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT}}};
  }
  static VKAPI_ATTR void VKAPI_CALL describe2(VkPhysicalDevice device,
                                              VkPhysicalDeviceMemoryProperties2* memory) {
    describe(device, &memory->memoryProperties);
    for (auto* next = static_cast<VkBaseOutStructure*>(memory->pNext); next; next = next->pNext) {
      if (next->sType != VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MEMORY_BUDGET_PROPERTIES_EXT) continue;
      auto* budget = reinterpret_cast<VkPhysicalDeviceMemoryBudgetPropertiesEXT*>(next);
      budget->heapBudget[0] = kMemory;
      budget->heapUsage[0] = 0;
    }
  }
  static VKAPI_ATTR void VKAPI_CALL needs(VkDevice device, VkBuffer buffer, VkMemoryRequirements* needs) {
    realNeeds(device, buffer, needs);
    needs->memoryTypeBits = 1;
  }
  static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice, const VkMemoryAllocateInfo* info,
                                                 const VkAllocationCallbacks*, VkDeviceMemory* memory) {
    *memory = reinterpret_cast<VkDeviceMemory>(std::calloc(info->allocationSize, 1));
    return *memory ? VK_SUCCESS : VK_ERROR_OUT_OF_HOST_MEMORY;
  }
  static VKAPI_ATTR void VKAPI_CALL free(VkDevice, VkDeviceMemory memory, const VkAllocationCallbacks*) {
    std::free(memory);
  }
  static VKAPI_ATTR VkResult VKAPI_CALL map(VkDevice, VkDeviceMemory memory, VkDeviceSize, VkDeviceSize,
                                            VkMemoryMapFlags, void** mapped) {
    *mapped = memory;
    return VK_SUCCESS;
  }

  ReplacedEntry<PFN_vkGetPhysicalDeviceMemoryProperties> describe_{vkGetPhysicalDeviceMemoryProperties,
                                                                   describe};
  ReplacedEntry<PFN_vkGetPhysicalDeviceMemoryProperties2> describe2_{vkGetPhysicalDeviceMemoryProperties2,
                                                                     describe2};
  static inline PFN_vkGetBufferMemoryRequirements realNeeds = nullptr;
  ReplacedEntry<PFN_vkGetBufferMemoryRequirements> needs_{vkGetBufferMemoryRequirements, needs};
  ReplacedEntry<PFN_vkAllocateMemory> allocate_{vkAllocateMemory, allocate};
  ReplacedEntry<PFN_vkFreeMemory> free_{vkFreeMemory, free};
  ReplacedEntry<PFN_vkBindBufferMemory> bindMemory_{
      vkBindBufferMemory, [](VkDevice, VkBuffer, VkDeviceMemory, VkDeviceSize) { return VK_SUCCESS; }};
  ReplacedEntry<PFN_vkMapMemory> map_{vkMapMemory, map};
  ReplacedEntry<PFN_vkGetBufferDeviceAddress> address_{
      vkGetBufferDeviceAddress,
      [](VkDevice, const VkBufferDeviceAddressInfo*) { return VkDeviceAddress{4096}; }};
  ReplacedEntry<PFN_vkCmdDispatchBase> dispatch_{
      vkCmdDispatchBase, [](VkCommandBuffer, uint32_t, uint32_t, uint32_t, uint32_t, uint32_t, uint32_t) {}};
  ReplacedEntry<PFN_vkCmdDispatchIndirect> dispatchIndirect_{vkCmdDispatchIndirect,
                                                             [](VkCommandBuffer, VkBuffer, VkDeviceSize) {}};
  ReplacedEntry<PFN_vkCmdFillBuffer> fill_{
      vkCmdFillBuffer, [](VkCommandBuffer, VkBuffer, VkDeviceSize, VkDeviceSize, uint32_t) {}};
  ReplacedEntry<PFN_vkCmdUpdateBuffer> update_{
      vkCmdUpdateBuffer, [](VkCommandBuffer, VkBuffer, VkDeviceSize, VkDeviceSize, const void*) {}};
  ReplacedEntry<PFN_vkCmdCopyBuffer> copy_{
      vkCmdCopyBuffer, [](VkCommandBuffer, VkBuffer, VkBuffer, uint32_t, const VkBufferCopy*) {}};
  ReplacedEntry<PFN_vkCmdPipelineBarrier2> barrier_{vkCmdPipelineBarrier2,
                                                    [](VkCommandBuffer, const VkDependencyInfo*) {}};
  ReplacedEntry<PFN_vkCmdBindPipeline> bind_{vkCmdBindPipeline,
                                             [](VkCommandBuffer, VkPipelineBindPoint, VkPipeline) {}};
  ReplacedEntry<PFN_vkCmdPushConstants> push_{
      vkCmdPushConstants,
      [](VkCommandBuffer, VkPipelineLayout, VkShaderStageFlags, uint32_t, uint32_t, const void*) {}};
};

/// Records every stage of the pipeline, with those that only hosts run.
class EveryStage : public FrameBackend {
 public:
  EveryStage(Device& device, const Room& room)
      : FrameBackend(device), nowhere_(VK_NULL_HANDLE, device.pipelineLayout(), nullptr) {
    reserve(room);
    grid_ = {.dims = room.dims, .spacing = 1.0};
    options_ = {.distance = room.distance, .sign = room.sign};
  }

  void record(Sampling sampling) {
    options_.sampling = sampling;
    setFrame({.commands = nowhere_,
              .mesh = {.vertexCount = extent().vertices, .triangleCount = extent().triangles}},
             grid_, options_);
    runPipeline(*this);
  }

  /// Records orientation and closing of holes.
  void recordForHosts(const Extent& extent) {
    StageRecorder::reserve(extent);
    start(nowhere_, grid_, options_);
    setResults({});
    orientation_.recordMisfit(nowhere_, orientationFields());
    orientation_.recordSides(nowhere_, orientationFields(), 0.0f, SideMeasure::Rise);
    orientation_.recordParity(nowhere_, orientationFields());
    closeHoles_.recordSearch(nowhere_, extent.dims, crossings_.crossed(), results_.winding, 0.5);
    closeHoles_.recordNumbersAt(nowhere_, windingDipoles_, surfaceTree(), std::vector<glm::vec3>(1), 0.5);
    HolePatch patch;
    patch.triangles = {{0, 1, 2}};
    patch.mesh.vertices.resizeUninitialized(3);
    patch.mesh.dims = extent.dims;
    closeHoles_.recordDistance(nowhere_, patch, {});
  }
  static Extent hostExtent(const Room& room) {
    return {.vertices = room.vertices,
            .triangles = room.triangles,
            .dims = room.dims,
            .turnsFaces = true,
            .closesHoles = true};
  }

 private:
  Commands nowhere_;
  Grid grid_;
  FieldOptions options_;
};

/// Those for narrow bands are made with the first picture.
void makeKernelsOfPictures(Device& device) {
  RenderFieldStage renders(device);
  renders.makeKernels();
  Commands nowhere(VK_NULL_HANDLE, device.pipelineLayout(), nullptr);
  const Field elsewhere{.grid = {.dims = {64, 64, 64}, .spacing = 1.0}};
  RenderOptions options{.frame = Box{glm::dvec3(0.0), glm::dvec3(63.0)}};
  for (const FieldArray array : {FieldArray::Distance, FieldArray::Winding}) {
    options.array = array;
    renders.recordScene(nowhere, DrawnScene(DrawnField(elsewhere, 3.0, 3.0), options), 64, 64, {}, 4096);
    renders.recordRows(nowhere, {}, {}, 0, 64);
  }
}

void makeKernels(Device& device) {
  const Room room{.vertices = 30000, .triangles = 60000, .dims = {64, 64, 64}};
  // Meshes within the grid and beyond it have different kernels.
  const auto with = [&room](DistanceMode distance, SignMode sign, double outside = 0.0) {
    Room changed = room;
    changed.outside = outside;
    changed.distance = distance;
    changed.sign = sign;
    return changed;
  };
  EveryStage usual(device, room);
  usual.record(Sampling::Spread);
  usual.recordForHosts(EveryStage::hostExtent(room));
  EveryStage(device, with(DistanceMode::Cell, SignMode::Rays)).record(Sampling::Spread);
  EveryStage(device, with(DistanceMode::Neighbours, SignMode::Ray, 8.0)).record(Sampling::Spread);
  EveryStage(device, with(DistanceMode::Raster, SignMode::Paths)).record(Sampling::Spread);
  EveryStage(device, with(DistanceMode::Raster, SignMode::Evolution, 8.0)).record(Sampling::Paper);
  FieldImageStage(device).reserve(room.dims, VK_FORMAT_R16_SFLOAT);
  const SkinStage skins(device);
  makeKernelsOfPictures(device);
}

int run(uint32_t subgroupSize) {
  const KernelStatistics statistics(subgroupSize);
  const AbsentCard absent;
  Device device({.index = 0, .validation = Validation::Off});
  makeKernels(device);
  std::set<std::string> missing;
  for (const Shader& shader : shaders::kAll) missing.emplace(shader.name);
  for (const CompiledKernel& kernel : statistics.kernels()) {
    missing.erase(kernel.name);
    const nlohmann::ordered_json line{{"kernel", kernel.name},
                                      {"constants", kernel.constants},
                                      {"subgroup_size", kernel.subgroupSize},
                                      {"full_subgroups", kernel.hasFullSubgroups},
                                      {"statistics", kernel.statistics}};
    std::puts(line.dump().c_str());
  }
  std::puts(nlohmann::ordered_json{{"device", device.info().name}, {"not_made", missing}}.dump().c_str());
  return 0;
}

}  // namespace

}  // namespace raymap::vulkan

int main(int argc, char** argv) {
  try {
    return raymap::vulkan::run(argc > 1 ? static_cast<uint32_t>(std::stoul(argv[1])) : 0);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "list_kernels: %s\n", error.what());
    return 1;
  }
}
