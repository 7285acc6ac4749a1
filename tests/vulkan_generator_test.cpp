#include <raymap/raymap.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "pipeline.h"
#include "shaders/half_floats_spv.h"
#include "shaders/wave_vertices.h"
#include "shaders/wave_vertices_spv.h"
#include "shapes.h"
#include "vulkan/backend.h"
#include "vulkan/field_image.h"
#include "vulkan_device.h"

namespace raymap::vulkan {
namespace {

Mesh holedSphere(int levels = 3) {
  Mesh mesh = shapes::sphere(1.0, levels);
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.6; });
  return mesh;
}

Room roomFor(const Mesh& mesh, const Grid& grid, const Options& options) {
  return {.vertices = static_cast<uint32_t>(mesh.vertices.size()),
          .triangles = static_cast<uint32_t>(mesh.triangles.size()),
          .dims = grid.dims,
          .distance = options.distance,
          .sign = options.sign};
}

/// A 3D image of its own memory.
class Image {
 public:
  Image(const DeviceHandles& on, VkFormat format, const glm::ivec3& dims) : device_(on.device) {
    const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                 .imageType = VK_IMAGE_TYPE_3D,
                                 .format = format,
                                 .extent = {uint32_t(dims.x), uint32_t(dims.y), uint32_t(dims.z)},
                                 .mipLevels = 1,
                                 .arrayLayers = 1,
                                 .samples = VK_SAMPLE_COUNT_1_BIT,
                                 .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                          VK_IMAGE_USAGE_SAMPLED_BIT};
    check(vkCreateImage(device_, &info, nullptr, &image_), "making an image");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device_, image_, &needs);
    const VkMemoryAllocateInfo memory{
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = needs.size,
        .memoryTypeIndex = static_cast<uint32_t>(std::countr_zero(needs.memoryTypeBits))};
    check(vkAllocateMemory(device_, &memory, nullptr, &memory_), "allocating an image");
    check(vkBindImageMemory(device_, image_, memory_, 0), "binding an image");
  }
  ~Image() {
    vkDestroyImage(device_, image_, nullptr);
    vkFreeMemory(device_, memory_, nullptr);
  }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  VkImage handle() const { return image_; }

 private:
  VkDevice device_;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

/// On the device of the tests: for the generator that of a caller, whose buffers lie between guards.
class VulkanGenerator : public VulkanTest {
 protected:
  /// A mesh in buffers of the caller's.
  struct Uploaded {
    explicit Uploaded(const Mesh& mesh)
        : vertices(upload(mesh.vertices, "vertices")), triangles(upload(mesh.triangles, "triangles")) {
      buffers = {.vertices = {vertices.handle(), vertices.offset()},
                 .vertexCount = static_cast<uint32_t>(mesh.vertices.size()),
                 .triangles = {triangles.handle(), triangles.offset()},
                 .triangleCount = static_cast<uint32_t>(mesh.triangles.size()),
                 .origin = mesh.origin};
    }
    DeviceBuffer vertices, triangles;
    MeshBuffers buffers;
  };

  /// All that a target may hold, in buffers of the caller's.
  struct Outputs {
    explicit Outputs(size_t samples) {
      for (DeviceBuffer* buffer : {&distance, &triangle, &winding, &confidence})
        buffer->resize<float>(samples);
      status.resize<uint32_t>(kStatusWords);
    }
    static BufferRange range(const DeviceBuffer& buffer) { return {buffer.handle(), buffer.offset()}; }
    Target target(const Options& options) const {
      Target target{.distance = range(distance), .status = range(status)};
      if (options.triangleIds) target.triangle = range(triangle);
      if (options.winding) target.winding = range(winding);
      if (options.confidence) target.confidence = range(confidence);
      return target;
    }
    std::array<uint32_t, kStatusWords> words() const {
      std::array<uint32_t, kStatusWords> words{};
      std::ranges::copy(download<uint32_t>(status), words.begin());
      return words;
    }
    DeviceBuffer distance{device(), "distance"}, triangle{device(), "triangle"}, winding{device(), "winding"},
        confidence{device(), "confidence"}, status{device(), "status"};
  };

  /// By the host's way.
  static Field hostField(const Mesh& mesh, const Grid& grid, Options options) {
    options.orientation = Orientation::Keep;  // As frames do.
    shared();                                 // Made before it, so destroyed after it.
    static Backend backend(device());
    Field field;
    Stats stats;
    Progress progress(options, stats);
    runPipeline(backend, mesh, grid, options, progress, field);
    return field;
  }

