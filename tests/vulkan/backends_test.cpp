// The CPU and Vulkan give the same fields.

#include <gtest/gtest.h>
#include <raymap/raymap.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>

#include "api/devices.h"
#include "broken_meshes.h"
#include "error_code.h"
#include "shapes.h"

namespace raymap {
namespace {

const MachineOptions kCpu{.device = "cpu"}, kGpu{.device = "vulkan"};

class Backends : public ::testing::Test {
 protected:
  void SetUp() override {
    if (devices().devices.size() > 1) return;
    const char* required = std::getenv("RAYMAP_REQUIRE_VULKAN");
    if (required && std::string(required) == "1") FAIL() << devices().note;
    GTEST_SKIP() << devices().note;
  }

  static FieldOptions everything() {
    FieldOptions options;
    options.winding = options.confidence = options.triangle = true;
    return options;
  }

  static Field make(const Mesh& mesh, const Grid& grid, const FieldOptions& options, const char* device,
                    const ProgressCallback& progress = {}) {
    auto [field, stats] = generate(mesh, grid, options, {.device = device, .progress = progress});
    EXPECT_TRUE(stats.device.starts_with(device)) << stats.device;
    return std::move(field);
  }

  /// Expects distances within 1e-6 of the diagonal, and equal signs wherever |w| is more than 1e-4 from the
  /// threshold.
  static void expectSame(const Field& a, const Field& b, const Mesh& mesh, double threshold = 0.5) {
    const double tolerance = 1e-6 * glm::length(bounds(mesh).size());
    ASSERT_EQ(a.distance.size(), b.distance.size());
    size_t unlike = 0;
    for (size_t s = 0; s < a.distance.size(); ++s) {
      ASSERT_NEAR(std::abs(a.distance[s]), std::abs(b.distance[s]), tolerance) << "sample " << s;
      if (std::signbit(a.distance[s]) == std::signbit(b.distance[s])) continue;
      ++unlike;
      ASSERT_LT(std::abs(std::abs(a.winding[s]) - threshold), 1e-4)
          << "sample " << s << ": " << a.winding[s] << " and " << b.winding[s];
    }
    EXPECT_LE(unlike, a.distance.size() / 10000);
  }

  /// Expects that the CPU chooses the same faces on grids that lie a little beside this one. On open meshes
  /// their misfits differ by some 1e-3; those of the backends by less than 1e-4. No choice is then so close
  /// that rounding may decide it.
  static void expectDecisive(const Mesh& mesh, const Grid& grid, const FieldOptions& options,
                             const Stats& stats) {
    for (const double shift : {-1e-3, 1e-3}) {
      Grid beside = grid;
      beside.origin += shift * grid.spacing;
      Generator generator;
      Field field;
      const Stats other = generator.generate(mesh, beside, options, field, kCpu);
      EXPECT_EQ(other.turnedFaces, stats.turnedFaces) << "a close choice: test another mesh";
      EXPECT_EQ(other.leftOutFaces, stats.leftOutFaces) << "a close choice: test another mesh";
    }
  }

