// Skins and pictures that a caller records into its own command buffer.

#include <raymap/raymap.h>

#include <algorithm>
#include <limits>
#include <utility>

#include <functional>

#include "analytic_fields.h"
#include "bands.h"
#include "counters/work_counter.h"
#include "error_code.h"
#include "pictures.h"
#include "shapes.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

#include <raymap/vulkan.h>

namespace raymap::vulkan {
namespace {

class VulkanFrames : public VulkanTest {
 protected:
  static BufferRange range(const DeviceBuffer& buffer) { return {buffer.handle(), buffer.offset()}; }

  static std::vector<uint32_t> draw(Renderer& renderer, const FieldBuffer& field,
                                    const RenderOptions& options) {
    DeviceBuffer pixels(device(), "pixels");
    pixels.resize<uint32_t>(size_t(options.width) * size_t(options.height));
    run([&](Commands& commands) {
      renderer.record(commands.handle(), field, options, {.pixels = range(pixels)});
    });
    return download<uint32_t>(pixels);
  }

  static ErrorCode refusal(const std::function<void(VkCommandBuffer)>& record) {
    ErrorCode code{};
    run([&](Commands& commands) {
      try {
        record(commands.handle());
        ADD_FAILURE() << "not refused";
      } catch (const Error& error) {
        code = error.code();
      }
    });
    return code;
  }
};

TEST_F(VulkanFrames, MoveSkinsAsTheCpuDoes) {
  const AnimatedMesh mesh = wanderers(shapes::sphere(1.0, 3), 2);
  const DeviceBuffer rest = upload(mesh.rest.vertices), joints = upload(mesh.joints),
                     weights = upload(mesh.weights), matrices = upload(jointMatrices(mesh, 0.0));
  DeviceBuffer moved(device(), "moved");
  moved.resize<glm::vec3>(mesh.rest.vertices.size());
  const SkinBuffers skin{.rest = range(rest),
                         .joints = range(joints),
                         .weights = range(weights),
                         .matrices = range(matrices),
                         .vertexCount = uint32_t(mesh.rest.vertices.size()),
                         .jointCount = 2};
  Skinner skinner(device().handles());
  run([&](Commands& commands) { skinner.record(commands.handle(), skin, range(moved)); });
  const std::vector<glm::vec3> ours = download<glm::vec3>(moved), theirs = posed(mesh, 0.0).vertices;
  for (size_t v = 0; v < ours.size(); ++v) EXPECT_LE(glm::distance(ours[v], theirs[v]), 1e-5);

  const auto refused = [&](const auto& change) {
    SkinBuffers changed = skin;
    change(changed);
    return refusal([&](VkCommandBuffer commands) { skinner.record(commands, changed, range(moved)); });
  };
  EXPECT_EQ(codeOf([&] { skinner.record(VK_NULL_HANDLE, skin, range(moved)); }), ErrorCode::Usage);
  EXPECT_EQ(refused([](SkinBuffers& s) { s.rest = {}; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](SkinBuffers& s) { s.weights = {}; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](SkinBuffers& s) { s.weights.offset += 4; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](SkinBuffers& s) { s.joints.offset += 2; }), ErrorCode::Usage);
}

TEST_F(VulkanFrames, DrawNumbersAndDifferencesInColour) {
  using analytic::sampled;
  const Grid grid = analytic::cube(32, 2.0);
  const auto torus = [](const glm::dvec3& p) { return analytic::torus(p, 0.6, 0.25); };
  Field field = sampled(grid, torus);
  field.winding = sampled(grid, [](const glm::dvec3& p) { return 3.0 * p.x; }).distance;
  const Field other = sampled(grid, [&](const glm::dvec3& p) { return torus(p) + 0.1 * p.y; });
  const DeviceBuffer samples = upload(field.distance), winding = upload(field.winding),
                     second = upload(other.distance);
  DeviceBuffer pixels(device(), "pixels");
  pixels.resize<uint32_t>(80 * 60);
  Renderer renderer(device().handles());
  RenderOptions options{.width = 80,
                        .height = 60,
                        .frame = Box{glm::dvec3(-1.0), glm::dvec3(1.0)},
                        .cutPlane = Plane{{1.0, 0.0, 0.5}, 0.1}};
  const auto drawn = [&](const DeviceBuffer& values) {
    return pictureOf(
        draw(renderer, {.distance = range(samples), .grid = grid, .values = range(values)}, options), 80, 60);
  };
  options.array = FieldArray::Winding;
  requireSamePicture(drawn(winding), renderField(field, options));
  EXPECT_EQ(refusal([&](VkCommandBuffer commands) {
              renderer.record(commands, {.distance = range(samples), .grid = grid}, options,
                              {.pixels = range(pixels)});
            }),
            ErrorCode::Usage);
  options.array = FieldArray::Distance;
  options.range = 0.05;
  const Picture ours = drawn(second);
  options.other = &other;
  requireSamePicture(ours, renderField(field, options));
}

TEST_F(VulkanFrames, EndTheSearchInAForeignIndexOfLeaves) {
  constexpr uint32_t kNodes = 8, kCubes = kNodes + 512;
  std::vector<uint32_t> words(kCubes + 64, 0);  // All slots lead to the root, or to leaf 0.
  words[7] = kCubes;
  const DeviceBuffer samples = upload(std::vector<float>(512, -1.0f));
  const Grid grid{glm::ivec3(20), glm::dvec3(0.0), 1.0};
  Renderer renderer(device().handles());
  for (const uint32_t rootBits : {0u, 29u, 31u, 0x7fffffffu}) {
    words[0] = rootBits;
    const DeviceBuffer index = upload(words);
    const FieldBuffer onDevice{.distance = range(samples),
                               .grid = grid,
                               .band = {.leafIndex = range(index), .inside = 2.0, .outside = 2.0}};
    const RenderOptions options{.width = 16, .height = 16, .frame = Box{glm::vec3(0.0f), glm::vec3(19.0f)}};
    EXPECT_EQ(draw(renderer, onDevice, options).size(), 256u) << rootBits;
  }
}

TEST_F(VulkanFrames, DrawANarrowBand) {
  std::vector<Field> bands = someBands();
  const Field& band = bands[1];
  ASSERT_NE(band.narrow->inside, band.narrow->outside);
  const DeviceBuffer samples = upload(band.distance), index = upload(packLeafIndex(band));
  DeviceBuffer pixels(device(), "pixels");
  pixels.resize<uint32_t>(80 * 60);
  FieldBuffer onDevice{
      .distance = range(samples),
      .grid = band.grid,
      .band = {.leafIndex = range(index), .inside = band.narrow->inside, .outside = band.narrow->outside}};
  RenderOptions options{.width = 80, .height = 60, .frame = band.surfaceBounds};
  Renderer renderer(device().handles());
  for (const double iso : {0.0, -0.8 * band.narrow->inside, 0.8 * band.narrow->outside}) {
    options.iso = iso;
    requireSamePicture(pictureOf(draw(renderer, onDevice, options), 80, 60),
                       renderField(band, options, {.device = "cpu"}));
  }
  const auto refused = [&] {
    return refusal([&](VkCommandBuffer commands) {
      renderer.record(commands, onDevice, options, {.pixels = range(pixels)});
    });
  };
  for (const double iso : {-band.narrow->inside, band.narrow->outside}) {
    options.iso = iso;
    EXPECT_EQ(refused(), ErrorCode::Usage);
  }
  options.iso = 0.0;
  onDevice.values = range(samples);
  EXPECT_EQ(refused(), ErrorCode::Usage);
  bands[1].narrow->leaves[0].x += 1;
  EXPECT_EQ(codeOf([&] { packLeafIndex(band); }), ErrorCode::Usage);
}

TEST_F(VulkanFrames, DrawThePicturesOfTheCpu) {
  Field field = analytic::sampled(analytic::cube(32, 2.0), [](const glm::dvec3& p) {
    return std::clamp(analytic::torus(p, 0.6, 0.25), -0.3, 0.3);
  });
  field.clampDistance = 0.3;
  const RenderOptions options{.width = 80, .height = 60, .frame = Box{glm::dvec3(-1.0), glm::dvec3(1.0)}};
  const DeviceBuffer samples = upload(field.distance);
  DeviceBuffer pixels(device(), "pixels");
  pixels.resize<uint32_t>(80 * 60);
  const FieldBuffer onDevice{
      .distance = range(samples), .grid = field.grid, .clampDistance = field.clampDistance};
  Renderer renderer(device().handles());
  const std::vector<uint32_t> whole = draw(renderer, onDevice, options);
  for (const uint32_t pixel : whole) EXPECT_EQ(pixel >> 24, 255U);
  requireSamePicture(pictureOf(whole, 80, 60), renderField(field, options));

  // The same in parts, with the depth: the largest float in a corner, less than to the far side in the
  // middle.
  DeviceBuffer parts(device(), "parts"), depth(device(), "depth");
  parts.resize<uint32_t>(80 * 60);
  depth.resize<float>(80 * 60);
  for (const auto& [first, rows] : {std::pair(0, 25), std::pair(25, 0)})
    run([&, firstRow = first, count = rows](Commands& commands) {
      renderer.record(commands.handle(), onDevice, options,
                      {.pixels = range(parts), .depth = range(depth), .firstRow = firstRow, .rows = count});
    });
  EXPECT_EQ(download<uint32_t>(parts), whole);
  const std::vector<float> depths = download<float>(depth);
  EXPECT_EQ(depths.front(), std::numeric_limits<float>::max());
  EXPECT_GT(std::ranges::count_if(depths, [](float d) { return d < 20.0F; }), 400);
  for (const auto& [first, rows] : {std::pair(-1, 10), std::pair(60, 0), std::pair(50, 11), std::pair(0, -1)})
    EXPECT_EQ(refusal([&, firstRow = first, count = rows](VkCommandBuffer commands) {
                renderer.record(commands, onDevice, options,
                                {.pixels = range(pixels), .firstRow = firstRow, .rows = count});
              }),
              ErrorCode::Usage)
        << first << " " << rows;

  const auto refused = [&](const auto& change) {
    FieldBuffer changed = onDevice;
    RenderOptions asked = options;
    change(changed, asked);
    return refusal([&](VkCommandBuffer commands) {
      renderer.record(commands, changed, asked, {.pixels = range(pixels)});
    });
  };
  EXPECT_EQ(codeOf([&] { renderer.record(VK_NULL_HANDLE, onDevice, options, {.pixels = range(pixels)}); }),
            ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) { f.distance = {}; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) { f.grid.dims.y = 0; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) { f.grid.spacing = 0; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) { f.rotation = {0, 0, 0, 0}; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) { f.rotation.y = NAN; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) { f.translation.z = INFINITY; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer&, RenderOptions& o) { o.frame.reset(); }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer&, RenderOptions& o) { o.width = 0; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer&, RenderOptions& o) { o.shell = 0.4; }), ErrorCode::Usage);
  EXPECT_EQ(refused([](FieldBuffer& f, RenderOptions&) {
              f.grid.dims = {2048, 2048, 2048};
            }),
            ErrorCode::Unsupported);
}

