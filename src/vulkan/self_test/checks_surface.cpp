#include <cmath>

#include "mesh/double_sided.h"
#include "mesh/rim_edges.h"
#include "testing/broken_meshes.h"
#include "testing/reference.h"
#include "vulkan/self_test/checks.h"
#include "vulkan/self_test/compare.h"

namespace raymap::vulkan {

namespace {

/// Compares every `stride`-th sample with brute force in double precision.
void requireExact(const Mesh& mesh, const glm::ivec3& dims, const ClosestResult& found, size_t stride) {
  const double allowed = 1e-6 * glm::length(bounds(mesh).size());
  for (size_t s = 0; s < found.distance.size(); s += stride) {
    const glm::dvec3 p(CellLattice{dims}.cell(s));
    const double truth = reference::distance(mesh, p);
    require(
        std::abs(found.distance[s] - truth) <= allowed,
        "distance of sample " + textOf(s) + " is " + textOf(found.distance[s]) + ", not " + textOf(truth));
    const uint32_t id = found.triangle[s];
    require(id < mesh.triangles.size(), "the closest triangle of sample " + textOf(s) + " is " + textOf(id));
    const glm::uvec3 t = mesh.triangles[id];
    const double named =
        reference::triangleDistance(p, mesh.position(t.x), mesh.position(t.y), mesh.position(t.z));
    require(std::abs(named - truth) <= allowed, "triangle " + textOf(id) + " of sample " + textOf(s) +
                                                    " lies at " + textOf(named) + ", not " + textOf(truth));
  }
}

/// Checks that samples beyond the band have its width and no triangle.
void requireBand(const ClosestResult& banded, const std::vector<float>& distances, float band) {
  std::vector<float> clamped(distances);
  for (float& d : clamped) d = std::min(d, band);
  requireNear("distances in the band", banded.distance, clamped, 1e-5);
  for (size_t s = 0; s < distances.size(); ++s)
    require(
        (banded.triangle[s] == kNoTriangle) == (distances[s] > band) || std::abs(distances[s] - band) < 1e-5f,
        "the closest triangle of sample " + textOf(s) + " in the band is " + textOf(banded.triangle[s]));
}

std::vector<OwnCellMesh> surfaceMeshes() {
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

}  // namespace

void checkSurfaceTree(Subject& subject) {
  for (const OwnCellMesh& mesh : surfaceMeshes()) checkTree(subject.surface, mesh, 1e-4);
}

void checkExactDistance(Subject& subject) {
  for (const OwnCellMesh& mesh : surfaceMeshes()) checkClosest(subject.surface, mesh, 2.0f);
}

void checkDipoles(Subject& subject) {
  WindingDipolesStage dipoles(subject.probe.device());
  for (const Mesh& mesh : {shapes::soup(9, 5), shapes::soup(600, 6), withoutCap(shapes::sphere(1.0, 3), 0.6)})
    checkSettled(subject.surface, dipoles, onGrid(mesh, {.resolution = 14}));
}

void checkFaceSearch(Subject& subject) {
  FaceSearchStage search(subject.probe.device());
  const Mesh open = withoutCap(shapes::sphere(1.0, 4), 0.9);
  for (const Mesh& mesh :
       {shapes::sphere(1.0, 4), open, withDoubledFaces(open, 0.15, 1), shapes::soup(300, 8)})
    compareFaceSearch(subject.probe, search, mesh);
}

TreeOnHost checkTree(SurfaceProbe& probe, const CellMesh& mesh, double allowed) {
  TreeOnHost tree = probe.tree(mesh);
  const size_t count = mesh.triangles.size();
  std::vector<int> listed(count);
  inCase(nameOf(mesh), [&] {
    for (size_t place = 0; place < count; ++place) {
      const uint32_t id = tree.triangleId(place);
      require(id < count, "place " + textOf(place) + " holds triangle " + textOf(id));
      ++listed[id];
      for (int corner = 0; corner < 3; ++corner)
        for (uint32_t node = tree.leafOf(place);; node = (node - 1) / kTreeArity) {
          const double distance = tree.distance(node, glm::dvec3(mesh.corner(id, corner)));
          require(distance <= allowed, "triangle " + textOf(id) + " lies " + textOf(distance) +
                                           " cells outside the disc of node " + textOf(node));
          if (node == 0) break;
        }
    }
    requireEqual("times that each triangle is listed", listed, std::vector<int>(count, 1));
  });
  return tree;
}

void checkClosest(SurfaceProbe& probe, const OwnCellMesh& mesh, float band, double looks) {
  inCase(nameOf(mesh), [&] {
    const ClosestResult found = probe.closest(mesh);
    const double pairs = double(found.distance.size()) * double(mesh.triangles.size());
    requireExact(mesh.asMesh(), mesh.dims, found, 1 + static_cast<size_t>(pairs / looks));
    require(probe.closest(mesh) == found, "other distances or triangles the second time");
    requireBand(probe.closest(mesh, band), found.distance, band);
  });
}

void checkSettled(SurfaceProbe& probe, WindingDipolesStage& dipoles, const OwnCellMesh& mesh) {
  constexpr double kThreshold = 0.5;
  const std::vector<float> found =
      probe.settle(dipoles, mesh, std::vector<float>(CellLattice{mesh.dims}.count(), 0.5f));
  const Mesh inCells = mesh.asMesh();
  inCase(nameOf(mesh), [&] {
    size_t wrong = 0, looked = 0;
    double sum = 0.0;
    for (size_t s = 0; s < found.size(); s += 1 + found.size() * mesh.triangles.size() / 1000000, ++looked) {
      const double truth = reference::windingNumber(inCells, glm::dvec3(CellLattice{mesh.dims}.cell(s)));
      const double error = std::abs(found[s] - truth);
      // Numbers near the threshold are computed more accurately.
      require(error < (std::abs(std::abs(found[s]) - kThreshold) < 0.015 ? 0.005 : 0.05),
              "winding number of sample " + textOf(s) + " is " + textOf(found[s]) + ", not " + textOf(truth));
      wrong += (std::abs(found[s]) > kThreshold) != (std::abs(truth) > kThreshold) ? 1 : 0;
      sum += error;
    }
    require(wrong <= 1 + looked / 1000, textOf(wrong) + " of " + textOf(looked) +
                                            " winding numbers lie on the wrong side of the threshold");
    require(sum < 0.008 * double(looked),
            "winding numbers err by " + textOf(sum / double(looked)) + " on average");
  });
}

void searchFaces(const Probe& probe, FaceSearchStage& search, const Mesh& mesh) {
  MeshUpload upload(probe.device());
  CellMeshStage cells(probe.device());
  upload.fill(mesh);
  const CellMeshStage::Source& source = upload.source();
  cells.reserve(source.vertexCount, source.triangleCount);
  search.reserve(source.vertexCount + 5, source.triangleCount + 7);
  const Grid grid{.dims = glm::ivec3(1), .spacing = 1.0};
  probe.run([&](Commands& commands) {
    cells.record(commands, source, grid, 0.0, search.vertexHashes());
    search.record(commands, cells.mesh());
  });
}

void compareFaceSearch(const Probe& probe, FaceSearchStage& search, const Mesh& mesh) {
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
  requireEqual("groups of double-sided faces", found.groupOf, expected.groupOf);
  requireEqual("repeated faces", found.repeated, expected.repeated);
  require(search.faces()->size() < expected.count() + expected.repeated.size() + 10,
          "the device lists too many faces");
}

}  // namespace raymap::vulkan
