// The CPU and Vulkan give the same fields.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <random>

#include "any_threads.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "vulkan/self_test/compare.h"
#include "vulkan_device.h"

namespace raymap {
namespace {

const MachineOptions kCpu{.device = "cpu"}, kGpu{.device = "vulkan"};

class Backends : public vulkan::VulkanTest {
 protected:
  static FieldOptions everything() {
    FieldOptions options;
    options.winding = options.confidence = options.triangle = true;
    return options;
  }

  static Field make(const Mesh& mesh, const Grid& grid, const FieldOptions& options,
                    const ProgressCallback& progress = {}) {
    auto [field, stats] = generate(mesh, grid, options, {.device = "vulkan", .progress = progress});
    EXPECT_TRUE(stats.device.starts_with("vulkan")) << stats.device;
    return std::move(field);
  }

  /// Compares the fields and the findings. Returns those of the CPU.
  static Stats compare(const Mesh& mesh, const GridOptions& grid, const FieldOptions& options = {}) {
    return compareFields(kept<vulkan::Backend>(), std::to_string(mesh.triangles.size()) + " faces", mesh,
                         grid, options);
  }

  /// Expects that the CPU chooses the same faces on grids that lie a little beside this one. On open meshes
  /// their misfits differ by some 1e-3; those of the backends by less than 1e-4. No choice is then so close
  /// that rounding may decide it.
  static void expectDecisive(const Mesh& mesh, const GridOptions& grid, const FieldOptions& options,
                             const Stats& stats) {
    for (const double shift : {-1e-3, 1e-3}) {
      Grid beside = fitGrid(mesh, grid);
      beside.origin += shift * beside.spacing;
      Generator generator;
      Field field;
      const Stats other = generator.generate(mesh, beside, options, field, kCpu);
      EXPECT_EQ(other.turnedFaces, stats.turnedFaces) << "a close choice: test another mesh";
      EXPECT_EQ(other.leftOutFaces, stats.leftOutFaces) << "a close choice: test another mesh";
    }
  }
};

TEST_F(Backends, GiveTheSameField) {
  for (const Mesh& mesh :
       {shapes::sphere(1.0, 4), holedSphere(4), shapes::soup(500, 3), shapes::torus(1.0, 0.3, 40, 20)})
    compare(mesh, {.resolution = 32});
}

TEST_F(Backends, TurnTheSameFaces) {
  const Mesh pair = shapes::joined(holedSphere(4), shapes::sphere(0.8, 3, {0.6, 0.2, 0.0}));
  const Mesh soup = withMovedCorners(shapes::sphere(1.0, 3), 1e-4, 7);
  struct Case {
    Mesh mesh;
    SignMode sign = SignMode::Harmonic;
    Orientation orientation = Orientation::Auto;
  };
  for (const auto& [mesh, sign, orientation] : std::initializer_list<Case>{
           {withFlippedFaces(holedSphere(4), 0.1, 10)},
           {withFlippedFaces(pair, 0.33, 3)},
           {withFlippedFaces(soup, 0.33, 3)},
           {withFlippedFaces(soup, 0.5, 2)},
           {withFlippedFaces(holedSphere(4), 0.33, 3), SignMode::Paths, Orientation::Repair}}) {
    const FieldOptions options{.sign = sign, .orientation = orientation};
    const Stats stats = compare(mesh, {.resolution = 32}, options);
    EXPECT_FALSE(stats.turnedFaces.empty());
    expectDecisive(mesh, {.resolution = 32}, options, stats);
  }
}

/// Reverses this many faces, chosen at random.
Mesh withReversed(Mesh mesh, size_t count, unsigned seed) {
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(seed));
  for (size_t f = 0; f < count; ++f) std::swap(mesh.triangles[f].y, mesh.triangles[f].z);
  return mesh;
}

// A patch that points either way about as often begins as the parity says, which is read before any face is
// reversed. The last run's reversed faces are the larger part: with them, the parity says the opposite.
TEST_F(Backends, ForgetTheFacesThatTheLastRunReversed) {
  const Mesh sphere = shapes::sphere(1.0, 3);
  const size_t faces = sphere.triangles.size();
  const Mesh before = withReversed(sphere, faces * 53 / 100, 1), mesh = withReversed(sphere, faces / 2, 2);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  const FieldOptions options = everything();
  Generator used;
  Field field;
  ASSERT_EQ(used.generate(before, grid, options, field, kGpu).turnedFaces.size(), faces * 53 / 100);
  const Stats stats = used.generate(mesh, grid, options, field, kGpu);
  const Generated fresh = generate(mesh, grid, options, kGpu);
  EXPECT_EQ(fresh.stats.turnedFaces.size(), faces / 2);
  EXPECT_EQ(stats.turnedFaces, fresh.stats.turnedFaces);
  EXPECT_EQ(stats.misfit, fresh.stats.misfit);
  EXPECT_EQ(stats.misfitGiven, fresh.stats.misfitGiven);
  EXPECT_TRUE(std::ranges::equal(field.winding, fresh.field.winding));
  EXPECT_TRUE(std::ranges::equal(field.distance, fresh.field.distance));
}

TEST_F(Backends, TakeTheSameDoubleSidedFaces) {
  const Mesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  const Mesh open = keepTriangles(box, [&](const glm::uvec3& t) {
    return box.position(t.x).z + box.position(t.y).z + box.position(t.z).z < 2.9;
  });
  const Mesh ball = shapes::sphere(1.0, 3);
  const Mesh holed = keepTriangles(ball, [&](const glm::uvec3& t) { return ball.position(t.x).z < 0.8; });
  const Mesh pair = shapes::joined(holed, shapes::sphere(0.8, 3, {0.6, 0.2, 0.0}));
  Mesh half = ball;  // The northern half is double-sided.
  for (const glm::uvec3& t : ball.triangles)
    if (ball.position(t.x).z + ball.position(t.y).z + ball.position(t.z).z > 0.0)
      half.triangles.emplace_back(t.x, t.z, t.y);
  struct Case {
    Mesh mesh;
    bool isSolid = true;
  };
  for (const auto& [mesh, isSolid] : std::initializer_list<Case>{
           {withDoubledFaces(box, 1.0, 1)},
           {withDoubledFaces(holed, 1.0, 1)},
           {withDoubledFaces(ball, 0.4, 1)},
           {withDoubledFaces(withFlippedFaces(pair, 0.33, 3), 0.5, 1)},
           {half},
           {withDoubledFaces(shapes::joined(box, shapes::box({0.3, 0.2, 0.1}, {0.6, 0.6, 0.6})), 1.0, 1)},
           {withDoubledFaces(shapes::joined(box, shapes::box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5})), 1.0, 1)},
           {withDoubledFaces(open, 1.0, 1), false}}) {
    const Stats stats = compare(mesh, {.resolution = 32});
    EXPECT_EQ(stats.leftOutFaces.empty(), !isSolid) << mesh.triangles.size() << " faces";
    EXPECT_TRUE(stats.orientationFits);
    expectDecisive(mesh, {.resolution = 32}, {}, stats);
  }
}