TEST_F(VulkanFrames, CountTheStepsOfRays) {
  const Field field = analytic::sampled(analytic::cube(32, 2.0),
                                        [](const glm::dvec3& p) { return analytic::torus(p, 0.6, 0.25); });
  const DeviceBuffer samples = upload(field.distance);
  const FieldBuffer onDevice{.distance = range(samples), .grid = field.grid};
  constexpr int kWidth = 80, kHeight = 60;
  DeviceBuffer pixels(device(), "pixels"), depth(device(), "depth");
  pixels.resize<uint32_t>(kWidth * kHeight);
  depth.resize<float>(kWidth * kHeight);
  Renderer renderer(device().handles());
  const auto record = [&](const RenderOptions& options, const BufferRange& steps, int first, int rows) {
    run([&](Commands& commands) {
      renderer.record(
          commands.handle(), onDevice, options,
          {.pixels = range(pixels), .depth = range(depth), .steps = steps, .firstRow = first, .rows = rows});
    });
  };
  const auto stepsOf = [&](const RenderOptions& options, std::initializer_list<std::pair<int, int>> parts) {
    const DeviceBuffer steps = upload(std::vector<uint32_t>{7});
    for (const auto& [first, rows] : parts) record(options, range(steps), first, rows);
    return download<uint32_t>(steps).at(0) - 7;
  };
  RenderOptions options{.width = kWidth, .height = kHeight, .frame = Box{glm::dvec3(-1.0), glm::dvec3(1.0)}};
  record(options, {}, 0, 0);
  const std::vector<uint32_t> uncounted = download<uint32_t>(pixels);
  const uint32_t whole = stepsOf(options, {{0, 0}});
  EXPECT_EQ(download<uint32_t>(pixels), uncounted);
  const std::vector<float> depths = download<float>(depth);
  const auto hits = uint32_t(std::ranges::count_if(depths, [](float d) { return d < 20.0F; }));
  EXPECT_GT(whole, 3 * hits);
  EXPECT_LT(whole, 60 * hits);
  EXPECT_EQ(stepsOf(options, {{0, 25}, {25, 0}}), whole);
  // Seen from far away, most rays pass by the ball around the shape, and take no step.
  options.eye = glm::dvec3(0.0, 0.0, 400.0);
  options.direction = {0.0, 0.0, -1.0};
  EXPECT_LT(stepsOf(options, {{0, 0}}), 400u);
  // Numbers in colour have a kernel of their own.
  FieldBuffer coloured = onDevice;
  coloured.values = range(samples);
  options.eye.reset();
  options.direction = RenderOptions().direction;
  const DeviceBuffer steps = upload(std::vector<uint32_t>{0});
  run([&](Commands& commands) {
    renderer.record(commands.handle(), coloured, options, {.pixels = range(pixels), .steps = range(steps)});
  });
  EXPECT_EQ(download<uint32_t>(steps).at(0), whole);
}