  /// Kept from test to test: making its kernels takes longer than most tests.
  static Generator& generator() {
    shared();
    static Generator generator(device().handles());
    return generator;
  }

  static std::vector<float> distances(const Mesh& mesh, const Grid& grid, const Options& options) {
    const Uploaded uploaded(mesh);
    const Outputs outputs(grid.sampleCount());
    run([&](Commands& commands) {
      generator().record(commands.handle(), uploaded.buffers, grid, options,
                         {.distance = Outputs::range(outputs.distance)});
    });
    return download<float>(outputs.distance);
  }

  template <class T>
  static void expectSameBits(const std::vector<T>& ours, const Buffer<T>& theirs, const char* what) {
    ASSERT_EQ(ours.size(), theirs.size()) << what;
    EXPECT_EQ(0, std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof(T))) << what;
  }

  /// All results, twice.
  static void expectAsOnTheHostsWay(const Mesh& mesh, const Grid& grid, const Options& options,
                                    double outside = 0.0) {
    SCOPED_TRACE(::testing::Message()
                 << "distance " << int(options.distance) << " sign " << int(options.sign));
    const Field expected = hostField(mesh, grid, options);
    const Uploaded uploaded(mesh);
    const Outputs outputs(grid.sampleCount());
    Room room = roomFor(mesh, grid, options);
    room.outside = outside;
    generator().reserve(room);
    for (int round = 0; round < 2; ++round) {
      run([&](Commands& commands) {
        generator().record(commands.handle(), uploaded.buffers, grid, options, outputs.target(options));
      });
      const Status status = generator().status(outputs.words());
      EXPECT_FALSE(status.error) << status.error->what();
      EXPECT_EQ(generator().status().lists.entries, status.lists.entries);
      expectSameBits(download<float>(outputs.distance), expected.distance, "distance");
      if (options.triangleIds)
        expectSameBits(download<uint32_t>(outputs.triangle), expected.triangle, "triangle");
      if (options.winding) expectSameBits(download<float>(outputs.winding), expected.winding, "winding");
      if (options.confidence)
        expectSameBits(download<float>(outputs.confidence), expected.confidence, "confidence");
    }
  }

  static Options everything(DistanceMode distance, SignMode sign) {
    Options options{.distance = distance, .sign = sign};
    options.triangleIds = distance != DistanceMode::Raster;
    options.winding = options.confidence = sign != SignMode::None;
    return options;
  }

  static ErrorCode codeOf(const std::function<void()>& work) {
    try {
      work();
    } catch (const Error& error) {
      return error.code();
    }
    return {};
  }
};

TEST_F(VulkanGenerator, GivesTheFieldOfTheHostsWay) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Exact, SignMode::Harmonic));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Cell, SignMode::Rays));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Neighbours, SignMode::Paths));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Raster, SignMode::Evolution));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Exact, SignMode::None));
  Options options = everything(DistanceMode::Cell, SignMode::Harmonic);
  options.band = 2.0;
  options.invert = true;
  options.threshold = 0.3;
  expectAsOnTheHostsWay(mesh, grid, options);
}

TEST_F(VulkanGenerator, SearchesOutsideOfTheGrid) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  // The mesh reaches as far beyond the grid on every side.
  const Grid grid{.dims = {12, 12, 12}, .origin = glm::dvec3(-0.6875), .spacing = 0.125};
  const double beyond = (1.0 - 0.75) / grid.spacing;
  for (const DistanceMode distance : {DistanceMode::Cell, DistanceMode::Raster, DistanceMode::Exact})
    expectAsOnTheHostsWay(mesh, grid, everything(distance, SignMode::Rays), beyond);
  const Options options{.distance = DistanceMode::Cell, .sign = SignMode::Rays};
  Room room = roomFor(mesh, grid, options);
  room.outside = beyond - 0.1;
  generator().reserve(room);
  distances(mesh, grid, options);
  ASSERT_TRUE(generator().status().error);
  EXPECT_EQ(generator().status().error->code(), ErrorCode::Input);
  EXPECT_GT(generator().status().outside, 0u);
}

