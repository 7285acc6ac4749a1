#include "mesh/defects.h"

#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>

#include "base/parallel_sort.h"
#include "mesh/double_sided.h"
#include "mesh/face_measures.h"
#include "mesh/half_edges.h"

namespace raymap {

namespace {

/// Finds the faces that have the same three distinct corners as an earlier face.
std::vector<uint32_t> findDuplicates(const Model& mesh) {
  struct Corners {
    std::array<uint32_t, 3> ids;
    uint32_t face;
    bool operator<(const Corners& other) const {
      return ids != other.ids ? ids < other.ids : face < other.face;
    }
  };
  std::vector<Corners> corners(mesh.triangles.size());
  for (uint32_t face = 0; face < corners.size(); ++face) {
    const glm::uvec3 welded = weldedFace(mesh, mesh.welding(), face);
    corners[face] = {{welded.x, welded.y, welded.z}, face};
    std::sort(corners[face].ids.begin(), corners[face].ids.end());
  }
  parallelSort(corners.begin(), corners.end());
  std::vector<uint32_t> faces;
  for (size_t c = 1; c < corners.size(); ++c) {
    const std::array<uint32_t, 3>& ids = corners[c].ids;
    if (ids == corners[c - 1].ids && ids[0] != ids[1] && ids[1] != ids[2]) faces.push_back(corners[c].face);
  }
  return faces;
}

}  // namespace

std::vector<uint32_t> findFlippedFaces(const Patches& patches, bool takesHalf) {
  std::vector<size_t> faces(patches.count), reversed(patches.count);
  for (size_t f = 0; f < patches.ids.size(); ++f) {
    ++faces[patches.ids[f]];
    reversed[patches.ids[f]] += patches.isReversed[f];
  }
  std::vector<uint32_t> flipped;
  for (uint32_t f = 0; f < patches.ids.size(); ++f) {
    const uint32_t patch = patches.ids[f];
    if (!takesHalf && 2 * reversed[patch] == faces[patch]) continue;
    const bool isMinority =
        2 * reversed[patch] > faces[patch] ? !patches.isReversed[f] : patches.isReversed[f];
    if (isMinority) flipped.push_back(f);
  }
  return flipped;
}

Defects findDefects(const Model& mesh, const ProgressCallback& progress) {
  validate(mesh);
  const std::vector<uint32_t> vertexOf = mesh.welding().vertices();
  Defects defects;
  const std::span<const SortKey> halfEdges = mesh.halfEdges();
  forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
    if (edge.size() == 2) return;
    const HalfEdge first = halfEdgeOf(edge[0]);
    (edge.size() == 1 ? defects.boundaryEdges : defects.nonManifoldEdges)
        .push_back({vertexOf[first.low], vertexOf[first.high]});
  });
  defects.flippedFaces = findFlippedFaces(findPatches(mesh));
  defects.duplicateFaces = findDuplicates(mesh);
  const DoubleSidedFaces doubleSided = findDoubleSidedFaces(mesh);
  defects.doubleSidedFaces = doubleSided.firsts;
  defects.doubleSidedFaces.insert(defects.doubleSidedFaces.end(), doubleSided.others.begin(),
                                  doubleSided.others.end());
  forEachFaceMeasure(mesh, glm::dvec3(0.0), [&](size_t face, const FaceMeasure& measure) {
    if (measure.isDegenerate) defects.degenerateFaces.push_back(uint32_t(face));
  });
  SelfIntersections crossings = findSelfIntersections(mesh, {.progress = progress});
  defects.crossedFaces = std::move(crossings.faces);
  defects.isComplete = crossings.complete;
  return defects;
}

}  // namespace raymap
