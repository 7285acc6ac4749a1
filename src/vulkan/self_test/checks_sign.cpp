#include <cmath>

#include "cpu/distance/finish.h"
#include "cpu/sign/close_holes.h"
#include "cpu/sign/orientation.h"
#include "cpu/sign/sign.h"
#include "cpu/sign/winding_doubts.h"
#include "cpu/sign/winding_harmonic.h"
#include "cpu/sign/winding_paths.h"
#include "cpu/sign/winding_rays.h"
#include "cpu/sign/winding_rims_samples.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"
#include "vulkan/stages/close_holes.h"
#include "vulkan/stages/finish.h"
#include "vulkan/stages/orientation.h"
#include "vulkan/stages/winding_doubts.h"

namespace raymap::vulkan {

namespace {

Grid unitGrid(const glm::ivec3& dims) {
  return {.dims = dims, .origin = glm::dvec3(0.0), .spacing = 1.0};
}

cpu::Crossings crossingsOf(const CellMesh& mesh) {
  Progress progress;
  cpu::Crossings crossings;
  cpu::countCrossings(mesh, progress, crossings);
  return crossings;
}

cpu::RayMap rayMapOf(const CellMesh& mesh) {
  cpu::RayMap map;
  buildRayMap(mesh.dims, crossingsOf(mesh), map);
  return map;
}

OwnCellMesh soupIn(const glm::ivec3& dims, double spacing, int count = 200) {
  return {shapes::soup(count, 3), {.dims = dims, .origin = glm::dvec3(0.01), .spacing = spacing}};
}

/// Returns a random field with values about every threshold.
Buffer<float> randomField(const glm::ivec3& dims) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> anything(-1.2f, 1.2f);
  Buffer<float> values(CellLattice{dims}.count());
  for (float& value : values) value = anything(random);
  return values;
}

/// Returns a box with faces three quarters of a step of the snapping, 2^-20 cells, beyond samples.
OwnCellMesh besideSamples() {
  OwnCellMesh mesh(shapes::box({3, 2, 3}, {9, 8, 7}), unitGrid({12, 11, 13}));
  for (glm::vec3& v : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis)
      if (v[axis] < 4.0f) v[axis] += 0.75f * 0x1p-20f;
  return mesh;
}

/// Meshes with vertices and faces on samples, of all three ranges of arithmetic, open and degenerate ones.
std::vector<OwnCellMesh> rayMeshes() {
  std::vector<OwnCellMesh> meshes;
  meshes.push_back(soupIn({21, 18, 24}, 0.04, 300));
  meshes.push_back(besideSamples());
  meshes.emplace_back(shapes::voxels({{1, 1, 1}, {2, 2, 2}, {3, 1, 2}}, 3), unitGrid({14, 12, 13}));
  for (const double size : {3.3, 3000.7, 5e6}) {
    const glm::dvec3 low(-0.37 * size, -0.41 * size, -0.53 * size);
    meshes.emplace_back(shapes::box(low, low + glm::dvec3(size)), unitGrid({19, 14, 17}));
  }
  const std::vector<glm::dvec3> p{{1, 1, 1}, {3, 3, 3}, {5, 5, 5}, {2, 5, 3.5}, {-40, 2.5, 3}, {50, 3.25, 3}};
  meshes.emplace_back(
      makeMesh(p, {{0, 1, 2}, {0, 0, 3}, {4, 4, 4}, {0, 2, 3}, {0, 2, 3}, {2, 0, 3}, {4, 5, 3}, {5, 4, 0}}),
      unitGrid({7, 7, 7}));
  return meshes;
}

/// Returns a bent strip and an open box whose edges lie on lattice lines, where rays meet rims.
Mesh openSurfaces() {
  Mesh mesh = shapes::box({3, 2, 3}, {9, 8, 7});
  mesh.triangles.resize(mesh.triangles.size() - 2);
  const std::vector<glm::dvec3> p{{14, 3, 2.5}, {14.3, 9, 3}, {16, 3, 5.5},
                                  {15.5, 9, 5}, {19, 3, 4},   {18, 9, 6.5}};
  return shapes::joined(mesh, makeMesh(p, {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}}));
}

