// The union of the parts of a mesh: pieces of faces, and the winding numbers on both of their sides.

#include "mesh/unite_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "mesh/cut_faces.h"
#include "mesh/disjoint_sets.h"
#include "mesh/pieces.h"
#include "mesh/triangle.h"
#include "mesh/vertex_lattice.h"

namespace raymap {

namespace {

constexpr uint32_t kNone = UINT32_MAX;
constexpr size_t kFacesPerCast = size_t{1} << 12, kMostRays = size_t{1} << 17;
constexpr double kRounding = 1e-3;  // More than points lie from where doubles say, in steps of the lattice.

/// A piece at an edge of several.
struct Leaf {
  uint32_t piece;
  bool isForward;      ///< Whether it runs along the edge from its lower point to its higher one.
  glm::i64vec3 front;  ///< Normal on the side to which it turns around the edge.
};

/// Two patches with a space between them. The winding number in front of `b` is that in front of `a`, plus
/// `step`.
struct Link {
  uint32_t a, b;
  int step;
};

/// The patches of pieces, which end at edges of more than two pieces, and what the order around these edges
/// tells about their winding numbers.
class LinkedPatches {
 public:
  LinkedPatches(const VertexLattice& lattice, const CutFaces& cut)
      : lattice_(lattice), cut_(cut), sets_(cut.pieces.size()) {
    std::vector<glm::uvec3> triangles;
    for (const CutPiece& piece : cut.pieces) triangles.push_back(piece.corners);
    Buffer<SortKey> keys;
    const std::span<const SortKey> halfEdges =
        sortHalfEdges(PackedMesh({}, triangles, glm::dvec3(0.0)), unwelded(cut.points.size()), keys);
    forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
      if (edge.size() == 2) sets_.link(halfEdgeOf(edge[0]).face, halfEdgeOf(edge[1]).face);
    });
    forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
      if (edge.size() > 2) linkAround(edge);
    });
  }

  /// Returns the patch of a piece, by its first piece.
  uint32_t patchOf(uint32_t piece) { return sets_.root(piece); }
  const std::vector<Link>& links() const { return links_; }

 private:
  void linkAround(std::span<const SortKey> edge) {
    std::vector<Leaf> leaves;
    const HalfEdge first = halfEdgeOf(edge[0]);
    for (const SortKey& key : edge) {
      const HalfEdge side = halfEdgeOf(key);
      const CutPiece& piece = cut_.pieces[side.face];
      const glm::i64vec3 normal = WholePlane(lattice_.face(piece.face)).normal();
      leaves.push_back({side.face, side.isForward, piece.isTurned == side.isForward ? -normal : normal});
    }
    // Leaves less than half a turn behind the first one come first.
    const auto half = [&](const Leaf& leaf) {
      if (leaf.piece == leaves[0].piece) return 0;
      const int turn = turnAround(first, start_, leaf.front);
      return turn > 0 ? 1 : turn == 0 ? 2 : 3;
    };
    start_ = leaves[0].front;
    std::vector<std::pair<int, Leaf>> order;
    for (const Leaf& leaf : leaves) order.emplace_back(half(leaf), leaf);
    std::ranges::stable_sort(order, [&](const auto& a, const auto& b) {
      if (a.first != b.first) return a.first < b.first;
      return turnAround(first, a.second.front, b.second.front) > 0;
    });
    for (size_t k = 0; k < order.size(); ++k) {
      const Leaf &a = order[k].second, &b = order[(k + 1) % order.size()].second;
      const int behindA = a.isForward ? 0 : cut_.pieces[a.piece].layers,
                behindB = b.isForward ? cut_.pieces[b.piece].layers : 0;
      links_.push_back({sets_.root(a.piece), sets_.root(b.piece), behindA - behindB});
    }
  }

  /// Returns 1 if the turn around an edge from one normal to another is less than half a turn, -1 if it is
  /// more, and 0 if it is none or half of one.
  int turnAround(const HalfEdge& edge, const glm::i64vec3& from, const glm::i64vec3& to) const {
    const auto [axis, sign] = commonLine(from, to);
    return sign * cut_.points.compare(edge.high, edge.low, axis);
  }

  const VertexLattice& lattice_;
  const CutFaces& cut_;
  DisjointSets sets_;
  std::vector<Link> links_;
  glm::i64vec3 start_{0};
};