TEST_F(VulkanGenerator, FillsImages) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 15});
  for (const Options& options :
       {Options{}, Options{.distance = DistanceMode::Cell, .sign = SignMode::Rays}}) {
    const Field expected = hostField(mesh, grid, options);
    const Uploaded uploaded(mesh);
    for (const VkFormat format : {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16_SFLOAT}) {
      const Image image(device().handles(), format, grid.dims);
      DeviceBuffer texels(device(), "texels", MemoryUse::ReadBack);
      texels.resize<std::byte>(grid.sampleCount() * (format == VK_FORMAT_R32_SFLOAT ? 4 : 2));
      Room room = roomFor(mesh, grid, options);
      room.image = format;
      generator().reserve(room);
      run([&](Commands& commands) {
        const Target target{.image = image.handle(), .imageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL};
        for (int round = 0; round < 2; ++round)
          generator().record(commands.handle(), uploaded.buffers, grid, options, target);
        const VkBufferImageCopy region{
            .bufferOffset = texels.offset(),
            .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .imageExtent = {uint32_t(grid.dims.x), uint32_t(grid.dims.y), uint32_t(grid.dims.z)}};
        vkCmdCopyImageToBuffer(commands.handle(), image.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               texels.handle(), 1, &region);
      });
      if (format == VK_FORMAT_R32_SFLOAT) {
        EXPECT_EQ(0, std::memcmp(texels.mapped<float>().data(), expected.distance.data(), texels.bytes()));
        continue;
      }
      for (size_t s = 0; s < expected.distance.size(); ++s) {
        const uint16_t half = texels.mapped<uint16_t>()[s];
        const float value = glm::unpackHalf1x16(half), wanted = expected.distance[s];
        const auto distanceOf = [&](uint16_t other) { return std::abs(glm::unpackHalf1x16(other) - wanted); };
        ASSERT_LE(std::abs(value - wanted), distanceOf(half + 1)) << s;
        ASSERT_LE(std::abs(value - wanted), distanceOf(half - 1)) << s;
      }
    }
  }
}

TEST_F(VulkanGenerator, RoundsHalfFloatsToTheNearest) {
  Kernel<HalfFloatsPush> kernel(device(), shaders::kHalfFloats, 64);
  std::vector<float> values;
  for (uint32_t bits = 0; bits < 0x7c00; ++bits) {  // Every half, and what lies at and beside the middle.
    const float half = glm::unpackHalf1x16(uint16_t(bits)), next = glm::unpackHalf1x16(uint16_t(bits + 1));
    const float middle = bits == 0x7bff ? 65520.0f : 0.5f * (half + next);
    values.insert(values.end(),
                  {half, -middle, std::nextafter(middle, 0.0f), std::nextafter(middle, INFINITY)});
  }
  values.insert(values.end(), {1e6f, -3e38f, 1e-40f});
  const DeviceBuffer from = upload(values);
  DeviceBuffer to(device(), "halves");
  to.resize<uint32_t>((values.size() + 1) / 2);
  run([&](Commands& commands) {
    commands.dispatch(kernel,
                      {.values = from.address(), .halves = to.address(), .count = uint32_t(values.size())},
                      (values.size() + 1) / 2);
  });
  const auto ours = download<uint32_t>(to);
  const auto half = [&](size_t i) { return uint16_t(ours[i / 2] >> (i % 2 * 16)); };
  for (uint32_t bits = 0; bits < 0x7c00; ++bits) {
    const bool isLast = bits == 0x7bff;
    ASSERT_EQ(half(4 * bits), bits);
    ASSERT_EQ(half(4 * bits + 1), 0x8000u | (bits + (isLast ? 0 : bits & 1)));
    ASSERT_EQ(half(4 * bits + 2), bits);
    ASSERT_EQ(half(4 * bits + 3), isLast ? bits : bits + 1);
  }
  EXPECT_EQ(half(values.size() - 3), 0x7bffu);
  EXPECT_EQ(half(values.size() - 2), 0xfbffu);
  EXPECT_EQ(half(values.size() - 1), 0u);
}

TEST_F(VulkanGenerator, TakesVerticesAmongOtherData) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 20, 10);
  const Grid grid = fitGrid(mesh, {.resolution = 16});
  std::vector<float> mixed{7.0f, 8.0f};
  for (const glm::vec3& v : mesh.vertices) mixed.insert(mixed.end(), {v.x, v.y, v.z, NAN, 1e30f});
  std::vector<uint32_t> indices{99, 99, 99};
  for (const glm::uvec3& t : mesh.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  const DeviceBuffer vertices = upload(mixed), triangles = upload(indices);
  Uploaded plain(mesh);
  plain.buffers.vertices = {vertices.handle(), vertices.offset() + 8};
  plain.buffers.vertexStride = 20;
  plain.buffers.triangles = {triangles.handle(), triangles.offset() + 12};
  generator().reserve(roomFor(mesh, grid, {}));
  const Outputs outputs(grid.sampleCount());
  run([&](Commands& commands) {
    generator().record(commands.handle(), plain.buffers, grid, {},
                       {.distance = Outputs::range(outputs.distance)});
  });
  EXPECT_FALSE(generator().status().error);
  expectSameBits(download<float>(outputs.distance), hostField(mesh, grid, {}).distance, "distance");
}