TEST_F(Backends, CountRepeatedFacesOnce) {
  const Mesh ball = shapes::sphere(1.0, 2);
  const Mesh holed = keepTriangles(ball, [&](const glm::uvec3& t) { return ball.position(t.x).z < 0.8; });
  Generator generator;
  for (const Mesh& single : {ball, holed})
    for (const SignMode sign : {SignMode::Ray, SignMode::Harmonic, SignMode::Exact})
      for (const bool closes : {false, true}) {
        SCOPED_TRACE(::testing::Message() << single.triangles.size() << " faces, sign " << int(sign));
        FieldOptions options = everything();
        options.sign = sign;
        options.orientation = closes ? Orientation::Auto : Orientation::Keep;
        options.closeHoles = closes;
        const Grid grid = fitGrid(single, {.resolution = 12});
        Field cpu, gpu;
        generator.generate(single, grid, options, cpu, kCpu);
        const Stats stats = generator.generate(shapes::joined(single, single), grid, options, gpu, kGpu);
        vulkan::requireSameDistances(cpu, gpu, single, {});
        ASSERT_EQ(stats.leftOutFaces.size(), single.triangles.size());
        EXPECT_EQ(stats.leftOutFaces.front(), single.triangles.size());
      }
}

TEST_F(Backends, TurnTheSameInvertedParts) {
  const Mesh first = shapes::sphere(1.0, 2),
             second = shapes::inverted(shapes::sphere(0.8, 2, {0.9, 0.2, 0.1}));
  const Mesh open = keepTriangles(second, [&](const glm::uvec3& t) { return second.position(t.x).x < 1.6; });
  for (const Mesh& part : {second, open}) {
    const Stats stats = compare(shapes::joined(first, part), {.resolution = 16});
    EXPECT_EQ(stats.invertedParts, std::vector<uint32_t>{uint32_t(first.triangles.size())});
    EXPECT_EQ(stats.turnedFaces.size(), part.triangles.size());
  }
}

