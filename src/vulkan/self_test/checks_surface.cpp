#include <cmath>
#include <cstring>

#include "cpu/distance/surface_tree.h"
#include "cpu/sign/winding_dipoles.h"
#include "mesh/double_sided.h"
#include "mesh/rim_edges.h"
#include "testing/reference.h"
#include "vulkan/self_test/cells.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/face_probe.h"
#include "vulkan/stages/exact_distance.h"
#include "vulkan/stages/finish.h"
#include "vulkan/stages/surface_tree.h"
#include "vulkan/stages/winding_dipoles.h"

namespace raymap::vulkan {

namespace {

/// Checks that the tree lists every triangle once, within the discs of all nodes above it.
void checkTree(const Probe& probe, const SurfaceTreeStage& tree, const CellMesh& mesh) {
  const size_t count = mesh.triangles.size();
  const auto frames = probe.download<glm::vec4>(tree.frames()),
             discs = probe.download<glm::vec4>(tree.discs());
  const auto outside = [&](uint32_t node, const glm::dvec3& p) {
    const glm::vec4 first = discs.at(node * kDiscVectors), second = discs.at(node * kDiscVectors + 1);
    const glm::dvec3 q = p - glm::dvec3(first), normal(second);
    const double height = glm::dot(q, normal);
    return std::max(
        {glm::length(q - height * normal) - double(first.w), std::abs(height) - double(second.w), 0.0});
  };
  std::vector<int> listed(count);
  for (size_t place = 0; place < count; ++place) {
    uint32_t id = 0;
    std::memcpy(&id, &frames.at(place * kFrameVectors + 3).z, sizeof id);
    require(id < count, "place " + textOf(place) + " holds triangle " + textOf(id));
    ++listed[id];
    for (int corner = 0; corner < 3; ++corner)
      for (auto node = tree.firstLeaf() + static_cast<uint32_t>(place / kTreeArity);;
           node = (node - 1) / kTreeArity) {
        const double distance = outside(node, glm::dvec3(mesh.corner(id, corner)));
        require(distance < 1e-4, "triangle " + textOf(id) + " lies " + textOf(distance) +
                                     " cells outside the disc of node " + textOf(node));
        if (node == 0) break;
      }
  }
  requireEqual("times that each triangle is listed", listed, std::vector<int>(count, 1));
}

std::vector<OwnCellMesh> surfaceMeshes() {
  const auto onGrid = [](const Mesh& mesh, const GridOptions& options) {
    return OwnCellMesh(mesh, fitGrid(mesh, options));
  };
  std::vector<OwnCellMesh> meshes;
  for (const int count : {1, 9, 65, 513})
    meshes.push_back(onGrid(shapes::soup(count, unsigned(count)), {.resolution = 14}));
  meshes.push_back(onGrid(shapes::torus(1.0, 0.3, 60, 40), {.resolution = 24}));
  meshes.push_back(onGrid(shapes::torus(1.0, 0.3, 40, 20),
                          {.resolution = 20, .box = Box{{0.5, 0.1, -0.2}, {1.9, 1.2, 0.6}}}));
  meshes.push_back(
      onGrid(shapes::joined(shapes::sphere(1.0, 2), shapes::sphere(0.01, 3, {3, 0, 0})), {.resolution = 20}));
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0, 1, 0}, {0, 1, 1e-12}, {1, 1, 1}};
  meshes.push_back(
      onGrid(makeMesh(p, {{0, 0, 0}, {0, 1, 2}, {3, 4, 5}, {5, 5, 1}, {2, 1, 0}}), {.resolution = 9}));
  return meshes;
}

void checkSurfaceTree(Subject& subject) {
  SurfaceTreeStage tree(subject.probe.device());
  for (const OwnCellMesh& mesh : surfaceMeshes()) {
    const UploadedMesh uploaded = subject.probe.upload(mesh);
    tree.reserve(uploaded.addresses().triangleCount);
    subject.probe.run([&](Commands& commands) { tree.record(commands, uploaded.addresses(), mesh.dims); });
    inCase(nameOf(mesh), [&] { checkTree(subject.probe, tree, mesh); });
  }
}