  static Mesh holedSphere() {
    Mesh mesh = shapes::sphere(1.0, 4);
    std::erase_if(mesh.triangles, [&](const glm::uvec3& t) { return mesh.position(t.x).z > 0.6; });
    return mesh;
  }
};

TEST_F(Backends, GiveTheSameField) {
  for (const Mesh& mesh :
       {shapes::sphere(1.0, 4), holedSphere(), shapes::soup(500, 3), shapes::torus(1.0, 0.3, 40, 20)}) {
    const Grid grid = fitGrid(mesh, {.resolution = 32});
    const Field cpu = make(mesh, grid, everything(), "cpu"), gpu = make(mesh, grid, everything(), "vulkan");
    expectSame(cpu, gpu, mesh);
    for (size_t s = 0; s < cpu.winding.size(); ++s) {
      ASSERT_NEAR(cpu.winding[s], gpu.winding[s], 0.06f) << "sample " << s;
      ASSERT_LT(gpu.triangle[s], mesh.triangles.size());
    }
  }
}

/// Returns the mesh with faces that share no vertex.
Mesh soupOf(const Mesh& mesh) {
  Mesh soup{.vertices = {}, .triangles = mesh.triangles, .origin = mesh.origin};
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const float shrink = 1.0f - 1e-4f * float(f % 7);
    for (int c = 0; c < 3; ++c) soup.vertices.push_back(shrink * mesh.vertices[mesh.triangles[f][c]]);
    soup.triangles[f] = 3 * f + glm::uvec3(0, 1, 2);
  }
  return soup;
}

Mesh flipped(Mesh mesh, uint32_t every) {
  std::mt19937 random(every);
  for (glm::uvec3& t : mesh.triangles)
    if (random() % every == 0) std::swap(t.y, t.z);
  return mesh;
}

TEST_F(Backends, TurnTheSameFaces) {
  const Mesh pair = shapes::joined(holedSphere(), shapes::sphere(0.8, 3, {0.6, 0.2, 0.0}));
  const Mesh soup = soupOf(shapes::sphere(1.0, 3));
  struct Case {
    Mesh mesh;
    SignMode sign = SignMode::Harmonic;
    Orientation orientation = Orientation::Auto;
  };
  for (const auto& [mesh, sign, orientation] :
       std::initializer_list<Case>{{flipped(holedSphere(), 10)},
                                   {flipped(pair, 3)},
                                   {flipped(soup, 3)},
                                   {flipped(soup, 2)},
                                   {flipped(holedSphere(), 3), SignMode::Paths, Orientation::Repair}}) {
    const Grid grid = fitGrid(mesh, {.resolution = 32});
    FieldOptions options = everything();
    options.sign = sign;
    options.orientation = orientation;
    Generator generator;
    Field cpu, gpu;
    const Stats onCpu = generator.generate(mesh, grid, options, cpu, kCpu);
    EXPECT_FALSE(onCpu.turnedFaces.empty());
    expectDecisive(mesh, grid, options, onCpu);
    const Stats onGpu = generator.generate(mesh, grid, options, gpu, kGpu);
    EXPECT_EQ(onCpu.turnedFaces, onGpu.turnedFaces);
    EXPECT_EQ(onCpu.doubtfulShare, onGpu.doubtfulShare);
    EXPECT_NEAR(onCpu.misfitGiven, onGpu.misfitGiven, 1e-4);
    EXPECT_NEAR(onCpu.misfit, onGpu.misfit, 1e-4);
    expectSame(cpu, gpu, mesh);
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
           {withDoubledFaces(flipped(pair, 3), 0.5, 1)},
           {half},
           {withDoubledFaces(shapes::joined(box, shapes::box({0.3, 0.2, 0.1}, {0.6, 0.6, 0.6})), 1.0, 1)},
           {withDoubledFaces(shapes::joined(box, shapes::box({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5})), 1.0, 1)},
           {withDoubledFaces(open, 1.0, 1), false}}) {
    const Grid grid = fitGrid(mesh, {.resolution = 32});
    Generator generator;
    Field cpu, gpu;
    const Stats onCpu = generator.generate(mesh, grid, everything(), cpu, kCpu);
    const Stats onGpu = generator.generate(mesh, grid, everything(), gpu, kGpu);
    EXPECT_EQ(onCpu.leftOutFaces.empty(), !isSolid) << mesh.triangles.size() << " faces";
    expectDecisive(mesh, grid, everything(), onCpu);
    EXPECT_EQ(onCpu.leftOutFaces, onGpu.leftOutFaces);
    EXPECT_EQ(onCpu.turnedFaces, onGpu.turnedFaces);
    EXPECT_NEAR(onCpu.misfit, onGpu.misfit, 1e-4);
    EXPECT_TRUE(onGpu.orientationFits);
    expectSame(cpu, gpu, mesh);
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
        expectSame(cpu, gpu, single);
        ASSERT_EQ(stats.leftOutFaces.size(), single.triangles.size());
        EXPECT_EQ(stats.leftOutFaces.front(), single.triangles.size());
      }
}

TEST_F(Backends, TurnTheSameInvertedParts) {
  const Mesh first = shapes::sphere(1.0, 2),
             second = shapes::inverted(shapes::sphere(0.8, 2, {0.9, 0.2, 0.1}));
  const Mesh open = keepTriangles(second, [&](const glm::uvec3& t) { return second.position(t.x).x < 1.6; });
  Generator generator;
  for (const Mesh& part : {second, open}) {
    const Mesh mesh = shapes::joined(first, part);
    const Grid grid = fitGrid(mesh, {.resolution = 16});
    Field cpu, gpu;
    const Stats onCpu = generator.generate(mesh, grid, everything(), cpu, kCpu);
    const Stats onGpu = generator.generate(mesh, grid, everything(), gpu, kGpu);
    EXPECT_EQ(onCpu.invertedParts, std::vector<uint32_t>{uint32_t(first.triangles.size())});
    EXPECT_EQ(onGpu.invertedParts, onCpu.invertedParts);
    EXPECT_EQ(onGpu.turnedFaces, onCpu.turnedFaces);
    EXPECT_EQ(onGpu.turnedFaces.size(), part.triangles.size());
    expectSame(cpu, gpu, mesh);
  }
}

