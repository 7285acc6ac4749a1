#include "vulkan_generation.h"

namespace raymap::vulkan {
namespace {

TEST_F(VulkanGenerator, MatchesTheBackendOfTheHost) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Cell, SignMode::Rays));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Neighbours, SignMode::Paths));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Raster, SignMode::Evolution));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Exact, SignMode::None));
  expectAsOnTheHostsWay(mesh, grid, everything(DistanceMode::Cell, SignMode::Ray));
  FieldOptions sampled = everything(DistanceMode::Cell, SignMode::Evolution);
  sampled.sampling = Sampling::Paper;
  expectAsOnTheHostsWay(mesh, grid, sampled);
  // The host takes rims, which the device does not know, unless they are so many.
  const Mesh soup = shapes::soup(1400, 4);
  const Grid around = fitGrid(soup, {.resolution = 12});
  expectAsOnTheHostsWay(soup, around, everything(DistanceMode::Exact, SignMode::Harmonic));
  FieldOptions options = everything(DistanceMode::Exact, SignMode::Harmonic);
  options.band = 2.0;
  options.invert = true;
  options.threshold = 0.3;
  expectAsOnTheHostsWay(soup, around, options);
}

TEST_F(VulkanGenerator, SearchesOutsideOfTheGrid) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  // The mesh reaches equally far beyond the grid on every side.
  const Grid grid{.dims = {12, 12, 12}, .origin = glm::dvec3(-0.6875), .spacing = 0.125};
  const double beyond = (1.0 - 0.75) / grid.spacing;
  for (const DistanceMode distance : {DistanceMode::Cell, DistanceMode::Raster, DistanceMode::Exact})
    expectAsOnTheHostsWay(mesh, grid, everything(distance, SignMode::Rays), beyond);
  const FieldOptions options{.distance = DistanceMode::Cell, .sign = SignMode::Rays};
  Room room = roomFor(mesh, grid, options);
  room.outside = beyond - 0.1;
  generator().reserve(room);
  distances(mesh, grid, options);
  ASSERT_TRUE(generator().status().error);
  EXPECT_EQ(generator().status().error->code(), ErrorCode::Input);
  EXPECT_GT(generator().status().outside, 0u);
}

TEST_F(VulkanGenerator, AcceptsVerticesAmongOtherData) {
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

TEST_F(VulkanGenerator, MakesTheFarFieldOfAnEmptyMesh) {
  const Mesh ball = shapes::sphere(1.0, 2);
  const Grid grid = fitGrid(ball, {.resolution = 9});
  FieldOptions options = everything(DistanceMode::Exact, SignMode::Harmonic);
  generator().reserve(roomFor(ball, grid, options));
  const Outputs outputs(grid.sampleCount());
  const auto record = [&] {
    run([&](Commands& commands) {
      generator().record(commands.handle(), {}, grid, options, outputs.target(options));
    });
  };
  EXPECT_THROW(record(), Error);
  options.allowEmpty = true;
  for (const double band : {0.0, 3.0})
    for (const bool invert : {false, true}) {
      options.band = band;
      options.invert = invert;
      distances(ball, grid, options);  // The status of another frame must not stay.
      record();
      const Field expected = generate(Mesh{}, grid, options).field;
      expectSameBits(download<float>(outputs.distance), expected.distance, "distance");
      expectSameBits(download<uint32_t>(outputs.triangle), expected.triangle, "triangle");
      expectSameBits(download<float>(outputs.winding), expected.winding, "winding");
      expectSameBits(download<float>(outputs.confidence), expected.confidence, "confidence");
      EXPECT_FALSE(generator().status().error);
      EXPECT_FALSE(generator().status(outputs.written()).error);
      EXPECT_EQ(generator().status(outputs.written()).doubtfulShare, 0.0);
    }
}

TEST_F(VulkanGenerator, AcceptsSmallerMeshesAndOtherPlaces) {
  const Mesh large = holedSphere(4), small = shapes::box({-1, 0, 0}, {1, 1, 2});
  Mesh far = holedSphere(2);
  far.origin += 1e6;
  for (const FieldOptions& options :
       {FieldOptions{}, FieldOptions{.distance = DistanceMode::Cell, .sign = SignMode::Rays}}) {
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

}  // namespace
}  // namespace raymap::vulkan