/// Numbers of samples whose rays all meet rims, or pass them closely, are less exact in single precision.
void requireRimNumbers(const std::string& what, const std::vector<float>& found,
                       const Buffer<float>& expected) {
  requireNear(what, found, expected, 0.02);
  size_t inexact = 0;
  for (size_t s = 0; s < found.size(); ++s) inexact += std::abs(found[s] - expected[s]) > 5e-5f ? 1 : 0;
  if (100 * inexact > found.size())
    throw Difference(what + ": " + std::to_string(inexact) + " of " + std::to_string(found.size()) +
                     " differ by more than 5e-5");
}

}  // namespace

void checkRays(Subject& subject) {
  for (const OwnCellMesh& mesh : rayMeshes())
    for (const SignMode mode : {SignMode::Rays, SignMode::Ray}) compareRays(subject.signs, mesh, mode);
}

void checkHarmonic(Subject& subject) {
  WindingHarmonicStage stage(subject.probe.device());
  for (const glm::ivec3 dims : {glm::ivec3(33, 20, 41), glm::ivec3(1, 9, 30)})
    compareHarmonic(subject.probe, stage, rayMapOf(soupIn(dims, 0.03)));
}

void checkRims(Subject& subject) {
  WindingRimsStage stage(subject.probe.device());
  const Grid grid = unitGrid({23, 14, 19});
  const OwnCellMesh mesh(openSurfaces(), grid);
  RimLattices lattices = findRimLattices(openSurfaces(), grid);
  compareRims(subject.probe, stage, mesh.dims, crossingsOf(mesh), lattices);
  lattices.computed.clear();  // As if they were too many.
  compareRims(subject.probe, stage, mesh.dims, crossingsOf(mesh), lattices);
}

void checkPaths(Subject& subject) {
  WindingPathsStage stage(subject.probe.device());
  for (const glm::ivec3 dims : {glm::ivec3(21, 13, 17), glm::ivec3(1, 9, 30)}) {
    const cpu::RayMap map = rayMapOf(soupIn(dims, 0.04));
    for (const SignMode sign : {SignMode::Paths, SignMode::Evolution})
      for (const Sampling sampling : {Sampling::Spread, Sampling::Paper})
        comparePaths(subject.probe, stage, map, {.sign = sign, .passes = 5, .sampling = sampling});
  }
}

void checkOrientation(Subject& subject) {
  const Probe& probe = subject.probe;
  const OwnCellMesh mesh = soupIn({21, 13, 17}, 0.05);
  const cpu::RayMap map = rayMapOf(mesh);
  const Buffer<float> field = randomField(mesh.dims);
  Progress progress;
  const UploadedMesh uploaded = probe.upload(mesh);
  const UploadedRays rays(probe, map);
  const DeviceBuffer onDevice = probe.upload(field, "field");
  OrientationStage stage(probe.device());
  stage.reserve(mesh.dims, uploaded.addresses().triangleCount);
  const OrientationStage::Fields fields{.rays = {.dims = mesh.dims, .axes = rays.addresses()},
                                        .field = onDevice.address(),
                                        .mesh = uploaded.addresses()};
  Buffer<float> rises, wholeness;
  cpu::measureSides(mesh, {}, field, 0.5f, progress, rises, &wholeness);
  for (const SideMeasure measure : {SideMeasure::Rise, SideMeasure::Wholeness}) {
    probe.run([&](Commands& commands) { stage.recordSides(commands, fields, 0.5f, measure); });
    requireNear("measures of the faces", stage.sides(), measure == SideMeasure::Rise ? rises : wholeness,
                1e-4);
  }
  probe.run([&](Commands& commands) { stage.recordMisfit(commands, fields); });
  requireNear("misfit", std::vector{stage.misfit()},
              std::vector{measureMisfit(mesh.dims, crossingsOf(mesh), field)}, 1e-5, 1e-5);
  require(stage.contradictsParity() == contradictsParity(map, field, fields.threshold),
          "contradiction to the parity");
  Buffer<float> parity;
  averageParity(map, parity);
  probe.run([&](Commands& commands) { stage.recordParity(commands, fields); });
  requireEqual("parity", probe.download<float>(onDevice), parity);
}