TEST_F(Backends, GiveTheSameInABoxThatCutsTheMesh) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  const Grid grid = fitGrid(mesh, {.resolution = 30, .box = Box{{-0.2, -1.5, -0.1}, {1.0, 0.4, 0.9}}});
  FieldOptions options = everything();
  options.invert = true;
  options.threshold = 0.3;
  expectSame(make(mesh, grid, options, "cpu"), make(mesh, grid, options, "vulkan"), mesh, 0.3);
}

TEST_F(Backends, CloseTheSameHoles) {
  const Mesh ball = holedSphere();
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
                                   {flipped(ring, 10), {}},
                                   {shapes::joined(ball, ring), {.sign = SignMode::Rays}}}) {
    const Grid grid = fitGrid(mesh, {.resolution = 40});
    FieldOptions all = options;
    all.winding = all.triangle = all.closeHoles = true;
    Generator generator;
    Field cpu, gpu;
    const Stats onCpu = generator.generate(mesh, grid, all, cpu, kCpu);
    const Stats onGpu = generator.generate(mesh, grid, all, gpu, kGpu);
    EXPECT_GT(onCpu.patchTriangles, 0u);
    EXPECT_EQ(onCpu.patchTriangles, onGpu.patchTriangles);
    EXPECT_NEAR(onCpu.patchArea, onGpu.patchArea, 1e-4 * onCpu.patchArea);
    size_t otherTriangles = 0;
    for (size_t i = 0; i < cpu.distance.size(); ++i) {
      const double difference = std::abs(cpu.distance[i]) - std::abs(gpu.distance[i]);
      ASSERT_LT(std::abs(difference), 0.01 * grid.spacing) << i;
      if (std::signbit(cpu.distance[i]) != std::signbit(gpu.distance[i])) {
        ASSERT_LT(std::abs(std::abs(cpu.winding[i]) - options.threshold), 1e-4) << i;
      }
      otherTriangles += (cpu.triangle[i] == kNoTriangle) != (gpu.triangle[i] == kNoTriangle) ? 1 : 0;
    }
    EXPECT_LT(otherTriangles, cpu.distance.size() / 1000);
  }
}

TEST_F(Backends, GiveTheSameBand) {
  const Mesh mesh = shapes::sphere(1.0, 4);
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  FieldOptions options = everything();
  options.band = 3.0;
  const Field cpu = make(mesh, grid, options, "cpu"), gpu = make(mesh, grid, options, "vulkan");
  expectSame(cpu, gpu, mesh);
  for (size_t s = 0; s < cpu.distance.size(); ++s)
    ASSERT_EQ(cpu.triangle[s] == kNoTriangle, gpu.triangle[s] == kNoTriangle) << "sample " << s;
}

TEST_F(Backends, GiveTheSameRays) {
  const Mesh mesh = shapes::soup(300, 8);
  const Grid grid = fitGrid(mesh, {.resolution = 24});
  FieldOptions options = everything();
  for (const SignMode sign : {SignMode::Rays, SignMode::Ray}) {
    options.sign = sign;
    const Field cpu = make(mesh, grid, options, "cpu"), gpu = make(mesh, grid, options, "vulkan");
    EXPECT_EQ(0, std::memcmp(cpu.winding.data(), gpu.winding.data(), cpu.winding.size() * sizeof(float)));
  }
  options.sign = SignMode::None;
  options.winding = options.confidence = false;
  for (const float d : make(mesh, grid, options, "vulkan").distance) ASSERT_GE(d, 0.0f);
}

TEST_F(Backends, GiveTheSameExactNumbers) {
  const Mesh mesh = holedSphere();
  FieldOptions options = everything();
  options.sign = SignMode::Exact;
  for (const Grid& grid :
       {fitGrid(mesh, {.resolution = 20}),
        fitGrid(mesh, {.resolution = 12, .box = Box{{-0.5, -0.4, 0.2}, {0.9, 0.8, 1.1}}})}) {
    const Field cpu = make(mesh, grid, options, "cpu"), gpu = make(mesh, grid, options, "vulkan");
    for (size_t s = 0; s < cpu.winding.size(); ++s) ASSERT_NEAR(cpu.winding[s], gpu.winding[s], 1e-5f) << s;
  }
}

