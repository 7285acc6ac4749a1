#include "repair/topology/thicken_sheets.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/disjoint_sets.h"
#include "mesh/half_edges.h"
#include "mesh/patches.h"
#include "mesh/triangle.h"

namespace raymap {

namespace {

/// Faces of sheets, all of a patch pointing to the same side. Around a vertex, faces that are linked across
/// edges have one point of it, others have their own.
class Sheets {
 public:
  Sheets(const Mesh& mesh, const std::vector<uint32_t>& faces) : mesh_{mesh.vertices, {}, mesh.origin} {
    for (const uint32_t face : faces) mesh_.triangles.push_back(mesh.triangles[face]);
    const Patches patches = findPatches(Model(mesh_));
    for (size_t f = 0; f < faces.size(); ++f)
      if (patches.isReversed[f]) std::swap(mesh_.triangles[f].y, mesh_.triangles[f].z);
  }

  /// Calls `wall(face, from, to)` for each edge of a face that ends there, and links the points at the
  /// others.
  template <class Wall>
  void forEachEnd(DisjointSets& points, Wall&& wall) const {
    const Model model(mesh_);
    const auto corner = [&](uint32_t face, uint32_t position) {
      const glm::uvec3 t = weldedFace(model, model.welding(), face);
      return 3 * face + (t.x == position ? 0 : t.y == position ? 1 : 2);
    };
    const std::span<const SortKey> keys = model.halfEdges();
    forEachEdge(keys, 0, keys.size(), [&](std::span<const SortKey> edge) {
      const HalfEdge a = halfEdgeOf(edge[0]), b = halfEdgeOf(edge.back());
      if (edge.size() == 2 && a.isForward != b.isForward) {
        points.link(corner(a.face, a.low), corner(b.face, b.low));
        points.link(corner(a.face, a.high), corner(b.face, b.high));
      } else {
        for (const SortKey& key : edge) {
          const HalfEdge end = halfEdgeOf(key);
          wall(end.face, corner(end.face, end.from()), corner(end.face, end.to()));
        }
      }
    });
  }

  size_t count() const { return mesh_.triangles.size(); }
  glm::dvec3 position(uint32_t corner) const {
    return glm::dvec3(mesh_.vertices[mesh_.triangles[corner / 3][int(corner % 3)]]);
  }
  glm::dvec3 doubleArea(uint32_t face) const {
    return doubleAreaNormal(position(3 * face), position(3 * face + 1), position(3 * face + 2));
  }
  double angle(uint32_t corner) const {
    const uint32_t first = corner / 3 * 3;
    const glm::dvec3 at = position(corner), a = position(first + (corner + 1 - first) % 3) - at,
                     b = position(first + (corner + 2 - first) % 3) - at;
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
  }

 private:
  Mesh mesh_;
};

/// Returns how far each point moves: for each corner, at the least corner of its point.
std::vector<glm::dvec3> movesOf(const Sheets& sheets, DisjointSets& points, double half) {
  constexpr double kSharpest = 0.5;  // Cosine of half the angle between faces.
  std::vector<glm::dvec3> normals(3 * sheets.count(), glm::dvec3(0.0));
  std::vector<double> cosines(normals.size(), 1.0);
  const auto forEachCorner = [&](auto&& work) {
    for (uint32_t c = 0; c < normals.size(); ++c) {
      const glm::dvec3 normal = sheets.doubleArea(c / 3);
      if (const double length = glm::length(normal); length > 0.0) work(c, points.root(c), normal / length);
    }
  };
  forEachCorner([&](uint32_t corner, uint32_t point, const glm::dvec3& normal) {
    normals[point] += sheets.angle(corner) * normal;
  });
  for (glm::dvec3& n : normals)
    if (const double length = glm::length(n); length > 0.0) n /= length;
  forEachCorner([&](uint32_t, uint32_t point, const glm::dvec3& normal) {
    cosines[point] = std::min(cosines[point], glm::dot(normals[point], normal));
  });
  for (size_t p = 0; p < normals.size(); ++p) normals[p] *= half / std::max(cosines[p], kSharpest);
  return normals;
}

}  // namespace

Plates thickenSheets(const Mesh& mesh, const std::vector<uint32_t>& faces, double thickness) {
  const Sheets sheets(mesh, faces);
  DisjointSets points(3 * sheets.count());
  std::vector<std::array<uint32_t, 3>> walls;  // Face, and the corners from and to.
  sheets.forEachEnd(points, [&](uint32_t face, uint32_t from, uint32_t to) {
    walls.push_back({face, from, to});
  });
  const std::vector<glm::dvec3> moves = movesOf(sheets, points, 0.5 * thickness);

  Plates plates;
  plates.mesh.origin = mesh.origin;
  std::vector<uint32_t> upper(moves.size());  // The lower vertex follows it.
  for (uint32_t c = 0; c < moves.size(); ++c) {
    const uint32_t point = points.root(c);
    if (point != c) {
      upper[c] = upper[point];
      continue;
    }
    upper[c] = uint32_t(plates.mesh.vertices.size());
    for (const double side : {1.0, -1.0})
      plates.mesh.vertices.push_back(glm::vec3(sheets.position(c) + side * moves[c]));
  }
  const auto add = [&](uint32_t face, uint32_t a, uint32_t b, uint32_t c) {
    plates.mesh.triangles.emplace_back(a, b, c);
    plates.sources.push_back(faces[face]);
  };
  double area = 0.0, folded = 0.0;
  for (uint32_t f = 0; f < sheets.count(); ++f) {
    const uint32_t a = upper[3 * f], b = upper[3 * f + 1], c = upper[3 * f + 2];
    add(f, a, b, c), add(f, c + 1, b + 1, a + 1);
    const auto place = [&](uint32_t v) { return glm::dvec3(plates.mesh.vertices[v]); };
    const glm::dvec3 normal = sheets.doubleArea(f), above = doubleAreaNormal(place(a), place(b), place(c)),
                     below = doubleAreaNormal(place(a + 1), place(b + 1), place(c + 1));
    area += glm::length(normal);
    if (glm::dot(normal, above) < 0.0 || glm::dot(normal, below) < 0.0) folded += glm::length(normal);
  }
  plates.foldedShare = area > 0.0 ? folded / area : 0.0;
  for (const auto& [face, from, to] : walls) {
    const uint32_t a = upper[from], b = upper[to];
    add(face, b, a, a + 1), add(face, b, a + 1, b + 1);
  }
  return plates;
}

}  // namespace raymap