void checkCloseHoles(Subject& subject) {
  CloseHolesStage stage(subject.probe.device());
  const OwnCellMesh mesh = soupIn({21, 13, 17}, 0.05);
  compareMissingEdges(subject.probe, stage, mesh, randomField(mesh.dims));
}

void checkFinish(Subject& subject) {
  const Probe& probe = subject.probe;
  const glm::ivec3 dims(21, 13, 17);
  const cpu::RayMap map = rayMapOf(soupIn(dims, 0.05, 60));
  const UploadedRays rays(probe, map);
  Buffer<float> values(CellLattice{dims}.count()), distances(values.size()), confidences;
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = 0.1f * (float(i % 27) - 13.0f);
    distances[i] = 0.25f * float(i % 20);
  }
  values[5] = 0.5f;
  const DeviceBuffer winding = probe.upload(values, "winding");
  FinishStage finish(probe.device());
  const auto compare = [&](bool hasSign, const FinishStage::Options& options) {
    Buffer<float> expected = distances.clone();
    const DeviceBuffer distance = probe.upload(expected, "distance"),
                       confidence = probe.upload(expected, "confidence");
    FinishStage::Fields fields{.distance = distance.address()};
    if (hasSign) fields = {rays.addresses(), winding.address(), distance.address(), confidence.address()};
    probe.run([&](Commands& commands) { finish.record(commands, fields, glm::uvec3(dims), options); });
    if (hasSign) {
      cpu::applySign(values, options.threshold, options.isInverted, expected);
      computeConfidence(map, values, options.threshold, confidences);
      requireNear("confidences", probe.download<float>(confidence), confidences, 1e-6);
    }
    cpu::finishDistance(options.band, options.spacing, expected);
    requireEqual("distances", probe.download<float>(distance), expected);
  };
  for (const double band : {0.0, 3.0}) {
    compare(false, {.band = band, .spacing = 0.5});
    for (const double threshold : {0.3, 0.5, 1.2})
      for (const bool isInverted : {false, true}) compare(true, {threshold, isInverted, band, 0.5});
  }
}

void compareRays(SignProbe& probe, const CellMesh& mesh, SignMode mode) {
  Progress progress;
  const cpu::Crossings crossings = crossingsOf(mesh);
  cpu::RayMap map;
  buildRayMap(mesh.dims, crossings, map);
  Buffer<float> winding;
  const size_t doubtful = (mode == SignMode::Ray ? cpu::takeOneRay : cpu::averageRays)(
      cpu::RaySweep(map), progress, 1.0, winding);
  const EdgeCounts counts = edgeCounts(crossings, mesh.dims), rays = edgeCounts(map);
  const SignResult result = probe.compute(mesh, mode);
  inCase(nameOf(mesh), [&] {
    for (size_t axis = 0; axis < 3; ++axis) {
      requireEqual("crossings along axis " + textOf(axis), result.crossings[axis], counts[axis]);
      requireEqual("rays along axis " + textOf(axis), result.rays[axis], rays[axis]);
    }
    requireEqual("winding numbers", result.winding, winding);
    require(result.doubtful == doubtful,
            textOf(result.doubtful) + " doubtful samples, not " + textOf(doubtful));
    require(probe.compute(mesh, mode) == result, "other values the second time");
  });
}

void compareHarmonic(const Probe& probe, WindingHarmonicStage& stage, const cpu::RayMap& map) {
  Progress progress;
  cpu::HarmonicScratch scratch;
  Buffer<float> expected(CellLattice{map.dims}.count());
  solveHarmonic(map, progress, 0.0, scratch, expected);

  stage.reserve(map.dims);
  inCase(textOf(map.dims, " x "), [&] {
    requireNear("winding numbers",
                windingAfter(probe, map, std::vector<float>(expected.size(), 7.0f), 1,
                             [&](Commands& commands, const auto& fields) { stage.record(commands, fields); }),
                expected, 2e-5);
  });
}