TEST_F(VulkanGenerator, TakesSmallerMeshesAndOtherPlaces) {
  const Mesh large = holedSphere(4), small = shapes::box({-1, 0, 0}, {1, 1, 2});
  Mesh far = holedSphere(2);
  far.origin += 1e6;
  for (const Options& options :
       {Options{}, Options{.distance = DistanceMode::Cell, .sign = SignMode::Rays}}) {
    const Grid grid{.dims = {14, 15, 16}, .origin = glm::dvec3(-1.5), .spacing = 0.25};
    generator().reserve(roomFor(large, grid, options));
    const uint64_t held = generator().bytes();
    for (const Mesh* mesh : std::initializer_list<const Mesh*>{&large, &small, &far, &large}) {
      Grid moved = grid;
      moved.origin += mesh->origin;
      if (mesh == &far) moved.spacing = 0.21;
      expectSameBits(distances(*mesh, moved, options), hostField(*mesh, moved, options).distance, "distance");
      EXPECT_FALSE(generator().status().error) << generator().status().error->what();
    }
    EXPECT_EQ(generator().bytes(), held);
  }
}

TEST_F(VulkanGenerator, LeavesOutTrianglesThatAreNone) {
  const Mesh good = shapes::sphere(1.0, 3);
  Mesh bad = good;
  const auto count = static_cast<uint32_t>(bad.vertices.size());
  bad.vertices.emplace_back(NAN, 0.0f, 0.0f);
  bad.triangles.insert(bad.triangles.begin(), {{0, 1, count}, {1, 2, UINT32_MAX}, {2, count + 1, 3}});
  const Grid grid = fitGrid(good, {.resolution = 16});
  for (const Options& options : {Options{}, Options{.distance = DistanceMode::Cell, .sign = SignMode::Rays},
                                 Options{.distance = DistanceMode::Raster, .sign = SignMode::Paths}}) {
    generator().reserve(roomFor(bad, grid, options));
    const std::vector<float> ours = distances(bad, grid, options);
    const Status status = generator().status();
    ASSERT_TRUE(status.error);
    EXPECT_EQ(status.error->code(), ErrorCode::Input);
    EXPECT_NE(std::string(status.error->what()).find("number 0"), std::string::npos) << status.error->what();
    EXPECT_EQ(status.triangles, 3u);
    const Field expected = hostField(good, grid, options);
    for (size_t s = 0; s < ours.size(); ++s) ASSERT_NEAR(ours[s], expected.distance[s], 1e-6) << s;
    distances(good, grid, options);
    EXPECT_FALSE(generator().status().error);
  }
}

TEST_F(VulkanGenerator, SaysWhenListsOutgrowTheirRoom) {
  // Large triangles: many more cells than raymap guesses.
  const Mesh mesh = shapes::soup(400, 1);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  for (const DistanceMode distance : {DistanceMode::Cell, DistanceMode::Raster}) {
    const Options options{.distance = distance, .sign = SignMode::Rays};
    generator() = Generator(device().handles());  // With no room from before.
    Room room = roomFor(mesh, grid, options);
    generator().reserve(room);
    int rounds = 0;
    std::vector<float> ours;
    for (; rounds < 4; ++rounds) {
      ours = distances(mesh, grid, options);
      const Status status = generator().status();
      if (!status.error) break;
      ASSERT_EQ(status.error->code(), ErrorCode::Memory) << status.error->what();
      room.lists = status.lists;
      generator().reserve(room);
    }
    EXPECT_GE(rounds, 1);
    EXPECT_LE(rounds, 2);
    expectSameBits(ours, hostField(mesh, grid, options).distance, "distance");
  }
}

TEST_F(VulkanGenerator, KeepsTheStatusOfEachFrame) {
  const Mesh mesh = shapes::sphere(1.0, 2);
  Mesh bad = mesh;
  bad.triangles[4].z = UINT32_MAX;
  Mesh far = mesh;
  far.vertices[far.triangles[5].x].x = 1e30f;
  const Grid grid = fitGrid(mesh, {.resolution = 8});
  const Uploaded uploads[] = {Uploaded(bad), Uploaded(mesh), Uploaded(far)};
  const Outputs outputs[] = {Outputs(512), Outputs(512), Outputs(512)};
  generator().reserve(roomFor(mesh, grid, {}));
  EXPECT_FALSE(generator().status().error) << "before any frame";
  run([&](Commands& commands) {
    for (int i = 0; i < 3; ++i)
      generator().record(commands.handle(), uploads[i].buffers, grid, {}, outputs[i].target({}));
  });
  EXPECT_EQ(generator().status(outputs[0].words()).triangles, 1u);
  EXPECT_FALSE(generator().status(outputs[1].words()).error);
  ASSERT_TRUE(generator().status(outputs[2].words()).error);
  EXPECT_EQ(generator().status().error->code(), ErrorCode::Input);
  EXPECT_NE(std::string(generator().status().error->what()).find("too far"), std::string::npos);
}

