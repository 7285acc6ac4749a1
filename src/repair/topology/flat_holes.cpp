#include "repair/topology/flat_holes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "mesh/disjoint_sets.h"
#include "mesh/self_intersections.h"
#include "mesh/triangle.h"
#include "repair/topology/flat_polygon.h"
#include "repair/topology/rims.h"

namespace raymap {

namespace {

constexpr double kFlat = 1e-4;  // Most distance from its plane, as a share of a rim's size.
constexpr double kDeep =
    1e-3;  // Least distance that the part at a rim has from its plane, as the same share.
constexpr double kCrack = 1e-6;  // Area over squared length of a rim below which it is a crack.
constexpr double kParallel = 1e-6;
constexpr int kMostAttempts = 8;    // Each finds more parts whose holes must stay.
constexpr size_t kMostRims = 4096;  // The time grows with the square.

/// A rim and the plane in which it lies.
struct FlatRim {
  const Rim* rim;
  uint32_t part;
  glm::dvec3 centre{0.0}, normal{0.0};  ///< The face of the hole points along the normal.
  double area = 0.0, size = 0.0;
  bool isFlat = true;
  std::optional<size_t> outline;  ///< The rim around this one, if it bounds the same face.
};

/// Faces that close one outline with the rims in it.
struct Cap {
  std::vector<size_t> rims;
  size_t firstFace = 0;
};

class FlatHoles {
 public:
  explicit FlatHoles(Mesh& mesh) : mesh_(mesh), rims_(findRims(mesh)), sets_(mesh.vertices.size()) {}

  FilledHoles fill() {
    if (rims_.closed.empty() || rims_.closed.size() > kMostRims) return {};
    for (const glm::uvec3& t : mesh_.triangles) sets_.link(t.x, t.y), sets_.link(t.y, t.z);
    isBad_.assign(mesh_.vertices.size(), false);
    for (const uint32_t vertex : rims_.open) isBad_[sets_.root(vertex)] = true;
    for (const Rim& rim : rims_.closed) measure(rim);
    findDepths();
    for (const FlatRim& rim : flat_)
      if (!rim.isFlat) isBad_[rim.part] = true;
    findOutlines();
    const size_t before = mesh_.triangles.size();
    for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
      if (tryToFill()) {
        size_t holes = 0;
        for (const Cap& cap : caps_) holes += cap.rims.size();
        return {holes, mesh_.triangles.size() - before};
      }
      mesh_.triangles.resize(before);
    }
    return {};
  }

 private:
  glm::dvec3 position(uint32_t vertex) const { return glm::dvec3(mesh_.vertices[vertex]); }
  double heightOver(const FlatRim& rim, const glm::dvec3& p) const {
    return std::abs(glm::dot(p - rim.centre, rim.normal));
  }

  /// Adds a rim unless it is a crack, which needs no faces.
  void measure(const Rim& rim) {
    FlatRim flat{.rim = &rim, .part = sets_.root(rim[0].from)};
    double length = 0.0;
    for (const BorderEdge& edge : rim) flat.centre += position(edge.from) / double(rim.size());
    for (const BorderEdge& edge : rim) {
      const glm::dvec3 a = position(edge.from), b = position(edge.to);
      flat.normal += 0.5 * doubleAreaNormal(flat.centre, a, b);
      length += glm::distance(a, b);
      flat.size = std::max(flat.size, 2.0 * glm::distance(a, flat.centre));
    }
    flat.area = glm::length(flat.normal);
    if (flat.area <= kCrack * length * length) return;
    flat.normal /= flat.area;
    flat.isFlat = std::ranges::all_of(rim, [&](const BorderEdge& edge) {
      return heightOver(flat, position(edge.from)) <= kFlat * flat.size;
    });
    flat_.push_back(flat);
  }

  /// Finds the rims at parts that lie in their planes, too. They are taken as not flat: a face would double
  /// them.
  void findDepths() {
    std::vector<std::vector<size_t>> rimsOf(mesh_.vertices.size());
    std::vector<bool> isDeep(flat_.size());
    for (size_t r = 0; r < flat_.size(); ++r) rimsOf[flat_[r].part].push_back(r);
    for (uint32_t v = 0; v < mesh_.vertices.size(); ++v)
      std::erase_if(rimsOf[sets_.root(v)], [&](size_t r) {
        const FlatRim& rim = flat_[r];
        return isDeep[r] = isDeep[r] || heightOver(rim, position(v)) > kDeep * rim.size;
      });
    for (size_t r = 0; r < flat_.size(); ++r) flat_[r].isFlat = flat_[r].isFlat && isDeep[r];
  }

