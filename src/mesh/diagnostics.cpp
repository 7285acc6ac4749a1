#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <atomic>

#include "base/parallel_sort.h"
#include "base/progress.h"
#include "mesh/defects.h"
#include "mesh/disjoint_sets.h"
#include "mesh/double_sided.h"
#include "mesh/half_edges.h"
#include "mesh/holes.h"
#include "mesh/weld.h"

namespace raymap {

namespace {

constexpr double kDegenerateHeight = 1e-6;  // Share of the longest edge.
constexpr size_t kKeysPerTask = size_t{1} << 16;
constexpr size_t kFacesPerTask = size_t{1} << 13, kFacesPerRound = size_t{1} << 17;

bool hasRepeatedCorner(const glm::uvec3& face) {
  return face.x == face.y || face.y == face.z || face.z == face.x;
}

glm::dvec3 normalOf(const PackedMesh& mesh, const glm::uvec3& face) {
  const glm::dvec3 a(mesh.vertices[face.x]);
  return glm::cross(glm::dvec3(mesh.vertices[face.y]) - a, glm::dvec3(mesh.vertices[face.z]) - a);
}

/// Returns whether the triangle's height is below `kDegenerateHeight`. The height over the longest edge is
/// twice the area over that edge's length.
bool isFlat(const PackedMesh& mesh, const glm::uvec3& face, double doubleArea) {
  double longest2 = 0.0;
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 edge = glm::dvec3(mesh.vertices[face[c]]) - glm::dvec3(mesh.vertices[face[(c + 1) % 3]]);
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  return doubleArea < kDegenerateHeight * longest2;
}

/// Area and volume of a face, and what is wrong with it.
struct FaceMeasure {
  double area = 0.0, volume = 0.0;
  bool isDegenerate = false, isSurface = false;
};

FaceMeasure measureFace(const PackedMesh& mesh, const glm::uvec3& face, const glm::uvec3& welded,
                        const glm::dvec3& centre) {
  if (hasRepeatedCorner(welded)) return {.isDegenerate = true};
  const glm::dvec3 normal = normalOf(mesh, face);
  const double doubleArea = glm::length(normal);
  return {.area = doubleArea / 2.0,
          .volume = glm::dot(glm::dvec3(mesh.vertices[face.x]) - centre, normal) / 6.0,
          .isDegenerate = isFlat(mesh, face, doubleArea),
          .isSurface = true};
}

glm::uvec3 weldedFace(const PackedMesh& mesh, const Welding& welding, size_t face) {
  const glm::uvec3& t = mesh.triangles[face];
  return {welding.ids[t.x], welding.ids[t.y], welding.ids[t.z]};
}

/// Measures area and volume, and counts degenerate faces. The volume is taken about the centre of the bounds,
/// so that an open mesh's volume does not depend on its position. Faces with a repeated corner belong to no
/// surface. Sums are taken in the order of the faces, so that they do not depend on the number of threads.
void measureFaces(const PackedMesh& mesh, const Welding& welding, Diagnostics& found) {
  const glm::dvec3 centre = found.bounds.centre() - mesh.origin;
  Buffer<FaceMeasure> measures(std::min(kFacesPerRound, mesh.triangles.size()));
  for (size_t first = 0; first < mesh.triangles.size(); first += kFacesPerRound) {
    const size_t count = std::min(kFacesPerRound, mesh.triangles.size() - first);
    parallelFor(count, kFacesPerTask, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f)
        measures[f] =
            measureFace(mesh, mesh.triangles[first + f], weldedFace(mesh, welding, first + f), centre);
    });
    for (const FaceMeasure& measure : std::span(measures.data(), count)) {
      found.degenerateFaces += measure.isDegenerate ? 1 : 0;
      if (!measure.isSurface) continue;
      found.area += measure.area;
      found.signedVolume += measure.volume;
    }
  }
}

std::vector<Hole> findHoles(const PackedMesh& mesh, const Welding& welding,
                            std::span<const std::pair<uint32_t, uint32_t>> boundary) {
  std::vector<uint32_t> vertexOf(welding.count);
  for (uint32_t v = 0; v < welding.ids.size(); ++v) vertexOf[welding.ids[v]] = v;
  return traceHoles(boundary, [&](uint32_t position) { return mesh.position(vertexOf[position]); });
}

/// Edges of one task, in order.
struct EdgeCounts {
  std::vector<std::pair<uint32_t, uint32_t>> boundary;
  std::vector<uint32_t> layers;  ///< Faces that may have the same corners as another one.
  size_t nonManifold = 0, flipped = 0;
  bool isBalanced = true;

  void add(std::span<const SortKey> edge) {
    size_t forward = 0;
    for (const SortKey& key : edge) forward += halfEdgeOf(key).isForward ? 1 : 0;
    if (edge.size() == 1) boundary.emplace_back(halfEdgeOf(edge[0]).low, halfEdgeOf(edge[0]).high);
    if (edge.size() > 2) ++nonManifold;
    if (edge.size() == 2 && forward != 1) ++flipped;
    if (2 * forward != edge.size()) isBalanced = false;
    addLayers(edge);
  }