TEST_F(Backends, GiveTheSameInABoxThatCutsTheMesh) {
  compare(shapes::torus(1.0, 0.3, 40, 20),
          {.resolution = 30, .box = Box{{-0.2, -1.5, -0.1}, {1.0, 0.4, 0.9}}},
          {.threshold = 0.3, .invert = true});
}

TEST_F(Backends, CloseTheSameHoles) {
  const Mesh ball = holedSphere(4);
  Mesh ring = shapes::torus(1.0, 0.4, 40, 20);
  ring.triangles.erase(ring.triangles.begin() + 40, ring.triangles.begin() + 160);
  struct Case {
    const Mesh& mesh;
    FieldOptions options;
  };
  for (auto& [mesh, options] :
       std::initializer_list<Case>{{ball, {}},
                                   {ball, {.band = 3.0}},
                                   {ball, {.threshold = 0.3}},
                                   {ball, {.distance = DistanceMode::Cell, .sign = SignMode::Paths}},
                                   {ring, {}},
                                   {ring, {.distance = DistanceMode::Neighbours}},
                                   {withFlippedFaces(ring, 0.1, 10), {}},
                                   {shapes::joined(ball, ring), {.sign = SignMode::Rays}}}) {
    FieldOptions closing = options;
    closing.closeHoles = true;
    EXPECT_GT(compare(mesh, {.resolution = 40}, closing).patchTriangles, 0u);
  }
}

TEST_F(Backends, GiveTheSameBand) {
  compare(shapes::sphere(1.0, 4), {.resolution = 40}, {.band = 3.0});
}

TEST_F(Backends, GiveTheSameRays) {
  const Mesh mesh = shapes::soup(300, 8);
  for (const SignMode sign : {SignMode::Rays, SignMode::Ray})
    compare(mesh, {.resolution = 24}, {.sign = sign});
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  for (const float d : make(mesh, grid, {.sign = SignMode::None}).distance) ASSERT_GE(d, 0.0f);
}

TEST_F(Backends, GiveTheSameExactNumbers) {
  const Mesh mesh = holedSphere(4);
  const Box box{{-0.5, -0.4, 0.2}, {0.9, 0.8, 1.1}};
  compare(mesh, {.resolution = 20}, {.sign = SignMode::Exact});
  compare(mesh, {.resolution = 12, .box = box}, {.sign = SignMode::Exact});
}

TEST_F(Backends, GiveTheSamePathsAndEvolution) {
  for (const SignMode sign : {SignMode::Paths, SignMode::Evolution})
    for (const Sampling sampling : {Sampling::Spread, Sampling::Paper})
      compare(holedSphere(4), {.resolution = 20}, {.sign = sign, .sampling = sampling});
}

TEST_F(Backends, GiveTheSameDistancesOfThePaper) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  const GridOptions whole{.resolution = 24};
  const GridOptions cut{.resolution = 20, .box = Box{{-0.2, -1.5, -0.1}, {1.0, 0.4, 0.9}}};
  for (const DistanceMode mode : {DistanceMode::Cell, DistanceMode::Neighbours, DistanceMode::Raster})
    for (const GridOptions& grid : {whole, cut}) compare(mesh, grid, {.distance = mode});
}

TEST_F(Backends, GiveTheSameBitsEachTime) {
  const Mesh first = holedSphere(4), second = shapes::soup(300, 8);
  Generator generator;
  Field a, b, c;
  const FieldOptions options = everything();
  const Grid grid = fitGrid(first, {.resolution = 28});
  generator.generate(first, grid, options, a, kGpu);
  generator.generate(second, fitGrid(second, {.resolution = 20}), options, b, kGpu);
  generator.generate(first, grid, options, c, kGpu);
  EXPECT_TRUE(sameBits(a.distance, c.distance));
  EXPECT_TRUE(sameBits(a.winding, c.winding));
  EXPECT_TRUE(sameBits(a.triangle, c.triangle));
  EXPECT_TRUE(sameBits(a.confidence, c.confidence));
}

TEST_F(Backends, StopWhenAskedAndLeaveNothing) {
  const Mesh mesh = shapes::sphere(1.0, 3);
  for (const int stopAt : {0, 2, 4}) {
    int calls = 0;
    const auto stop = [&](std::string_view, double) { return calls++ < stopAt; };
    Field field;
    Generator generator;
    try {
      generator.generate(mesh, fitGrid(mesh, {.resolution = 16}), {}, field,
                         {.device = "vulkan", .progress = stop});
      FAIL() << stopAt;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Cancelled);
    }
    EXPECT_TRUE(field.distance.empty());
    generator.generate(mesh, fitGrid(mesh, {.resolution = 16}), {}, field, kGpu);
    EXPECT_FALSE(field.distance.empty());
  }
}