TEST_F(Backends, GiveTheSamePathsAndEvolution) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 20});
  FieldOptions options = everything();
  for (const auto& [sign, sampling] : {std::pair(SignMode::Paths, Sampling::Spread),
                                       {SignMode::Evolution, Sampling::Spread},
                                       {SignMode::Paths, Sampling::Paper},
                                       {SignMode::Evolution, Sampling::Paper}}) {
    options.sign = sign;
    options.sampling = sampling;
    const Field cpu = make(mesh, grid, options, "cpu"), gpu = make(mesh, grid, options, "vulkan");
    expectSame(cpu, gpu, mesh);
    for (size_t s = 0; s < cpu.winding.size(); ++s) ASSERT_NEAR(cpu.winding[s], gpu.winding[s], 1e-5f) << s;
  }
}

TEST_F(Backends, GiveTheSameDistancesOfThePaper) {
  const Mesh mesh = shapes::torus(1.0, 0.3, 40, 20);
  const Grid whole = fitGrid(mesh, {.resolution = 24});
  const Grid cut = fitGrid(mesh, {.resolution = 20, .box = Box{{-0.2, -1.5, -0.1}, {1.0, 0.4, 0.9}}});
  for (const DistanceMode mode : {DistanceMode::Cell, DistanceMode::Neighbours, DistanceMode::Raster})
    for (const Grid& grid : {whole, cut}) {
      FieldOptions options = everything();
      options.distance = mode;
      options.triangle = mode != DistanceMode::Raster;
      expectSame(make(mesh, grid, options, "cpu"), make(mesh, grid, options, "vulkan"), mesh);
    }
}

TEST_F(Backends, GiveTheSameBitsEachTime) {
  const Mesh first = holedSphere(), second = shapes::soup(300, 8);
  Generator generator;
  Field a, b, c;
  const FieldOptions options = everything();
  const Grid grid = fitGrid(first, {.resolution = 28});
  generator.generate(first, grid, options, a, kGpu);
  generator.generate(second, fitGrid(second, {.resolution = 20}), options, b, kGpu);
  generator.generate(first, grid, options, c, kGpu);
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * 4) == 0;
  };
  EXPECT_TRUE(same(a.distance, c.distance));
  EXPECT_TRUE(same(a.winding, c.winding));
  EXPECT_TRUE(same(a.triangle, c.triangle));
  EXPECT_TRUE(same(a.confidence, c.confidence));
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
  const Mesh mesh = holedSphere();
  FieldOptions options = everything();
  options.sign = SignMode::Evolution;
  options.passes = 5;
  std::vector<double> shares;
  const auto note = [&](std::string_view stage, double done) {
    if (stage == "winding") shares.push_back(done);
    return true;
  };
  make(mesh, fitGrid(mesh, {.resolution = 16}), options, "vulkan", note);
  EXPECT_EQ(shares, (std::vector<double>{0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
}

TEST_F(Backends, ReportProgressWithinTheWindingStage) {
  const Mesh mesh = holedSphere();
  const Grid grid = fitGrid(mesh, {.resolution = 40});
  FieldOptions options = everything();
  const Field quiet = make(mesh, grid, options, "vulkan");
  std::vector<double> shares;
  const auto note = [&](std::string_view stage, double done) {
    if (stage == "winding") shares.push_back(done);
    return true;
  };
  const Field told = make(mesh, grid, options, "vulkan", note);
  ASSERT_EQ(shares.size(), 5u);  // The rays, and each lattice.
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_GT(shares[1], 0.2);
  EXPECT_LT(shares[1], 0.7);
  for (size_t s = 1; s < shares.size(); ++s) EXPECT_GT(shares[s], shares[s - 1]);
  EXPECT_NEAR(shares.back(), 1.0, 0.01);
  EXPECT_EQ(0, std::memcmp(quiet.winding.data(), told.winding.data(), quiet.winding.size() * sizeof(float)));
}

TEST_F(Backends, KeepNothingForWhatIsNotAskedFor) {
  const Mesh mesh = holedSphere();
  for (const DistanceMode mode : {DistanceMode::Exact, DistanceMode::Cell}) {
    FieldOptions options = everything();
    options.distance = mode;
    const Grid grid = fitGrid(mesh, {.resolution = 24});
    const Field all = make(mesh, grid, options, "vulkan");
    options.winding = options.confidence = options.triangle = false;
    const Field alone = make(mesh, grid, options, "vulkan");
    EXPECT_TRUE(alone.winding.empty() && alone.confidence.empty() && alone.triangle.empty());
    EXPECT_EQ(0,
              std::memcmp(all.distance.data(), alone.distance.data(), alone.distance.size() * sizeof(float)));
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