/// A ray along an axis from a point of a piece.
struct Ray {
  uint32_t point, piece;
  glm::dvec3 start;
};

/// Finds winding numbers in front of pieces: by an exact ray from each group of linked patches, then by
/// links.
class PieceWinding {
 public:
  PieceWinding(const VertexLattice& lattice, CutFaces& cut)
      : lattice_(lattice), cut_(cut), patches_(lattice, cut), fronts_(cut.pieces.size()) {
    startRays();
  }

  /// Returns the number for each piece. Returns nothing if links contradict each other, or if a ray starts on
  /// a face that it should not.
  std::optional<std::vector<int>> find() {
    size_t count = 0;
    for (int axis = 0; axis < 3; ++axis) {
      count += rays_[size_t(axis)].size();
      if (count > kMostRays || !castAlong(axis)) return {};
    }
    if (!followLinks()) return {};
    for (uint32_t p = 0; p < fronts_.size(); ++p) fronts_[p] = fronts_[patches_.patchOf(p)];
    return std::move(fronts_);
  }

 private:
  /// Starts a ray on the largest piece of each group, along the axis from which it looks largest.
  void startRays() {
    DisjointSets groups(cut_.pieces.size());
    for (const Link& link : patches_.links()) groups.link(link.a, link.b);
    std::vector<std::pair<double, uint32_t>> largest(cut_.pieces.size(), {-1.0, 0});
    for (uint32_t p = 0; p < cut_.pieces.size(); ++p) {
      const double area = glm::length(normalOf(cut_.pieces[p].corners));
      auto& best = largest[groups.root(patches_.patchOf(p))];
      if (area > best.first) best = {area, p};
    }
    for (const auto& [area, p] : largest) {
      if (area < 0.0) continue;
      const CutPiece& piece = cut_.pieces[p];
      const int axis = WholePlane(lattice_.face(piece.face)).steepestAxis();
      const uint32_t point = cut_.points.between(piece.corners, {3, 4, 5});
      rays_[size_t(axis)].push_back({point, p, cut_.points.rounded(point)});
    }
    for (int axis = 0; axis < 3; ++axis)
      std::ranges::stable_sort(rays_[size_t(axis)], {},
                               [=](const Ray& ray) { return ray.start[(axis + 1) % 3]; });
  }

  glm::dvec3 normalOf(const glm::uvec3& corners) const {
    return doubleAreaNormal(cut_.points.rounded(corners.x), cut_.points.rounded(corners.y),
                            cut_.points.rounded(corners.z));
  }

  struct Crossings {
    std::vector<std::pair<uint32_t, int>> steps;  // Pieces with rays, and by how much numbers change.
    bool isSure = true;
  };

  bool castAlong(int axis) {
    std::vector<Crossings> tasks((cut_.faces.size() + kFacesPerCast - 1) / kFacesPerCast);
    parallelFor(tasks.size(), 1, [&](size_t task, size_t) {
      const size_t begin = task * kFacesPerCast, end = std::min(begin + kFacesPerCast, cut_.faces.size());
      for (size_t f = begin; f < end; ++f) castAt(f, axis, tasks[task]);
    });
    for (const Crossings& task : tasks) {
      if (!task.isSure) return false;
      for (const auto& [piece, step] : task.steps) fronts_[patches_.patchOf(piece)] += step;
    }
    for (const Ray& ray : rays_[size_t(axis)]) {
      const CutPiece& piece = cut_.pieces[ray.piece];
      const glm::uvec3& t = piece.corners;
      const bool isBack = cut_.points.turn(t.x, t.y, t.z, axis) < 0;
      if (isBack) fronts_[patches_.patchOf(ray.piece)] -= piece.layers;
    }
    return true;
  }