void compareRims(const Probe& probe, WindingRimsStage& stage, const glm::ivec3& dims,
                 const cpu::Crossings& crossings, const RimLattices& lattices) {
  constexpr double kThreshold = 0.5;
  Progress progress;
  WindingDoubtsStage doubts(probe.device());
  cpu::RayMap map;
  cpu::buildRayMap(dims, crossings, map);
  cpu::HarmonicScratch scratch;
  Buffer<float> expected = randomField(map.dims), distance = expected.clone();
  for (float& each : distance) each = 20.0f * std::abs(each);
  const DeviceBuffer winding = probe.upload(expected, "winding"),
                     distances = probe.upload(distance, "distance");
  const DeviceBuffer disagreeing = probe.upload(std::vector<uint32_t>{1}, "disagreeing");
  const UploadedRays rays(probe, map);
  const LatticeLines lines{.dims = map.dims, .axes = rays.addresses()};
  stage.reserve(map.dims);
  inCase(textOf(map.dims, " x ") + ", " + textOf(int(lattices.rims.size())) + " rims", [&] {
    probe.run([&](Commands& commands) { stage.record(commands, lines, lattices, winding.address()); });
    if (lattices.haveAll()) computeFromRims(map, lattices, progress, 0.0, scratch, expected);
    requireRimNumbers("winding numbers", probe.download<float>(winding), expected);
    probe.run([&](Commands& commands) {
      doubts.record(commands, lines, winding.address(), disagreeing.address());
      stage.recordSettling(commands, lines, distances.address(), doubts.change().address(), kThreshold,
                           winding.address());
    });
    settleByRims(map, lattices,
                 findDoubts(map.dims, crossings, expected, distance, lattices.source(), kThreshold), progress,
                 expected);
    requireRimNumbers("winding numbers near the threshold", probe.download<float>(winding), expected);
  });
}

void comparePaths(const Probe& probe, WindingPathsStage& stage, const cpu::RayMap& map,
                  const FieldOptions& options) {
  Progress progress;
  cpu::PathScratch scratch;
  const cpu::RaySweep sweep(map);
  Buffer<float> average;
  averageRays(sweep, progress, 1.0, average);
  Buffer<float> expected = average.clone();
  const auto walk = options.sign == SignMode::Paths ? cpu::averagePaths : cpu::evolvePaths;
  walk(sweep, options, progress, 0.0, scratch, expected);

  stage.reserve(map.dims);
  const auto record = [&](Commands& commands, const WindingFields& fields) {
    if (options.sign == SignMode::Paths)
      stage.recordAverage(commands, fields, options);
    else
      stage.recordEvolution(commands, fields, options);
  };
  inCase(textOf(map.dims, " x ") + ", " + textOf(options.passes) + " passes",
         [&] { requireEqual("winding numbers", windingAfter(probe, map, average, 1, record), expected); });
}

void compareMissingEdges(const Probe& probe, CloseHolesStage& stage, const CellMesh& mesh,
                         const Buffer<float>& winding) {
  constexpr double kThreshold = 0.6;
  const UploadedMesh uploaded = probe.upload(mesh);
  const DeviceBuffer numbers = probe.upload(winding, "winding");
  CrossingsStage crossings(probe.device());
  crossings.reserve(mesh.dims, mesh.triangles.size(), true);
  do
    probe.run([&](Commands& commands) {
      crossings.record(commands, uploaded.addresses());
      stage.recordSearch(commands, mesh.dims, crossings.crossed(), numbers.address(), kThreshold);
    });
  while (stage.growIfFull());
  const auto numbersOf = [](const std::vector<MissingEdge>& edges) {
    std::vector<double> all;
    for (const MissingEdge& edge : edges)
      for (const double number : {double(edge.first), double(edge.axis), double(edge.rimCubes),
                                  double(edge.winding[0]), double(edge.winding[1])})
        all.push_back(number);
    return all;
  };
  Progress progress;
  requireEqual("missing edges", numbersOf(stage.edges()),
               numbersOf(findMissingEdges(rayMapOf(mesh), winding, kThreshold, progress)));
}

}  // namespace raymap::vulkan