// These turns take the grid's axes to each other, so that the field of the moved shape has the same samples.
TEST_F(VulkanFrames, DrawAFieldThatHasMoved) {
  const Field field = analytic::sampled(analytic::cube(40, 2.0), analytic::notchedBox);
  const DeviceBuffer samples = upload(field.distance);
  Renderer renderer(device().handles());
  const glm::dvec3 translation(3.0, -0.7, 0.4);
  const glm::dquat rotations[] = {{1, 0, 0, 0}, {3, 3, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {0.5, -0.5, 0.5, 0.5}};
  for (const glm::dquat& rotation : rotations) {
    const glm::dmat3 back = glm::mat3_cast(glm::conjugate(glm::normalize(rotation)));
    Grid grid = field.grid;
    grid.origin += translation;
    const Field moved = analytic::sampled(
        grid, [&](const glm::dvec3& p) { return analytic::notchedBox(back * (p - translation)); });
    RenderOptions options{
        .width = 120,
        .height = 90,
        .direction = {-1.0, -0.5, -0.6},
        .shell = 0.2,
        .frame = Box{translation - glm::dvec3(0.8, 1.0, 0.9), translation + glm::dvec3(0.9)},
        .eye = translation + glm::dvec3(3.1, 1.6, 2.0)};
    for (const bool isOpen : {false, true}) {
      if (isOpen) options.cutPlane = Plane{{1.0, 0.2, 0.3}, 3.1};
      if (isOpen) options.slice = Plane{{0.1, 1.0, 0.2}, -0.2};
      const FieldBuffer onDevice{
          .distance = range(samples), .grid = field.grid, .rotation = rotation, .translation = translation};
      requireSamePicture(pictureOf(draw(renderer, onDevice, options), 120, 90),
                         renderField(moved, options, {.device = "cpu"}));
    }
  }
}

// The gate of the harmonic solve is shut, but its steps are recorded.
TEST_F(VulkanFrames, TakeFewSteps) {
  WorkCounter counter(Measured::Time);
  Device counted{DeviceOptions{}};
  counter.start(counted);
  {
    const Probe probe(counted);
    Generator generator(counted.handles());
    const Mesh mesh = shapes::sphere(1.0, 3);
    const Grid grid = fitGrid(mesh, {.resolution = 32});
    const DeviceBuffer vertices = probe.upload(mesh.vertices), triangles = probe.upload(mesh.triangles);
    const MeshBuffers buffers{.vertices = range(vertices),
                              .vertexCount = uint32_t(mesh.vertices.size()),
                              .triangles = range(triangles),
                              .triangleCount = uint32_t(mesh.triangles.size())};
    DeviceBuffer distance(counted, "distance"), status(counted, "status");
    distance.resize<float>(grid.sampleCount());
    status.resize<std::byte>(statusBytes());
    const auto stepsOf = [&](const FieldOptions& options) {
      generator.reserve({.vertices = buffers.vertexCount,
                         .triangles = buffers.triangleCount,
                         .dims = grid.dims,
                         .distance = options.distance,
                         .sign = options.sign});
      counter.clear();
      probe.run([&](Commands& commands) {
        generator.record(commands.handle(), buffers, grid, options,
                         {.distance = range(distance), .status = range(status)});
      });
      EXPECT_FALSE(generator.status().error);
      return counter.commands().back().step + 1 - counter.commands().front().step;
    };
    EXPECT_LE(stepsOf({}), 45U);
    EXPECT_LE(stepsOf({.distance = DistanceMode::Cell, .sign = SignMode::Rays}), 25U);
  }
  counter.stop();
}

}  // namespace
}  // namespace raymap::vulkan