  /// Goes from the patches with rays to all others, along the links.
  bool followLinks() {
    std::vector<Link> links = patches_.links();
    for (const Link& link : patches_.links()) links.push_back({link.b, link.a, -link.step});
    std::ranges::sort(links, {}, &Link::a);
    std::vector<bool> isKnown(fronts_.size());
    std::vector<uint32_t> open;
    for (const std::vector<Ray>& rays : rays_)
      for (const Ray& ray : rays) open.push_back(patches_.patchOf(ray.piece));
    for (const uint32_t patch : open) isKnown[patch] = true;
    while (!open.empty()) {
      const uint32_t patch = open.back();
      open.pop_back();
      auto next = std::ranges::lower_bound(links, patch, {}, &Link::a);
      for (; next != links.end() && next->a == patch; ++next) {
        const Link& link = *next;
        const int front = fronts_[patch] + link.step;
        if (isKnown[link.b] && fronts_[link.b] != front) return false;
        if (!isKnown[link.b]) open.push_back(link.b);
        isKnown[link.b] = true;
        fronts_[link.b] = front;
      }
    }
    return true;
  }

  void castAt(size_t f, int axis, Crossings& crossings) const {
    const std::vector<Ray>& rays = rays_[size_t(axis)];
    if (rays.empty()) return;
    const WholeTriangle t = lattice_.face(f);
    const WholePlane plane(t);
    const int64_t steep = plane.normal()[axis];
    if (steep == 0) return;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const glm::dvec3 low = glm::dvec3(glm::min(glm::min(t[0], t[1]), t[2])) - kRounding,
                     high = glm::dvec3(glm::max(glm::max(t[0], t[1]), t[2])) + kRounding;
    auto ray = std::ranges::lower_bound(rays, low[u], {}, [=](const Ray& r) { return r.start[u]; });
    for (; ray != rays.end() && ray->start[u] <= high[u]; ++ray) {
      if (ray->start[v] < low[v] || ray->start[v] > high[v] || ray->start[axis] > high[axis]) continue;
      if (!isAround(cut_.faces[f], ray->point, axis)) continue;
      const int towards = steep > 0 ? 1 : -1,
                side = ray->start[axis] < low[axis]
                           ? -1
                           : towards * cut_.points.sideOf(ray->point, t[0], plane.normal());
      if (side < 0) crossings.steps.emplace_back(ray->piece, towards);
      if (side == 0) crossings.isSure = crossings.isSure && isInPlane(*ray, t);
    }
  }

  /// Returns whether a face lies in the plane of the piece that a ray starts on.
  bool isInPlane(const Ray& ray, const WholeTriangle& t) const {
    const WholePlane plane(lattice_.face(cut_.pieces[ray.piece].face));
    return plane.sidesOf<Int128>(t) == CornerSides{0, 0, 0};
  }

  /// Returns whether a line through a point passes through a face. The line is taken as moved along the next
  /// axis, and less along the one after.
  bool isAround(const glm::uvec3& face, uint32_t point, int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    int all = 0;
    for (int k = 0; k < 3; ++k) {
      const uint32_t from = face[k], to = face[(k + 1) % 3];
      int side = cut_.points.turn(from, to, point, axis);
      const glm::dvec3 along = cut_.points.rounded(to) - cut_.points.rounded(from);
      if (side == 0) side = along[v] != 0.0 ? (along[v] < 0.0 ? 1 : -1) : along[u] > 0.0 ? 1 : -1;
      if (all != 0 && side != all) return false;
      all = side;
    }
    return true;
  }