  /// Returns a corner in the plane of a rim, turned so that the rim's normal points to the viewer. Leaves out
  /// one coordinate, so the others stay exact.
  static glm::dvec2 inPlane(const glm::dvec3& normal, const glm::dvec3& p) {
    const glm::dvec3 n = glm::abs(normal);
    const int axis = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
    const glm::dvec2 q(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    return normal[axis] > 0.0 ? q : glm::dvec2(q.y, q.x);
  }

  /// Returns whether a rim surrounds a point of its plane.
  bool surrounds(const FlatRim& rim, const glm::dvec3& point) const {
    const glm::dvec2 p = inPlane(rim.normal, point);
    bool isIn = false;
    for (const BorderEdge& edge : *rim.rim) {
      const glm::dvec2 a = inPlane(rim.normal, position(edge.from)),
                       b = inPlane(rim.normal, position(edge.to));
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) isIn = !isIn;
    }
    return isIn;
  }

  /// Finds for each rim whether it is a hole in the face that closes a larger one: it runs the other way.
  void findOutlines() {
    std::vector<size_t> order(flat_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, std::greater(), [&](size_t r) { return flat_[r].area; });
    for (size_t k = 0; k < order.size(); ++k) {
      FlatRim& rim = flat_[order[k]];
      for (size_t larger = k; larger-- > 0;) {
        const FlatRim& other = flat_[order[larger]];
        if (!other.isFlat || glm::dot(rim.normal, other.normal) > kParallel - 1.0) continue;
        if (heightOver(other, rim.centre) > kFlat * other.size) continue;
        if (!surrounds(other, position(rim.rim->front().from))) continue;
        if (!other.outline) rim.outline = order[larger];
        break;
      }
    }
  }

  std::vector<Cap> findCaps() {
    std::vector<Cap> capOf(flat_.size());
    for (size_t r = 0; r < flat_.size(); ++r) {
      const size_t outline = flat_[r].outline.value_or(r);
      capOf[outline].rims.push_back(r);
    }
    std::vector<Cap> caps;
    for (size_t r = 0; r < flat_.size(); ++r) {
      if (flat_[r].outline) continue;
      std::stable_partition(capOf[r].rims.begin(), capOf[r].rims.end(),
                            [&](size_t each) { return each == r; });
      if (std::ranges::none_of(capOf[r].rims, [&](size_t each) { return isBad_[flat_[each].part]; }))
        caps.push_back(std::move(capOf[r]));
      else
        for (const size_t each : capOf[r].rims) isBad_[flat_[each].part] = true;
    }
    return caps;
  }

  bool append(Cap& cap) {
    const glm::dvec3& normal = flat_[cap.rims[0]].normal;
    std::vector<std::vector<FlatCorner>> loops;
    for (const size_t r : cap.rims) {
      std::vector<FlatCorner>& loop = loops.emplace_back();
      for (const BorderEdge& edge : *flat_[r].rim)
        loop.push_back({inPlane(normal, position(edge.from)), edge.from});
    }
    cap.firstFace = mesh_.triangles.size();
    return coverPolygon(loops, mesh_.triangles);
  }

  void discard(const Cap& cap) {
    for (const size_t r : cap.rims) isBad_[flat_[r].part] = true;
  }

  /// Appends the caps of all parts that are not bad. Returns false if parts turn out to be bad.
  bool tryToFill() {
    const size_t before = mesh_.triangles.size();
    size_t bad = 0;
    do {
      bad = size_t(std::ranges::count(isBad_, true));
      caps_ = findCaps();
    } while (size_t(std::ranges::count(isBad_, true)) != bad);
    bool areGood = true;
    for (Cap& cap : caps_)
      if (!append(cap)) discard(cap), areGood = false;
    return areGood && (mesh_.triangles.size() == before || !discardCovered());
  }

  /// Discards caps that overlap faces in their plane: their own, those of their part, or those of parts that
  /// stay open, which may be what closes the hole. Returns whether there are any.
  bool discardCovered() {
    const auto capOf = [&](uint32_t face) {
      return size_t(std::ranges::upper_bound(caps_, size_t{face}, {}, &Cap::firstFace) - caps_.begin());
    };
    bool areAny = false;
    const auto visit = [&](const FacePair& pair) {
      const size_t a = capOf(pair.a), b = capOf(pair.b), number = std::max(a, b);  // 0: a face of the mesh.
      if (!pair.isInPlane || number == 0 || (a != b && a != 0 && b != 0)) return;
      const Cap& cap = caps_[number - 1];
      const uint32_t part = sets_.root(mesh_.triangles[a < b ? pair.a : pair.b].x);
      const bool isOwn = std::ranges::any_of(cap.rims, [&](size_t r) { return flat_[r].part == part; });
      if (!isOwn && !isBad_[part]) return;
      discard(cap);
      areAny = true;
    };
    Progress none;
    forEachMeetingPair(mesh_, visit, none);
    return areAny;
  }

  Mesh& mesh_;
  Rims rims_;
  DisjointSets sets_;
  std::vector<bool> isBad_;  // For the root of each part: whether its holes are left as they are.
  std::vector<FlatRim> flat_;
  std::vector<Cap> caps_;
};

}  // namespace

FilledHoles fillFlatHoles(Mesh& mesh) {
  return FlatHoles(mesh).fill();
}

}  // namespace raymap
