// Checks of the work of a frame: skinning, a field in an image, a picture.

#include <raymap/animation.h>

#include <array>
#include <cmath>
#include <glm/gtc/packing.hpp>
#include <random>

#include "cpu/render/shade.h"
#include "method/pipeline.h"
#include "testing/shapes.h"
#include "vulkan/runtime/draw_scene.h"
#include "vulkan/runtime/frame_backend.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"
#include "vulkan/self_test/probe_image.h"
#include "vulkan/stages/skin.h"

namespace raymap::vulkan {

namespace {

/// Returns whether a vertex follows a joint that does not exist if there are `jointCount`.
bool isLost(const AnimatedMesh& mesh, size_t vertex, size_t jointCount) {
  for (int k = 0; k < 4; ++k)
    if (mesh.weights[vertex][k] != 0.0F && mesh.joints[vertex][k] >= jointCount) return true;
  return false;
}

/// Makes the same field in an image, and returns a copy of its texels.
template <class Texel>
DeviceBuffer texelsOf(const Probe& probe, FrameBackend& frames, VkFormat format, const Mesh& mesh,
                      const Grid& grid, const FieldOptions& options) {
  const auto vertexCount = uint32_t(mesh.vertices.size()), triangleCount = uint32_t(mesh.triangles.size());
  const DeviceBuffer vertices = probe.upload(mesh.vertices), triangles = probe.upload(mesh.triangles);
  const ProbeImage image(probe.device(), format, grid.dims);
  DeviceBuffer texels(probe.device(), "texels", MemoryUse::ReadBack);
  texels.resize<Texel>(grid.sampleCount());
  frames.reserve({.vertices = vertexCount, .triangles = triangleCount, .dims = grid.dims, .image = format});
  probe.run([&](Commands& commands) {
    frames.setFrame({.commands = commands,
                     .mesh = {.positions = vertices.address(),
                              .stride = 3,
                              .triangles = triangles.address(),
                              .vertexCount = vertexCount,
                              .triangleCount = triangleCount,
                              .origin = mesh.origin},
                     .image = image.handle(),
                     .imageLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                    grid, options);
    runPipeline(frames);
    image.recordCopy(commands, texels);
  });
  if (const std::optional<Error> error = frames.status().error) throw Difference(error->what());
  return texels;
}

/// Returns the field of a box without a ball at one corner.
Field notchedBox(int side, double band) {
  Field field{.grid = {glm::ivec3(side), glm::dvec3(-1.0), 2.0 / (side - 1)}, .clampDistance = band};
  field.distance.resizeUninitialized(field.grid.sampleCount());
  for (size_t s = 0; s < field.distance.size(); ++s) {
    const glm::dvec3 p = field.grid.position(CellLattice{field.grid.dims}.cell(s));
    const glm::dvec3 q = glm::abs(p) - glm::dvec3(0.7, 0.5, 0.6);
    const double box = glm::length(glm::max(q, 0.0)) + std::min(std::max({q.x, q.y, q.z}), 0.0);
    const double d = std::max(box, 0.45 - glm::distance(p, glm::dvec3(0.4, 0.5, 0.6)));
    field.distance[s] = float(band > 0.0 ? std::clamp(d, -band, band) : d);
  }
  return field;
}

}  // namespace

void checkSkin(Subject& subject) {
  const AnimatedMesh mesh = wanderers(shapes::sphere(1.0, 3), 5);
  compareSkin(subject.probe, mesh, 0.0);
  std::vector<JointMatrix> matrices = jointMatrices(mesh, 0.0);
  matrices.pop_back();
  const std::vector<glm::vec3> moved = movedVertices(subject.probe, mesh, matrices);
  for (size_t v = 0; v < moved.size(); ++v)
    require(std::isnan(moved[v].x) == isLost(mesh, v, matrices.size()),
            "vertex " + textOf(v) + " is " + textOf(moved[v]) + " without the last joint");
}

void checkFieldImage(Subject& subject) {
  const Mesh mesh = shapes::torus(1.0, 0.4, 20, 12);
  const Grid grid = fitGrid(mesh, {.resolution = 15});
  const FieldOptions options{.orientation = Orientation::Keep};  // As frames do.
  const Field field = makeField(subject.backend, mesh, grid, options).field;
  FrameBackend frames(subject.probe.device());
  const DeviceBuffer floats =
      texelsOf<float>(subject.probe, frames, VK_FORMAT_R32_SFLOAT, mesh, grid, options);
  requireEqual("texels", floats.mapped<float>(), field.distance);
  const DeviceBuffer halves =
      texelsOf<uint16_t>(subject.probe, frames, VK_FORMAT_R16_SFLOAT, mesh, grid, options);
  requireNearestHalves(halves.mapped<uint16_t>(), field.distance);
}

void checkRenderField(Subject& subject) {
  const auto compare = [&](const std::string& name, const auto& field, RenderOptions options) {
    options.width = 80;
    options.height = 60;
    const DrawnScene scene(field, options);
    Picture ours = makePicture(options.width, options.height), theirs = ours;
    Progress progress;
    drawScene(subject.probe.device(), scene, progress, ours);
    for (int y = 0; y < options.height; ++y)
      for (int x = 0; x < options.width; ++x) setPixel(theirs, x, y, cpu::pixelColour(scene, x, y));
    inCase(name, [&] { requireSamePicture(ours, theirs); });
  };
  compare("solid", notchedBox(24, 0.0), {});
  compare("cut and hollow", notchedBox(32, 0.0), {.cut = true, .shell = 0.15});
  compare("clamped", notchedBox(32, 0.2), {.direction = {1.0, -0.5, 0.4}});
  compare("narrow band", toSparse(notchedBox(48, 0.0)), {.direction = {1.0, -0.5, 0.4}});
}

AnimatedMesh wanderers(Mesh rest, uint16_t joints) {
  std::mt19937 random(7);
  const auto real = [&](double low, double high) {
    return low + (high - low) * double(random()) / double(std::mt19937::max());
  };
  AnimatedMesh mesh{.rest = std::move(rest)};
  for (uint16_t j = 0; j < joints; ++j) {
    mesh.nodes.push_back({.parent = int(j) - 1,
                          .translation = {real(-1, 1), real(-1, 1), real(-1, 1)},
                          .rotation = {real(-1, 1), real(-1, 1), real(-1, 1), 1.0},
                          .scale = glm::dvec3(real(0.9, 1.1))});
    mesh.skeleton.push_back({.node = j});
  }
  for (size_t v = 0; v < mesh.rest.vertices.size(); ++v) {
    const auto joint = [&] { return uint16_t(random() % joints); };
    mesh.joints.emplace_back(joint(), joint(), joint(), joint());
    const glm::vec4 weights(0.1, v % 2 == 0 ? 0.0 : real(0.2, 1), v % 3 == 0 ? 0.0 : real(0.2, 1),
                            real(0.2, 1));
    mesh.weights.push_back(weights / (weights.x + weights.y + weights.z + weights.w));
  }
  mesh.origin = {1.0, -2.0, 3.0};
  return mesh;
}

std::vector<glm::vec3> movedVertices(const Probe& probe, const AnimatedMesh& mesh,
                                     const std::vector<JointMatrix>& matrices, bool hasJoints) {
  const auto count = uint32_t(mesh.rest.vertices.size());
  const DeviceBuffer rest = probe.upload(mesh.rest.vertices), joints = probe.upload(mesh.joints),
                     weights = probe.upload(mesh.weights), palette = probe.upload(matrices);
  const DeviceBuffer moved = probe.room<glm::vec3>(count, "moved");
  SkinStage skin(probe.device());
  probe.run([&](Commands& commands) {
    skin.record(commands,
                {.rest = rest.address(),
                 .joints = hasJoints ? joints.address() : 0,
                 .weights = hasJoints ? weights.address() : 0,
                 .matrices = palette.address(),
                 .vertexCount = count,
                 .jointCount = uint32_t(matrices.size())},
                moved.address());
  });
  return probe.download<glm::vec3>(moved);
}

void compareSkin(const Probe& probe, const AnimatedMesh& mesh, double seconds) {
  const Mesh expected = posed(mesh, seconds);
  const double allowed = 1e-6 * glm::length(bounds(expected).size());
  requireAll("vertices", movedVertices(probe, mesh, jointMatrices(mesh, seconds)), expected.vertices,
             [&](const glm::vec3& a, const glm::vec3& b) { return glm::distance(a, b) <= allowed; });
}

void requireNearestHalves(std::span<const uint16_t> halves, const Buffer<float>& values) {
  for (size_t s = 0; s < values.size(); ++s) {
    const auto error = [&](int step) {  // NaN beyond zero.
      return std::abs(double(glm::unpackHalf1x16(uint16_t(halves[s] + step))) - double(values[s]));
    };
    require(!(error(-1) < error(0)) && !(error(1) < error(0)), "half float " + textOf(s) + " is " +
                                                                   textOf(glm::unpackHalf1x16(halves[s])) +
                                                                   ", not " + textOf(values[s]));
  }
}

void requireSamePicture(const Picture& ours, const Picture& theirs) {
  const size_t pixels = theirs.rgb.size() / 3;
  std::array<double, 3> sums{};
  size_t unlike = 0;
  for (size_t p = 0; p < pixels; ++p) {
    int most = 0;
    for (size_t c = 0; c < 3; ++c) {
      const int difference = std::abs(int(ours.rgb[3 * p + c]) - int(theirs.rgb[3 * p + c]));
      sums[c] += difference;
      most = std::max(most, difference);
    }
    unlike += most > 8 ? 1 : 0;
  }
  require(double(unlike) <= 0.002 * double(pixels),
          textOf(unlike) + " of " + textOf(pixels) + " pixels differ by more than 8");
  for (const double sum : sums)
    require(sum <= 0.1 * double(pixels),
            "a colour differs by " + textOf(sum / double(pixels)) + " on average");
}

}  // namespace raymap::vulkan