TEST_F(VulkanGenerator, RefusesWhatItHasNoRoomFor) {
  const Mesh mesh = shapes::sphere(1.0, 1);
  const Grid grid = fitGrid(mesh, {.resolution = 8});
  const Uploaded uploaded(mesh);
  const Outputs outputs(grid.sampleCount());
  const Target target{.distance = Outputs::range(outputs.distance)};
  CommandBuffer own(device());
  const VkCommandBuffer commands = own.begin().handle();
  const auto refuses = [&](const MeshBuffers& m, const Grid& g, const Options& o, const Target& t) {
    EXPECT_EQ(codeOf([&] { generator().record(commands, m, g, o, t); }), ErrorCode::Usage);
  };
  generator() = Generator(device().handles());
  refuses(uploaded.buffers, grid, {}, target);  // No room at all.
  for (const auto& spoil : std::initializer_list<void (*)(Room&)>{
           [](Room& room) { room.vertices = 0; }, [](Room& room) { room.triangles = UINT32_MAX; },
           [](Room& room) { room.dims.y = 0; }, [](Room& room) { room.dims = glm::ivec3(1 << 20); },
           [](Room& room) { room.image = VK_FORMAT_R8_UNORM; }, [](Room& room) { room.outside = NAN; }}) {
    Room room = roomFor(mesh, grid, {});
    spoil(room);
    EXPECT_EQ(codeOf([&] { generator().reserve(room); }), ErrorCode::Usage);
    refuses(uploaded.buffers, grid, {}, target);
  }
  generator().reserve(roomFor(mesh, grid, {}));
  for (const auto& spoil : std::initializer_list<void (*)(MeshBuffers&)>{
           [](MeshBuffers& m) { ++m.vertexCount; }, [](MeshBuffers& m) { ++m.triangleCount; },
           [](MeshBuffers& m) { m.vertexStride = 8; }, [](MeshBuffers& m) { m.vertexStride = 13; },
           [](MeshBuffers& m) { m.vertices.offset += 2; }, [](MeshBuffers& m) { m.triangles.buffer = {}; }}) {
    MeshBuffers spoilt = uploaded.buffers;
    spoil(spoilt);
    refuses(spoilt, grid, {}, target);
  }
  refuses(uploaded.buffers, {grid.dims + 1, grid.origin, grid.spacing}, {}, target);
  refuses(uploaded.buffers, {grid.dims, grid.origin, 0.0}, {}, target);
  refuses(uploaded.buffers, grid, {.distance = DistanceMode::Cell}, target);
  refuses(uploaded.buffers, grid, {.sign = SignMode::Rays}, target);
  refuses(uploaded.buffers, grid, {}, {});
  for (const Options& options : {Options{.closeHoles = true}, Options{.orientation = Orientation::Repair}})
    EXPECT_EQ(codeOf([&] { generator().record(commands, uploaded.buffers, grid, options, target); }),
              ErrorCode::Unsupported);
  EXPECT_EQ(codeOf([] { Generator none(DeviceHandles{}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([] { Generator none("vulkan:99"); }), ErrorCode::Unsupported);
  EXPECT_EQ(codeOf([] { Generator none("cpu"); }), ErrorCode::Unsupported);
}

/// Vulkan's functions that a frame may not call, counted while this lives.
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
  /// Those of a frame are the test's own; the host's way has one.
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
  /// Vulkan's own, kept when first asked for: before the first count.
  static const Functions& before() {
    static const Functions functions;
    return functions;
  }
  const Functions& keep_ = before();
};

TEST_F(VulkanGenerator, ReadsNothingBackOnTheHostsWay) {
  const Mesh mesh = shapes::soup(400, 1);  // Its lists outgrow their room at first.
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  for (const DistanceMode distance : {DistanceMode::Cell, DistanceMode::Raster}) {
    const Options options{.distance = distance, .sign = SignMode::Rays};
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
       {std::pair(Options{.distance = DistanceMode::Cell, .sign = SignMode::Rays}, isFast ? 10000 : 50),
        std::pair(Options{}, isFast ? 100 : 20)}) {
    // Without validation, which would take all of the time.
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
