#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/parallel_sort.h"
#include "mesh/defects.h"
#include "mesh/half_edges.h"
#include "mesh/holes.h"
#include "mesh/weld.h"

namespace raymap {

namespace {

constexpr double kDegenerateHeight = 1e-6;  // Share of the longest edge.

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

/// Measures area and volume, and counts degenerate faces. The volume is taken about the centre of the bounds,
/// so that an open mesh's volume does not depend on its position. Returns the welded faces without a repeated
/// corner; the others belong to no surface.
std::vector<glm::uvec3> measureFaces(const PackedMesh& mesh, const Welding& welding, Diagnostics& found) {
  std::vector<glm::uvec3> faces;
  faces.reserve(mesh.triangles.size());
  const glm::dvec3 centre = found.bounds.centre() - mesh.origin;
  for (const glm::uvec3& face : mesh.triangles) {
    const glm::uvec3 welded(welding.ids[face.x], welding.ids[face.y], welding.ids[face.z]);
    if (hasRepeatedCorner(welded)) {
      ++found.degenerateFaces;
      continue;
    }
    const glm::dvec3 normal = normalOf(mesh, face);
    const double doubleArea = glm::length(normal);
    if (isFlat(mesh, face, doubleArea)) ++found.degenerateFaces;
    found.area += doubleArea / 2.0;
    found.signedVolume += glm::dot(glm::dvec3(mesh.vertices[face.x]) - centre, normal) / 6.0;
    faces.push_back(welded);
  }
  return faces;
}

std::vector<Hole> findHoles(const PackedMesh& mesh, const Welding& welding,
                            std::span<const std::pair<uint32_t, uint32_t>> boundary) {
  std::vector<uint32_t> vertexOf(welding.count);
  for (uint32_t v = 0; v < welding.ids.size(); ++v) vertexOf[welding.ids[v]] = v;
  return traceHoles(boundary, [&](uint32_t position) { return mesh.position(vertexOf[position]); });
}

void countEdges(const PackedMesh& mesh, const Welding& welding, Diagnostics& found) {
  const std::vector<HalfEdge> halfEdges = sortHalfEdges(mesh, welding);
  std::vector<std::pair<uint32_t, uint32_t>> boundary;
  found.balanced = !halfEdges.empty();
  forEachEdge(halfEdges, [&](std::span<const HalfEdge> edge) {
    const size_t count = edge.size();
    const auto forward =
        size_t(std::count_if(edge.begin(), edge.end(), [](const HalfEdge& h) { return h.isForward; }));
    if (count == 1) boundary.emplace_back(edge[0].low, edge[0].high);
    if (count > 2) ++found.nonManifoldEdges;
    if (count == 2 && forward != 1) ++found.flippedEdges;
    if (2 * forward != count) found.balanced = false;
  });
  found.boundaryEdges = boundary.size();
  found.watertight = !halfEdges.empty() && boundary.empty() && found.nonManifoldEdges == 0;
  found.consistentlyOriented = found.flippedEdges == 0;
  if (!boundary.empty()) found.holes = findHoles(mesh, welding, boundary);
}

size_t countDuplicates(const std::vector<glm::uvec3>& faces) {
  std::vector<std::array<uint32_t, 3>> corners(faces.size());
  for (size_t f = 0; f < faces.size(); ++f) {
    corners[f] = {faces[f].x, faces[f].y, faces[f].z};
    std::sort(corners[f].begin(), corners[f].end());
  }
  parallelSort(corners.begin(), corners.end());
  return static_cast<size_t>(corners.end() - std::unique(corners.begin(), corners.end()));
}

size_t countComponents(const std::vector<glm::uvec3>& faces, size_t vertexCount) {
  std::vector<uint32_t> parent(vertexCount);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<bool> isUsed(vertexCount);
  for (const glm::uvec3& face : faces) {
    const uint32_t into = root(face.x);
    parent[root(face.y)] = into;
    parent[root(face.z)] = into;
    for (int c = 0; c < 3; ++c) isUsed[face[c]] = true;
  }
  size_t count = 0;
  for (uint32_t v = 0; v < vertexCount; ++v) count += isUsed[v] && parent[v] == v ? 1 : 0;
  return count;
}

}  // namespace

Diagnostics diagnose(const MeshView& view) {
  validate(view);
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  const Welding welding = weldVertices(mesh.vertices);
  Diagnostics found;
  found.vertices = mesh.vertices.size();
  found.weldedVertices = welding.count;
  found.triangles = mesh.triangles.size();
  found.bounds = bounds(mesh);
  const std::vector<glm::uvec3> faces = measureFaces(mesh, welding, found);
  countEdges(mesh, welding, found);
  found.duplicateFaces = countDuplicates(faces);
  if (!found.consistentlyOriented) found.flippedFaces = findFlippedFaces(mesh).size();
  found.components = countComponents(faces, welding.count);
  return found;
}

}  // namespace raymap