  /// Adds the faces that share the edge's third corner too, as far as its bits tell.
  void addLayers(std::span<const SortKey> edge) {
    if (edge.size() == 2) {  // The usual case.
      if (halfEdgeOf(edge[0]).thirdBits != halfEdgeOf(edge[1]).thirdBits) return;
    } else if (edge.size() == 1) {
      return;
    }
    for (const SortKey& key : edge) layers.push_back(halfEdgeOf(key).face);
  }

  void append(const EdgeCounts& other) {
    boundary.insert(boundary.end(), other.boundary.begin(), other.boundary.end());
    layers.insert(layers.end(), other.layers.begin(), other.layers.end());
    nonManifold += other.nonManifold;
    flipped += other.flipped;
    isBalanced = isBalanced && other.isBalanced;
  }
};

EdgeCounts countEdges(std::span<const SortKey> halfEdges) {
  std::vector<EdgeCounts> tasks((halfEdges.size() + kKeysPerTask - 1) / kKeysPerTask);
  parallelFor(tasks.size(), 1, [&](size_t task, size_t) {
    const size_t begin = task * kKeysPerTask, end = std::min(begin + kKeysPerTask, halfEdges.size());
    forEachEdge(halfEdges, begin, end, [&](std::span<const SortKey> edge) { tasks[task].add(edge); });
  });
  EdgeCounts all;
  for (const EdgeCounts& task : tasks) all.append(task);
  return all;
}

/// Counts duplicate and double-sided faces among those that may have the same corners as another one.
void countLayers(const PackedMesh& mesh, const Welding& welding, std::vector<uint32_t>& layers,
                 Diagnostics& found) {
  parallelSort(layers.begin(), layers.end());
  layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
  std::vector<glm::uvec3> faces(layers.size());
  std::vector<std::array<uint32_t, 3>> corners(layers.size());
  for (size_t f = 0; f < layers.size(); ++f) {
    faces[f] = mesh.triangles[layers[f]];
    const glm::uvec3 welded = weldedFace(mesh, welding, layers[f]);
    corners[f] = {welded.x, welded.y, welded.z};
    std::sort(corners[f].begin(), corners[f].end());
  }
  parallelSort(corners.begin(), corners.end());
  found.duplicateFaces = size_t(corners.end() - std::unique(corners.begin(), corners.end()));
  if (found.duplicateFaces > 0)
    found.doubleSidedFaces = findDoubleSidedFaces({mesh.vertices, faces, mesh.origin}).count();
}

/// Counts the parts of the surface that half edges connect.
size_t countComponents(std::span<const SortKey> halfEdges, size_t positions) {
  DisjointSets sets(positions);
  std::vector<uint8_t> isLinked(positions, 0);  // Whether another position was linked to this one.
  parallelFor(halfEdges.size(), kKeysPerTask, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      if (k > 0 && halfEdges[k].high == halfEdges[k - 1].high) continue;
      const HalfEdge edge = halfEdgeOf(halfEdges[k]);
      if (const auto root = sets.link(edge.low, edge.high))
        std::atomic_ref(isLinked[*root]).store(1, std::memory_order_relaxed);
    }
  });
  size_t count = 0;
  for (uint32_t p = 0; p < positions; ++p) count += isLinked[p] != 0 && sets.root(p) == p ? 1 : 0;
  return count;
}

}  // namespace

Diagnostics diagnose(const MeshView& view, const DiagnoseOptions& options) {
  validate(view);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  Progress progress(options.progress);
  Diagnostics found;
  progress.stage("diagnose", [&] {
    Buffer<SortKey> keys;
    const Welding welding = weldVertices(mesh.vertices, keys);
    progress.report(0.3);
    found.vertices = mesh.vertices.size();
    found.weldedVertices = welding.count;
    found.triangles = mesh.triangles.size();
    found.bounds = bounds(mesh);
    measureFaces(mesh, welding, found);
    progress.report(0.4);
    const std::span<const SortKey> halfEdges = sortHalfEdges(mesh, welding, keys);
    progress.report(0.7);
    EdgeCounts edges = countEdges(halfEdges);
    found.boundaryEdges = edges.boundary.size();
    found.nonManifoldEdges = edges.nonManifold;
    found.flippedEdges = edges.flipped;
    found.balanced = !halfEdges.empty() && edges.isBalanced;
    found.watertight = !halfEdges.empty() && found.boundaryEdges == 0 && found.nonManifoldEdges == 0;
    found.consistentlyOriented = found.flippedEdges == 0;
    countLayers(mesh, welding, edges.layers, found);
    if (options.isBrief) return;
    progress.report(0.8);
    found.components = countComponents(halfEdges, welding.count);
    progress.report(0.9);
    if (!edges.boundary.empty()) found.holes = findHoles(mesh, welding, edges.boundary);
    if (!found.consistentlyOriented)
      found.flippedFaces = findFlippedFaces(findPatches(mesh, welding, halfEdges)).size();
  });
  return found;
}

}  // namespace raymap
