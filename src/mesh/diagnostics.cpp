#include <raymap/diagnostics.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "cpu/parallel.h"

namespace raymap {

namespace {

constexpr double kDegenerateHeight = 1e-6;  // Share of the longest edge.

/// A position as sortable bits, equal exactly where the coordinates are (-0 equals 0, even NaN has a place).
struct WeldKey {
  std::array<uint32_t, 3> bits;
  uint32_t vertex;
  bool operator<(const WeldKey& other) const { return bits < other.bits; }
};

/// An edge between two welded vertices, and whether its face walks it from the lower one to the higher one.
struct Edge {
  uint64_t ends;
  bool forward;
  bool operator<(const Edge& other) const { return ends < other.ends; }
};

/// Which distinct position each vertex has.
struct Welding {
  std::vector<uint32_t> ids;
  size_t count = 0;
};

Welding weld(const Mesh& mesh) {
  std::vector<WeldKey> keys(mesh.vertices.size());
  for (uint32_t v = 0; v < keys.size(); ++v) {
    const glm::vec3 p = mesh.vertices[v] + 0.0f;  // Turns -0 into 0.
    keys[v] = {{std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z)}, v};
  }
  tbb::parallel_sort(keys.begin(), keys.end());
  Welding welding{std::vector<uint32_t>(keys.size()), 0};
  for (size_t k = 0; k < keys.size(); ++k) {
    if (k == 0 || keys[k].bits != keys[k - 1].bits) ++welding.count;
    welding.ids[keys[k].vertex] = static_cast<uint32_t>(welding.count - 1);
  }
  return welding;
}

bool hasRepeatedCorner(const glm::uvec3& face) {
  return face.x == face.y || face.y == face.z || face.z == face.x;
}

glm::dvec3 normalOf(const Mesh& mesh, const glm::uvec3& face) {
  const glm::dvec3 a(mesh.vertices[face.x]);
  return glm::cross(glm::dvec3(mesh.vertices[face.y]) - a, glm::dvec3(mesh.vertices[face.z]) - a);
}

/// The height over the longest edge is twice the area over its length.
bool isFlat(const Mesh& mesh, const glm::uvec3& face, double doubleArea) {
  double longest2 = 0.0;
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 edge = glm::dvec3(mesh.vertices[face[c]]) - glm::dvec3(mesh.vertices[face[(c + 1) % 3]]);
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  return doubleArea < kDegenerateHeight * longest2;
}

/// Areas and volume, about the centre of the bounds so that an open mesh's volume does not depend on where
/// it lies; and the faces that enclose nothing. Returns the welded faces without a repeated corner: the
/// others are no faces of any surface.
std::vector<glm::uvec3> measureFaces(const Mesh& mesh, const Welding& welding, Diagnostics& found) {
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

void countEdges(const std::vector<glm::uvec3>& faces, Diagnostics& found) {
  std::vector<Edge> edges;
  edges.reserve(3 * faces.size());
  for (const glm::uvec3& face : faces)
    for (int c = 0; c < 3; ++c) {
      const uint32_t a = face[c], b = face[(c + 1) % 3];
      edges.push_back({uint64_t{std::min(a, b)} << 32 | std::max(a, b), a < b});
    }
  tbb::parallel_sort(edges.begin(), edges.end());
  found.watertight = found.balanced = !faces.empty();
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    size_t forward = 0;
    for (; end < edges.size() && edges[end].ends == edges[begin].ends; ++end)
      forward += edges[end].forward ? 1 : 0;
    const size_t count = end - begin;
    if (count == 1) ++found.boundaryEdges;
    if (count > 2) ++found.nonManifoldEdges;
    if (count == 2 && forward != 1) ++found.flippedEdges;
    if (2 * forward != count) found.balanced = false;
  }
  found.watertight = found.watertight && found.boundaryEdges == 0 && found.nonManifoldEdges == 0;
  found.consistentlyOriented = found.flippedEdges == 0;
}

size_t countDuplicates(const std::vector<glm::uvec3>& faces) {
  std::vector<std::array<uint32_t, 3>> corners(faces.size());
  for (size_t f = 0; f < faces.size(); ++f) {
    corners[f] = {faces[f].x, faces[f].y, faces[f].z};
    std::sort(corners[f].begin(), corners[f].end());
  }
  tbb::parallel_sort(corners.begin(), corners.end());
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

Diagnostics diagnose(const Mesh& mesh) {
  validate(mesh);
  const Welding welding = weld(mesh);
  Diagnostics found;
  found.vertices = mesh.vertices.size();
  found.weldedVertices = welding.count;
  found.triangles = mesh.triangles.size();
  found.bounds = bounds(mesh);
  const std::vector<glm::uvec3> faces = measureFaces(mesh, welding, found);
  countEdges(faces, found);
  found.duplicateFaces = countDuplicates(faces);
  found.components = countComponents(faces, welding.count);
  return found;
}

}  // namespace raymap