/// Compares every `stride`-th sample with brute force in double precision.
void requireExact(const CellMesh& cells, const Mesh& mesh, const std::vector<float>& distance,
                  const std::vector<uint32_t>& triangle, size_t stride) {
  const Box box = bounds(mesh);
  const double allowed = 1e-6 * glm::length(box.size());
  for (size_t s = 0; s < distance.size(); s += stride) {
    const glm::dvec3 p(CellLattice{cells.dims}.cell(s));
    const double truth = reference::distance(mesh, p);
    require(std::abs(distance[s] - truth) <= allowed,
            "distance of sample " + textOf(s) + " is " + textOf(distance[s]) + ", not " + textOf(truth));
    require(triangle[s] < mesh.triangles.size(),
            "the closest triangle of sample " + textOf(s) + " is " + textOf(triangle[s]));
    const glm::uvec3 t = mesh.triangles[triangle[s]];
    const double named =
        reference::triangleDistance(p, mesh.position(t.x), mesh.position(t.y), mesh.position(t.z));
    require(std::abs(named - truth) <= allowed, "triangle " + textOf(triangle[s]) + " of sample " +
                                                    textOf(s) + " lies at " + textOf(named) + ", not " +
                                                    textOf(truth));
  }
}

void checkExactDistance(Subject& subject) {
  const Probe& probe = subject.probe;
  SurfaceTreeStage tree(probe.device());
  ExactDistanceStage exact(probe.device());
  for (const OwnCellMesh& mesh : surfaceMeshes()) {
    const UploadedMesh uploaded = probe.upload(mesh);
    DeviceBuffer distance(probe.device(), "distance"), triangle(probe.device(), "triangle");
    const size_t samples = CellLattice{mesh.dims}.count();
    distance.resize<float>(samples);
    triangle.resize<uint32_t>(samples);
    tree.reserve(uploaded.addresses().triangleCount);
    exact.reserve(mesh.dims);
    const auto measured = [&](double band) {
      probe.run([&](Commands& commands) {
        tree.record(commands, uploaded.addresses(), mesh.dims);
        exact.record(commands, tree, band, {distance.address(), triangle.address()});
      });
      return probe.download<float>(distance);
    };
    inCase(nameOf(mesh), [&] {
      const std::vector<float> found = measured(0.0);
      requireExact(mesh, mesh.asMesh(), found, probe.download<uint32_t>(triangle),
                   1 + samples * mesh.triangles.size() / 1000000);
      requireEqual("distances the second time", measured(0.0), found);
      constexpr float kBand = 2.0f;
      std::vector<float> clamped(found);
      for (float& d : clamped) d = std::min(d, kBand);
      requireNear("distances in the band", measured(kBand), clamped, 1e-5);
    });
  }
}