TEST_F(Backends, ReportProgressWithinTheirPaths) {
  const Mesh mesh = holedSphere(4);
  FieldOptions options = everything();
  options.sign = SignMode::Evolution;
  options.passes = 5;
  std::vector<double> shares;
  const auto note = [&](std::string_view stage, double done) {
    if (stage == "winding") shares.push_back(done);
    return true;
  };
  make(mesh, fitGrid(mesh, {.resolution = 16}), options, note);
  EXPECT_EQ(shares, (std::vector<double>{0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
}

TEST_F(Backends, ReportProgressWithinTheWindingStage) {
  const Mesh mesh = holedSphere(4);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  FieldOptions options = everything();
  const Field quiet = make(mesh, grid, options);
  std::vector<double> shares;
  const auto note = [&](std::string_view stage, double done) {
    if (stage == "winding") shares.push_back(done);
    return true;
  };
  const Field told = make(mesh, grid, options, note);
  ASSERT_EQ(shares.size(), 5u);  // The rays, and each lattice.
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_GT(shares[1], 0.2);
  EXPECT_LT(shares[1], 0.7);
  for (size_t s = 1; s < shares.size(); ++s) EXPECT_GT(shares[s], shares[s - 1]);
  EXPECT_NEAR(shares.back(), 1.0, 0.01);
  EXPECT_TRUE(sameBits(quiet.winding, told.winding));
}

TEST_F(Backends, KeepNothingForWhatIsNotAskedFor) {
  const Mesh mesh = holedSphere(4);
  for (const DistanceMode mode : {DistanceMode::Exact, DistanceMode::Cell}) {
    FieldOptions options = everything();
    options.distance = mode;
    const Grid grid = fitGrid(mesh, {.resolution = 24});
    const Field all = make(mesh, grid, options);
    options.winding = options.confidence = options.triangle = false;
    const Field alone = make(mesh, grid, options);
    EXPECT_TRUE(alone.winding.empty() && alone.confidence.empty() && alone.triangle.empty());
    EXPECT_TRUE(sameBits(all.distance, alone.distance));
  }
}

TEST_F(Backends, HoldLittleMemory) {
  const Mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  FieldOptions options;
  const auto bytesPerSample = [&](int resolution) {
    const Grid grid = fitGrid(mesh, {.resolution = resolution});
    Generator generator;
    Field field;
    return double(generator.generate(mesh, grid, options, field, kGpu).bytes) / double(grid.sampleCount());
  };
  EXPECT_LE(bytesPerSample(130), 24.0);
  EXPECT_LE(bytesPerSample(96), 28.5);  // Few samples: 4 bytes each for a driver in software alone.
  options.distance = DistanceMode::Cell;
  options.sign = SignMode::Rays;
  EXPECT_LE(bytesPerSample(96), 25.0);
}

TEST_F(Backends, RefuseWhatTheCpuRefuses) {
  Mesh far = shapes::sphere(1.0, 2);
  const Grid grid = fitGrid(far, {.resolution = 16});
  MachineOptions machine = kGpu;
  const auto refusal = [&] { return codeOf([&] { generate(far, grid, {}, machine); }); };
  machine.memoryLimit = 1000;
  EXPECT_EQ(refusal(), ErrorCode::Memory);
  machine.memoryLimit = 0;
  Generator generator;
  Field field;
  const size_t held = generator.generate(far, grid, {}, field, machine).bytes;
  machine.memoryLimit = held;
  EXPECT_EQ(generator.generate(far, grid, {}, field, machine).bytes, held);
  // What a larger run left does not count.
  EXPECT_GT(generator.generate(far, fitGrid(far, {.resolution = 40}), {}, field, kGpu).bytes, held);
  EXPECT_EQ(generator.generate(far, grid, {}, field, machine).bytes, held);
  machine.memoryLimit = held - 1;
  EXPECT_EQ(refusal(), ErrorCode::Memory);
  machine.memoryLimit = 0;
  far.vertices[far.triangles[3].y] = glm::vec3(1e15f);
  EXPECT_EQ(refusal(), ErrorCode::Input);
}

}  // namespace
}  // namespace raymap
