#include "mesh/diagnostics.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "base/progress.h"
#include "mesh/defects.h"
#include "mesh/double_sided.h"
#include "mesh/face_measures.h"
#include "mesh/far_vertices.h"
#include "mesh/half_edges.h"
#include "mesh/holes.h"
#include "mesh/weld.h"

namespace raymap {

namespace {

/// Measures area and volume, and counts degenerate faces. The volume is taken about the centre of the bounds,
/// so that an open mesh's volume does not depend on its position.
void measureFaces(const Model& mesh, Diagnostics& found) {
  const glm::dvec3 centre = found.bounds.centre() - mesh.origin;
  forEachFaceMeasure(mesh, centre, [&](size_t, const FaceMeasure& measure) {
    found.degenerateFaces += measure.isDegenerate ? 1 : 0;
    if (!measure.isSurface) return;
    found.area += measure.area;
    found.signedVolume += measure.volume;
  });
}

std::vector<TracedHole> findHoles(const Model& mesh,
                                  std::span<const std::pair<uint32_t, uint32_t>> boundary) {
  if (boundary.empty()) return {};
  const std::vector<uint32_t> vertexOf = mesh.welding().vertices();
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
  std::vector<EdgeCounts> tasks((halfEdges.size() + kCheapGrain - 1) / kCheapGrain);
  parallelFor(tasks.size(), 1, [&](size_t task, size_t) {
    const size_t begin = task * kCheapGrain, end = std::min(begin + kCheapGrain, halfEdges.size());
    forEachEdge(halfEdges, begin, end, [&](std::span<const SortKey> edge) { tasks[task].add(edge); });
  });
  EdgeCounts all;
  for (const EdgeCounts& task : tasks) all.append(task);
  return all;
}

/// Counts duplicate and double-sided faces among those that may have the same corners as another one. Returns
/// the other sides of double-sided ones.
std::vector<uint32_t> countLayers(const Model& mesh, std::vector<uint32_t>& layers, Diagnostics& found) {
  parallelSort(layers.begin(), layers.end());
  layers.erase(std::unique(layers.begin(), layers.end()), layers.end());
  std::vector<glm::uvec3> faces(layers.size());
  std::vector<std::array<uint32_t, 3>> corners(layers.size());
  for (size_t f = 0; f < layers.size(); ++f) {
    faces[f] = mesh.triangles[layers[f]];
    const glm::uvec3 welded = weldedFace(mesh, mesh.welding(), layers[f]);
    corners[f] = {welded.x, welded.y, welded.z};
    std::sort(corners[f].begin(), corners[f].end());
  }
  parallelSort(corners.begin(), corners.end());
  found.duplicateFaces = size_t(corners.end() - std::unique(corners.begin(), corners.end()));
  if (found.duplicateFaces == 0) return {};
  DoubleSidedFaces doubled = findDoubleSidedFaces({mesh.vertices, faces, mesh.origin});
  found.doubleSidedFaces = doubled.count();
  for (uint32_t& face : doubled.others) face = layers[face];
  return std::move(doubled.others);
}

void setShapes(const Diagnostics& from, Diagnostics& to) {
  to.openComponents = from.openComponents;
  to.inwardComponents = from.inwardComponents;
  to.sheets = from.sheets;
  to.sheetShare = from.sheetShare;
}

/// Diagnoses the mesh without some of its faces.
Diagnostics diagnoseWithout(const PackedMesh& mesh, const std::vector<uint32_t>& leftOut) {
  std::vector<bool> isLeftOut(mesh.triangles.size());
  for (const uint32_t face : leftOut) isLeftOut[face] = true;
  std::vector<glm::uvec3> faces;
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    if (!isLeftOut[f]) faces.push_back(mesh.triangles[f]);
  return diagnose(PackedMesh(mesh.vertices, faces, mesh.origin));
}

/// Finds the components and their shapes. Of a double-sided mesh, the shapes are those of one side.
void findComponents(const Model& mesh, std::span<const TracedHole> holes,
                    const std::vector<uint32_t>& otherSides, Diagnostics& found) {
  Components components(mesh);
  found.components = components.count();
  if (isDoubleSided(found))
    setShapes(diagnoseWithout(mesh, otherSides), found);
  else
    measureComponents(mesh, components, holes, found);
}

Diagnostics diagnoseNow(const Model& mesh, bool isBrief, Progress& progress) {
  Diagnostics found;
  found.weldedVertices = mesh.welding().count;
  progress.report(0.3);
  found.vertices = mesh.vertices.size();
  found.triangles = mesh.triangles.size();
  found.bounds = bounds(mesh);
  found.farVertices = findFarVertices({found.bounds.min - mesh.origin, found.bounds.max - mesh.origin},
                                      mesh.vertices, mesh.triangles)
                          .count;
  measureFaces(mesh, found);
  progress.report(0.4);
  const std::span<const SortKey> halfEdges = mesh.halfEdges();
  progress.report(0.7);
  EdgeCounts edges = countEdges(halfEdges);
  found.boundaryEdges = edges.boundary.size();
  found.nonManifoldEdges = edges.nonManifold;
  found.flippedEdges = edges.flipped;
  found.balanced = !halfEdges.empty() && edges.isBalanced;
  found.watertight = !halfEdges.empty() && found.boundaryEdges == 0 && found.nonManifoldEdges == 0;
  found.consistentlyOriented = found.flippedEdges == 0;
  const std::vector<uint32_t> otherSides = countLayers(mesh, edges.layers, found);
  if (isBrief) return found;
  progress.report(0.8);
  const std::vector<TracedHole> holes = findHoles(mesh, edges.boundary);
  for (const TracedHole& hole : holes) found.holes.push_back(hole.hole);
  progress.report(0.85);
  findComponents(mesh, holes, otherSides, found);
  progress.report(0.9);
  if (!found.consistentlyOriented) found.flippedFaces = findFlippedFaces(findPatches(mesh)).size();
  return found;
}

}  // namespace

SheetFaces findSheets(const Model& mesh) {
  const EdgeCounts edges = countEdges(mesh.halfEdges());
  Components components(mesh);
  return findSheets(mesh, components, findHoles(mesh, edges.boundary));
}

Diagnostics diagnose(const Model& mesh, const DiagnoseOptions& options, const MachineOptions& machine) {
  Progress progress(machine.progress);
  Diagnostics found;
  progress.stage("diagnose", [&] {
    withThreads(machine.threads, [&] { found = diagnoseNow(mesh, options.brief, progress); });
  });
  return found;
}

Diagnostics diagnose(const MeshView& view, const DiagnoseOptions& options, const MachineOptions& machine) {
  validate(view);
  return diagnose(Model(view), options, machine);
}

}  // namespace raymap