void checkDipoles(Subject& subject) {
  const Probe& probe = subject.probe;
  constexpr double kThreshold = 0.5;
  SurfaceTreeStage tree(probe.device());
  WindingDipolesStage dipoles(probe.device());
  Mesh open = shapes::sphere(1.0, 3);
  std::erase_if(open.triangles, [&](const glm::uvec3& t) { return open.position(t.x).z > 0.6; });
  for (const Mesh& mesh : {shapes::soup(9, 5), shapes::soup(600, 6), open}) {
    const OwnCellMesh cells(mesh, fitGrid(mesh, {.resolution = 14}));
    const size_t samples = CellLattice{cells.dims}.count();
    const UploadedMesh uploaded = probe.upload(cells);
    const uint32_t count = uploaded.addresses().triangleCount;
    const DeviceBuffer distance = probe.upload(std::vector<float>(samples, 0.0f), "distance");
    const DeviceBuffer winding = probe.upload(std::vector<float>(samples, 0.5f), "winding");
    const DeviceBuffer disagreeing = probe.upload<uint32_t>({1}, "disagreeing");
    const DeviceBuffer change = probe.upload<float>({0.0f}, "change");
    tree.reserve(count);
    dipoles.reserve(count, cells.dims);
    probe.run([&](Commands& commands) {
      tree.record(commands, uploaded.addresses(), cells.dims);
      dipoles.record(commands, tree,
                     {distance.address(), winding.address(), disagreeing.address(), change.address()}, {},
                     kThreshold);
    });
    const std::vector<float> found = probe.download<float>(winding);
    const Mesh inCells = cells.asMesh();
    const size_t stride = 1 + samples * count / 1000000;
    inCase(nameOf(cells), [&] {
      size_t wrong = 0, looked = 0;
      for (size_t s = 0; s < samples; s += stride, ++looked) {
        const double truth = reference::windingNumber(inCells, glm::dvec3(CellLattice{cells.dims}.cell(s)));
        require(std::abs(found[s] - truth) < 0.06, "winding number of sample " + textOf(s) + " is " +
                                                       textOf(found[s]) + ", not " + textOf(truth));
        wrong += (std::abs(found[s]) > kThreshold) != (std::abs(truth) > kThreshold) ? 1 : 0;
      }
      require(wrong <= 1 + looked / 1000, textOf(wrong) + " of " + textOf(looked) +
                                              " winding numbers lie on the wrong side of the threshold");
    });
  }
}

void checkFaceSearch(Subject& subject) {
  const Probe& probe = subject.probe;
  Mesh open = shapes::sphere(1.0, 4);
  std::erase_if(open.triangles, [&](const glm::uvec3& t) { return open.position(t.x).z > 0.9; });
  Mesh doubled = open;
  for (size_t f = 0; f < open.triangles.size(); f += 7) {
    const glm::uvec3& t = open.triangles[f];
    doubled.triangles.emplace_back(t.y, t.x, t.z);
  }
  for (const Mesh& mesh : {shapes::sphere(1.0, 4), open, doubled, shapes::soup(300, 8)}) {
    FaceSearchStage search(probe.device());
    searchFaces(probe, search, mesh);
    const auto ends = [](const std::vector<RimEdge>& edges) {
      std::vector<uint32_t> all;
      for (const RimEdge& edge : edges) all.insert(all.end(), {edge.from, edge.to, edge.times});
      return all;
    };
    requireEqual("rims", ends(findRimEdges(mesh, search.edges().value())), ends(findRimEdges(mesh, 0.1)));
    const DoubleSidedFaces found = findDoubleSidedFaces(mesh, search.faces().value()),
                           expected = findDoubleSidedFaces(mesh);
    requireEqual("first double-sided faces", found.firsts, expected.firsts);
    requireEqual("other double-sided faces", found.others, expected.others);
    require(search.faces()->size() < expected.count() + 10, "the device lists too many faces");
  }
}

void checkFinish(Subject& subject) {
  const std::vector<float> values{-5.0f, -3.0f, -0.25f, 0.0f, 1.5f, 3.5f};
  FinishStage finish(subject.probe.device());
  const auto finished = [&](double band) {
    const DeviceBuffer distance = subject.probe.upload(values, "distance");
    subject.probe.run([&](Commands& commands) {
      finish.record(commands, distance.address(), uint32_t(values.size()), band, 0.5);
    });
    return subject.probe.download<float>(distance);
  };
  requireEqual("distances", finished(0.0), std::vector{-2.5f, -1.5f, -0.125f, 0.0f, 0.75f, 1.75f});
  requireEqual("distances in the band", finished(3.0), std::vector{-1.5f, -1.5f, -0.125f, 0.0f, 0.75f, 1.5f});
}

}  // namespace

std::span<const Check> checksOfSurface() {
  static constexpr Check kChecks[] = {{"surface_tree", checkSurfaceTree},
                                      {"exact_distance", checkExactDistance},
                                      {"winding_dipoles", checkDipoles},
                                      {"face_search", checkFaceSearch},
                                      {"finish", checkFinish}};
  return kChecks;
}

}  // namespace raymap::vulkan
