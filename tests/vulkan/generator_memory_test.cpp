#include "shaders/wave_vertices.h"
#include "shaders/wave_vertices_spv.h"
#include "vulkan_generation.h"

namespace raymap::vulkan {
namespace {

/// Counts, while it lives, calls of the Vulkan functions that a frame may not call.
class Counted {
 public:
  Counted() {
    calls() = submissions() = 0;
    vkAllocateMemory = [](VkDevice device, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* by,
                          VkDeviceMemory* memory) {
      ++calls();
      return before().allocate(device, info, by, memory);
    };
    vkCreateBuffer = [](VkDevice device, const VkBufferCreateInfo* info, const VkAllocationCallbacks* by,
                        VkBuffer* buffer) {
      ++calls();
      return before().makeBuffer(device, info, by, buffer);
    };
    vkCreateComputePipelines = [](VkDevice device, VkPipelineCache cache, uint32_t count,
                                  const VkComputePipelineCreateInfo* info, const VkAllocationCallbacks* by,
                                  VkPipeline* pipelines) {
      ++calls();
      return before().makePipelines(device, cache, count, info, by, pipelines);
    };
    vkQueueSubmit2 = [](VkQueue queue, uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
      ++submissions();
      return before().submit(queue, count, submits, fence);
    };
    vkMapMemory = [](VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
                     VkMemoryMapFlags flags, void** data) {
      ++calls();
      return before().map(device, memory, offset, size, flags, data);
    };
  }
  ~Counted() {
    vkAllocateMemory = before().allocate;
    vkCreateBuffer = before().makeBuffer;
    vkCreateComputePipelines = before().makePipelines;
    vkMapMemory = before().map;
    vkQueueSubmit2 = before().submit;
  }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

  static int& calls() {
    static int calls = 0;
    return calls;
  }
  /// Number of submissions: a frame's are the test's own, the host's backend has one.
  static int& submissions() {
    static int submissions = 0;
    return submissions;
  }

 private:
  struct Functions {
    PFN_vkAllocateMemory allocate = vkAllocateMemory;
    PFN_vkCreateBuffer makeBuffer = vkCreateBuffer;
    PFN_vkCreateComputePipelines makePipelines = vkCreateComputePipelines;
    PFN_vkMapMemory map = vkMapMemory;
    PFN_vkQueueSubmit2 submit = vkQueueSubmit2;
  };
  /// Returns Vulkan's own functions, kept before the first count.
  static const Functions& before() {
    static const Functions functions;
    return functions;
  }
  const Functions& keep_ = before();
};

TEST_F(VulkanGenerator, SubmitsOnceOnTheBackendOfTheHost) {
  const Mesh mesh = shapes::soup(400, 1);  // Its lists outgrow their memory at first.
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  for (const DistanceMode distance : {DistanceMode::Cell, DistanceMode::Raster}) {
    const FieldOptions options{.distance = distance, .sign = SignMode::Rays};
    const Field first = hostField(mesh, grid, options);
    const Counted counted;
    const Field second = hostField(mesh, grid, options);
    EXPECT_EQ(Counted::calls(), 0);
    EXPECT_EQ(Counted::submissions(), 1);
    EXPECT_TRUE(std::ranges::equal(first.distance, second.distance));
  }
}

TEST_F(VulkanGenerator, AllocatesNothingFromFrameToFrame) {
  constexpr float kStep = 0.01f;
  const bool isFast = validationFromEnvironment() == Validation::Off;
  const Mesh mesh = holedSphere(1);
  const Grid grid{{8, 8, 8}, glm::dvec3(-1.75), 0.5};
  for (const auto& [options, frames] :
       {std::pair(FieldOptions{.distance = DistanceMode::Cell, .sign = SignMode::Rays}, isFast ? 2000 : 50),
        std::pair(FieldOptions{}, isFast ? 100 : 20)}) {
    // A device without validation, which would take most of the time.
    Generator generator("vulkan");
    Device own(generator.device());
    Kernel<WaveVerticesPush> wave(own, shaders::kWaveVertices, 64);
    DeviceBuffer rest(own, "rest", MemoryUse::Upload), triangles(own, "triangles", MemoryUse::Upload),
        moved(own, "moved", MemoryUse::ReadBack), distance(own, "distance", MemoryUse::ReadBack);
    rest.resize<glm::vec3>(mesh.vertices.size());
    moved.resize<glm::vec3>(mesh.vertices.size());
    triangles.resize<glm::uvec3>(mesh.triangles.size());
    distance.resize<float>(grid.sampleCount());
    std::ranges::copy(mesh.vertices, rest.mapped<glm::vec3>().begin());
    std::ranges::copy(mesh.triangles, triangles.mapped<glm::uvec3>().begin());
    const MeshBuffers buffers{.vertices = {moved.handle(), moved.offset()},
                              .vertexCount = static_cast<uint32_t>(mesh.vertices.size()),
                              .triangles = {triangles.handle(), triangles.offset()},
                              .triangleCount = static_cast<uint32_t>(mesh.triangles.size()),
                              .origin = mesh.origin};
    CommandBuffer commandBuffer(own);
    const auto frame = [&](int number) {
      Commands commands = commandBuffer.begin();
      commands.dispatch(wave,
                        {.rest = rest.address(),
                         .moved = moved.address(),
                         .count = buffers.vertexCount,
                         .time = kStep * float(number)},
                        buffers.vertexCount);
      generator.record(commands.handle(), buffers, grid, options,
                       {.distance = {distance.handle(), distance.offset()}});
      commandBuffer.submitAndWait();
    };
    {
      const Counted counted;
      generator.reserve(roomFor(mesh, grid, options));
      EXPECT_GT(Counted::calls(), 0);
      EXPECT_EQ(Counted::submissions(), 0);
    }
    frame(0);
    const std::vector<float> first(distance.mapped<float>().begin(), distance.mapped<float>().end());
    const uint64_t held = generator.bytes();
    {
      const Counted counted;
      for (int number = 1; number < frames; ++number) frame(number);
      EXPECT_EQ(Counted::calls(), 0);
      EXPECT_EQ(Counted::submissions(), frames - 1);
    }
    EXPECT_EQ(generator.bytes(), held);
    EXPECT_FALSE(generator.status().error);
    const std::vector<float> last(distance.mapped<float>().begin(), distance.mapped<float>().end());
    EXPECT_NE(first, last);
    Mesh same = mesh;
    std::ranges::copy(moved.mapped<glm::vec3>(), same.vertices.begin());
    const Field afresh = hostField(same, grid, options);
    expectSameBits(last, afresh.distance, "the last frame");
  }
}

}  // namespace
}  // namespace raymap::vulkan