  const VertexLattice& lattice_;
  CutFaces& cut_;
  LinkedPatches patches_;
  std::vector<int> fronts_;  // By the first piece of each patch.
  std::array<std::vector<Ray>, 3> rays_;
};

/// Returns the faces as a mesh. Vertices that faces had already come first, in their order.
Mesh meshOf(const PackedMesh& given, const VertexLattice& lattice, const CutFaces& cut,
            const std::vector<glm::uvec3>& faces) {
  std::vector<std::pair<uint32_t, uint32_t>> order;  // Vertices of the given mesh or none, and points.
  std::vector<uint32_t> numbers(cut.points.size(), kNone);
  for (const glm::uvec3& t : faces)
    for (int c = 0; c < 3; ++c) numbers[t[c]] = 0;
  for (uint32_t p = 0; p < numbers.size(); ++p)
    if (numbers[p] == 0) order.emplace_back(p < cut.vertices.size() ? cut.vertices[p] : kNone, p);
  std::ranges::sort(order);
  Mesh mesh{.origin = given.origin};
  for (const auto& [vertex, point] : order) {
    numbers[point] = uint32_t(mesh.vertices.size());
    mesh.vertices.push_back(vertex != kNone ? given.vertices[vertex]
                                            : glm::vec3(lattice.placeOf(cut.points.rounded(point))));
  }
  for (const glm::uvec3& t : faces) mesh.triangles.emplace_back(numbers[t.x], numbers[t.y], numbers[t.z]);
  return mesh;
}

}  // namespace

std::optional<UnitedFaces> uniteFaces(const Model& mesh, bool mayTurn) {
  std::optional<CutFaces> cut = cutFaces(mesh);
  if (!cut) return {};
  const VertexLattice lattice(mesh);
  const std::optional<std::vector<int>> fronts = PieceWinding(lattice, *cut).find();
  if (!fronts) return {};
  const Pieces parts = findPieces(mesh);
  bool isAnyInverted = false;
  for (size_t p = 0; mayTurn && !isAnyInverted && p < fronts->size(); ++p)
    isAnyInverted = (*fronts)[p] < 0 && parts.pieces[parts.ids[cut->pieces[p].face]].isCavity();
  const auto isInside = [&](int number) { return number > 0 || (isAnyInverted && number < 0); };
  std::vector<glm::uvec3> kept, open;
  std::vector<uint32_t> sources, openSources, turned;
  double volume = 0.0, area = 0.0, buried = 0.0;
  for (size_t p = 0; p < fronts->size(); ++p) {
    auto [corners, face, layers, isTurned] = cut->pieces[p];
    const int front = (*fronts)[p];
    const auto at = [&](uint32_t point) { return lattice.placeOf(cut->points.rounded(point)); };
    const double pieceArea = triangleArea(at(corners.x), at(corners.y), at(corners.z));
    if (layers > 0) area += pieceArea;
    if (layers > 0 && isInside(front) && isInside(front + layers)) buried += pieceArea;
    if (layers == 0 && !isInside(front)) {
      if (isTurned) std::swap(corners.y, corners.z);
      open.push_back(corners);
      openSources.push_back(face);
    }
    if (isInside(front) == isInside(front + layers)) continue;
    if (isInside(front)) {
      std::swap(corners.y, corners.z);
      turned.push_back(face);
    }
    kept.push_back(corners);
    sources.push_back(face);
    volume += glm::dot(at(corners.x), glm::cross(at(corners.y), at(corners.z))) / 6.0;
  }
  std::ranges::sort(turned);
  turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
  return UnitedFaces{meshOf(mesh, lattice, *cut, kept),
                     cut->cutFaces,
                     cut->repeatedFaces,
                     volume,
                     area > 0.0 ? buried / area : 0.0,
                     std::move(sources),
                     std::move(turned),
                     meshOf(mesh, lattice, *cut, open),
                     std::move(openSources)};
}

}  // namespace raymap
