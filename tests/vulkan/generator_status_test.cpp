#include "error_code.h"
#include "vulkan_generation.h"

namespace raymap::vulkan {
namespace {

TEST_F(VulkanGenerator, LeavesOutInvalidTriangles) {
  const Mesh good = shapes::sphere(1.0, 3);
  Mesh bad = good;
  const auto count = static_cast<uint32_t>(bad.vertices.size());
  bad.vertices.emplace_back(NAN, 0.0f, 0.0f);
  bad.triangles.insert(bad.triangles.begin(), {{0, 1, count}, {1, 2, UINT32_MAX}, {2, count + 1, 3}});
  const Grid grid = fitGrid(good, {.resolution = 16});
  for (const FieldOptions& options :
       {FieldOptions{}, FieldOptions{.distance = DistanceMode::Cell, .sign = SignMode::Rays},
        FieldOptions{.distance = DistanceMode::Raster, .sign = SignMode::Paths}}) {
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

TEST_F(VulkanGenerator, ReportsListsThatOutgrowTheirCapacity) {
  // Large triangles touch many more cells than raymap guesses.
  const Mesh mesh = shapes::soup(400, 1);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  for (const DistanceMode distance : {DistanceMode::Cell, DistanceMode::Raster}) {
    const FieldOptions options{.distance = distance, .sign = SignMode::Rays};
    generator() = Generator(device().handles());  // A new generator has no capacity from before.
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
  EXPECT_EQ(generator().status(outputs[0].written()).triangles, 1u);
  const std::vector<std::byte> cut(statusBytes() - 1);
  EXPECT_EQ(codeOf([&] { generator().status(cut); }), ErrorCode::Usage);
  EXPECT_FALSE(generator().status(outputs[1].written()).error);
  ASSERT_TRUE(generator().status(outputs[2].written()).error);
  EXPECT_EQ(generator().status().error->code(), ErrorCode::Input);
  EXPECT_NE(std::string(generator().status().error->what()).find("too far"), std::string::npos);
}

TEST_F(VulkanGenerator, RefusesWhatExceedsItsCapacity) {
  const Mesh mesh = shapes::sphere(1.0, 1);
  const Grid grid = fitGrid(mesh, {.resolution = 8});
  const Uploaded uploaded(mesh);
  const Outputs outputs(grid.sampleCount());
  const Target target{.distance = Outputs::range(outputs.distance)};
  CommandBuffer own(device());
  const VkCommandBuffer commands = own.begin().handle();
  const auto refuses = [&](const MeshBuffers& m, const Grid& g, const FieldOptions& o, const Target& t) {
    EXPECT_EQ(codeOf([&] { generator().record(commands, m, g, o, t); }), ErrorCode::Usage);
  };
  generator() = Generator(device().handles());
  refuses(uploaded.buffers, grid, {}, target);  // Nothing is reserved.
  for (const auto& spoil : std::initializer_list<void (*)(Room&)>{
           [](Room& room) { room.vertices = 0; }, [](Room& room) { room.triangles = UINT32_MAX; },
           [](Room& room) { room.dims.y = 0; }, [](Room& room) { room.dims = glm::ivec3(1 << 20); },
           [](Room& room) { room.image = VK_FORMAT_R8_UNORM; }, [](Room& room) { room.outside = NAN; }}) {
    Room room = roomFor(mesh, grid, {});
    spoil(room);
    EXPECT_EQ(codeOf([&] { generator().reserve(room); }), ErrorCode::Usage);
    refuses(uploaded.buffers, grid, {}, target);
  }
  EXPECT_EQ(codeOf([&] { generator().reserve(roomFor(mesh, grid, {.sign = SignMode::Exact})); }),
            ErrorCode::Unsupported);
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
  refuses(uploaded.buffers, {grid.dims, {0.0, NAN, 0.0}, grid.spacing}, {}, target);
  refuses(uploaded.buffers, grid, {.distance = DistanceMode::Cell}, target);
  refuses(uploaded.buffers, grid, {.sign = SignMode::Rays}, target);
  refuses(uploaded.buffers, grid, {}, {});
  for (const FieldOptions& options :
       {FieldOptions{.closeHoles = true}, FieldOptions{.orientation = Orientation::Repair}})
    EXPECT_EQ(codeOf([&] { generator().record(commands, uploaded.buffers, grid, options, target); }),
              ErrorCode::Unsupported);
  EXPECT_EQ(codeOf([] { Generator none(DeviceHandles{}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([] { Generator none("vulkan:99"); }), ErrorCode::Unsupported);
  EXPECT_EQ(codeOf([] { Generator none("cpu"); }), ErrorCode::Unsupported);
}

}  // namespace
}  // namespace raymap::vulkan
