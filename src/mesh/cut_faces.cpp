// Cuts faces where they meet others: all pairs first, then sheet by sheet until all segments are whole.

#include "mesh/cut_faces.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/progress.h"
#include "mesh/disjoint_sets.h"
#include "mesh/plane_triangles.h"
#include "mesh/self_intersections.h"
#include "mesh/vertex_lattice.h"

namespace raymap {

namespace {

constexpr uint32_t kNone = UINT32_MAX;
// Limits on the work.
constexpr size_t kMostPairs = size_t{1} << 20, kMostSegments = size_t{1} << 21;
constexpr size_t kMostTests = size_t{1} << 32;

/// Numbers of points that ascend.
using PointSet = std::vector<uint32_t>;

bool insert(PointSet& points, uint32_t point) {
  const auto place = std::ranges::lower_bound(points, point);
  if (place != points.end() && *place == point) return false;
  points.insert(place, point);
  return true;
}

/// A straight line between two points: an edge of faces, or where two faces meet.
struct Segment {
  uint32_t from, to;
  PointSet inner = {};  ///< Points that it is cut at.
};

/// Faces that overlap in one plane, or a single one.
struct Sheet {
  std::vector<uint32_t> faces = {};
  std::vector<uint32_t> segments = {};
  PointSet touched = {};   ///< Points at which other faces touch it.
  size_t seen = SIZE_MAX;  ///< Number of inner points of its segments when they were last cut.
};

/// A point that has no number yet unless it is a corner.
struct Candidate {
  ExactPoint place;
  uint32_t corner = kNone;
};

class FaceCutter {
 public:
  explicit FaceCutter(const PackedMesh& mesh) : lattice_(mesh), mesh_(mesh), points_(placesOf()) {}

  std::optional<CutFaces> cut() {
    if (!findPairs() || !addSheets() || !cutSegments()) return {};
    std::vector<bool> isInSheet(corners_.size());
    std::vector<CutPiece> pieces;
    for (const Sheet& sheet : sheets_) {
      if (!mustCut(sheet)) continue;
      for (const uint32_t face : sheet.faces) isInSheet[face] = true;
      if (!cutSheet(sheet)) return {};
    }
    for (uint32_t f = 0; f < corners_.size(); ++f)
      if (!isInSheet[f] && hasArea(f)) pieces.push_back({corners_[f], f, 1, false});
    pieces.insert(pieces.end(), parts_.begin(), parts_.end());
    return CutFaces{std::move(points_), std::move(vertices_), std::move(corners_), std::move(pieces),
                    cutFaces_,          repeatedFaces_};
  }

 private:
  /// Returns the distinct places of all vertices, ascending, and numbers the corners by them.
  std::vector<glm::ivec3> placesOf() {
    std::vector<glm::ivec3> all;
    for (size_t v = 0; v < mesh_.vertices.size(); ++v) all.push_back(lattice_.vertex(v));
    std::vector<uint32_t> order(all.size()), numbers(all.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t v) { return std::tuple(all[v].x, all[v].y, all[v].z, v); };
    std::ranges::sort(order, {}, key);
    std::vector<glm::ivec3> places;
    for (const uint32_t v : order) {
      if (places.empty() || places.back() != all[v]) {
        places.push_back(all[v]);
        vertices_.push_back(v);
      }
      numbers[v] = uint32_t(places.size() - 1);
    }
    for (const glm::uvec3& t : mesh_.triangles)
      corners_.emplace_back(numbers[t.x], numbers[t.y], numbers[t.z]);
    return places;
  }

  WholeTriangle face(uint32_t f) const { return lattice_.face(f); }
  bool hasArea(uint32_t f) const { return WholePlane(face(f)).steepestAxis() >= 0; }
  bool isCorner(uint32_t f, uint32_t point) const {
    return corners_[f].x == point || corners_[f].y == point || corners_[f].z == point;
  }

  bool findPairs() {
    Progress untold{ProgressCallback{}};
    std::vector<FacePair> pairs;
    bool areFew = true;
    const auto visit = [&](const FacePair& pair) {
      areFew = areFew && pairs.size() < kMostPairs;
      if (areFew) pairs.push_back(pair);
    };
    if (!forEachTouchingPair(mesh_, visit, untold) || !areFew) return false;
    DisjointSets layers(corners_.size());
    sheetOf_.assign(corners_.size(), kNone);
    for (const auto& [a, b, isInPlane] : pairs)
      if (isInPlane) layers.link(a, b);
    for (const auto& [a, b, isInPlane] : pairs) {
      if (isInPlane)
        for (const uint32_t f : {a, b}) layered_.push_back({f, layers.root(f)});
      else
        meet(a, b);
    }
    return segments_.size() <= kMostSegments;
  }

  /// Returns the ends of what a face has in common with the plane of another one.
  std::vector<Candidate> ends(uint32_t f, const WholePlane& plane, const glm::ivec3& inPlane,
                              const CornerSides& sides) const {
    std::vector<Candidate> found;
    const WholeTriangle t = face(f);
    for (size_t k = 0; k < 3; ++k) {
      const size_t next = (k + 1) % 3;
      if (sides[k] == 0) found.push_back({points_.at(corners_[f][int(k)]), corners_[f][int(k)]});
      if (sides[k] * sides[next] < 0)
        found.push_back({crossPlane(t[k], t[next], inPlane, plane.normal()), kNone});
    }
    return found;
  }

  uint32_t numberOf(Candidate& end) {
    return end.corner == kNone ? points_.numberOf(std::move(end.place)) : end.corner;
  }

  /// Finds what two faces of different planes have in common, and cuts both there.
  void meet(uint32_t f, uint32_t g) {
    const WholeTriangle a = face(f), b = face(g);
    const WholePlane planeOfA(a), planeOfB(b);
    std::vector<Candidate> ofF = ends(f, planeOfB, b[0], planeOfB.sidesOf<Int128>(a)),
                           ofG = ends(g, planeOfA, a[0], planeOfA.sidesOf<Int128>(b));
    if (ofF.empty() || ofG.empty()) return;
    const int axis = commonLine(planeOfA.normal(), planeOfB.normal()).axis;
    const auto isBefore = [axis](const Candidate& p, const Candidate& q) {
      return compareAlong(p.place, q.place, axis) < 0;
    };
    std::ranges::sort(ofF, isBefore);
    std::ranges::sort(ofG, isBefore);
    Candidate &low = isBefore(ofF.front(), ofG.front()) ? ofG.front() : ofF.front(),
              &high = isBefore(ofF.back(), ofG.back()) ? ofF.back() : ofG.back();
    if (isBefore(high, low)) return;
    const uint32_t from = numberOf(low), to = &high == &low ? from : numberOf(high);
    for (const uint32_t face : {f, g})
      if (from == to)
        touch(face, from);
      else if (!isCorner(face, from) || !isCorner(face, to))
        cuts_.push_back({face, segmentOf(from, to)});
  }

  void touch(uint32_t f, uint32_t point) {
    if (!isCorner(f, point)) touches_.push_back({f, point});
  }

  uint32_t segmentOf(uint32_t from, uint32_t to) {
    const auto [low, high] = std::minmax(from, to);
    const auto [place, isNew] =
        segmentAt_.try_emplace(uint64_t{low} << 32 | high, uint32_t(segments_.size()));
    if (isNew) segments_.push_back({low, high});
    return place->second;
  }

  /// Returns the sheet of a face, which may be new.
  Sheet& sheetOf(uint32_t f) {
    uint32_t& number = sheetOf_[f];
    if (number == kNone) {
      number = uint32_t(sheets_.size());
      sheets_.emplace_back();
      join(f, sheets_.back());
    }
    return sheets_[number];
  }
  void join(uint32_t f, Sheet& sheet) {
    sheet.faces.push_back(f);
    for (int k = 0; k < 3; ++k) sheet.segments.push_back(segmentOf(corners_[f][k], corners_[f][(k + 1) % 3]));
  }

  /// Makes a sheet of each group of faces that overlap in one plane, and of each other face that is cut.
  bool addSheets() {
    std::ranges::sort(layered_, [](const auto& a, const auto& b) {
      return std::pair(a.second, a.first) < std::pair(b.second, b.first);
    });
    layered_.erase(std::unique(layered_.begin(), layered_.end()), layered_.end());
    for (const auto& [f, root] : layered_) {
      if (sheetOf_[root] == kNone) {
        sheetOf_[root] = uint32_t(sheets_.size());
        sheets_.emplace_back();
      }
      sheetOf_[f] = sheetOf_[root];
      join(f, sheets_[sheetOf_[f]]);
    }
    for (const auto& [f, segment] : cuts_) sheetOf(f).segments.push_back(segment);
    for (const auto& [f, point] : touches_) insert(sheetOf(f).touched, point);
    for (uint32_t f = 0; f < corners_.size(); ++f)
      if (!hasArea(f)) addFlat(f);
    for (Sheet& sheet : sheets_) {
      std::ranges::sort(sheet.segments);
      sheet.segments.erase(std::unique(sheet.segments.begin(), sheet.segments.end()), sheet.segments.end());
    }
    return true;
  }

  /// A face without area cuts its longest edge in its third corner.
  void addFlat(uint32_t f) {
    const glm::uvec3& t = corners_[f];
    if (t.x == t.y || t.y == t.z || t.z == t.x) return;
    sheetOf(f);
  }

  /// Cuts the segments of all sheets until they share no inner points.
  bool cutSegments() {
    for (bool isChanged = true; isChanged;) {
      isChanged = addEdgeSheets();
      for (Sheet& sheet : sheets_) {
        if (innerPoints(sheet) == sheet.seen) continue;
        if (!cutSegments(sheet)) return false;
        isChanged = true;
        sheet.seen = innerPoints(sheet);
      }
    }
    return true;
  }

  size_t innerPoints(const Sheet& sheet) const {
    size_t count = 0;
    for (const uint32_t s : sheet.segments) count += segments_[s].inner.size();
    return count;
  }

  /// Makes sheets of faces of which an edge is cut. Returns whether there were any.
  bool addEdgeSheets() {
    std::vector<bool> isEnd(vertices_.size());
    for (const Segment& segment : segments_)
      if (!segment.inner.empty() && segment.to < isEnd.size()) isEnd[segment.from] = isEnd[segment.to] = true;
    const size_t before = sheets_.size();
    for (uint32_t f = 0; f < corners_.size(); ++f)
      for (int k = 0; k < 3 && sheetOf_[f] == kNone; ++k) {
        const auto [low, high] = std::minmax(corners_[f][k], corners_[f][(k + 1) % 3]);
        if (!isEnd[low] || !isEnd[high]) continue;
        const auto segment = segmentAt_.find(uint64_t{low} << 32 | high);
        if (segment != segmentAt_.end() && !segments_[segment->second].inner.empty()) sheetOf(f);
      }
    return sheets_.size() > before;
  }

  /// A segment in a sheet, with its bounds.
  struct Span {
    uint32_t segment;
    glm::dvec2 low, high;
  };

  glm::dvec2 seen(uint32_t point, int axis) const {
    const glm::dvec3& p = points_.rounded(point);
    return {p[(axis + 1) % 3], p[(axis + 2) % 3]};
  }

  std::vector<Span> spansOf(const Sheet& sheet, int axis) const {
    std::vector<Span> spans;
    for (const uint32_t s : sheet.segments) {
      const glm::dvec2 a = seen(segments_[s].from, axis), b = seen(segments_[s].to, axis);
      constexpr double kRounding = 1e-3;
      spans.push_back({s, glm::min(a, b) - kRounding, glm::max(a, b) + kRounding});
    }
    std::ranges::stable_sort(spans, {}, [](const Span& span) { return span.low.x; });
    return spans;
  }

  bool cutSegments(Sheet& sheet) {
    const WholePlane plane(face(sheet.faces[0]));
    const int axis = plane.steepestAxis();
    PointSet points = sheet.touched;
    for (const uint32_t s : sheet.segments) {
      points.push_back(segments_[s].from);
      points.push_back(segments_[s].to);
      points.insert(points.end(), segments_[s].inner.begin(), segments_[s].inner.end());
    }
    if (axis >= 0 && !crossSpans(spansOf(sheet, axis), axis, face(sheet.faces[0])[0], plane.normal(), points))
      return false;
    std::ranges::sort(points);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return axis >= 0 ? cutAt(points, spansOf(sheet, axis), axis) : cutFlat(points, sheet);
  }

  /// Cuts segments where they cross. Appends these points.
  bool crossSpans(const std::vector<Span>& spans, int axis, const glm::ivec3& inPlane,
                  const glm::i64vec3& normal, PointSet& points) {
    for (size_t i = 0; i < spans.size(); ++i)
      for (size_t j = i + 1; j < spans.size() && spans[j].low.x <= spans[i].high.x; ++j) {
        if (++tests_ > kMostTests) return false;
        if (spans[j].low.y > spans[i].high.y || spans[j].high.y < spans[i].low.y) continue;
        Segment &s = segments_[spans[i].segment], &t = segments_[spans[j].segment];
        if (s.from == t.from || s.from == t.to || s.to == t.from || s.to == t.to) continue;
        const auto areApart = [&](const Segment& a, const Segment& b) {
          return points_.turn(a.from, a.to, b.from, axis) * points_.turn(a.from, a.to, b.to, axis) < 0;
        };
        if (!areApart(s, t) || !areApart(t, s)) continue;
        const uint32_t point = points_.crossLines({s.from, s.to, t.from, t.to}, axis, inPlane, normal);
        insert(s.inner, point);
        insert(t.inner, point);
        points.push_back(point);
      }
    return true;
  }

  /// Cuts segments at the points that lie on them.
  bool cutAt(const PointSet& points, const std::vector<Span>& spans, int axis) {
    std::vector<std::pair<double, uint32_t>> order;
    for (const uint32_t p : points) order.emplace_back(seen(p, axis).x, p);
    std::ranges::sort(order);
    for (const Span& span : spans) {
      Segment& s = segments_[span.segment];
      for (auto at = std::ranges::lower_bound(order, std::pair(span.low.x, 0u));
           at != order.end() && at->first <= span.high.x; ++at) {
        if (++tests_ > kMostTests) return false;
        const uint32_t p = at->second;
        const double y = seen(p, axis).y;
        if (y < span.low.y || y > span.high.y || points_.turn(s.from, s.to, p, axis) != 0) continue;
        if (isBetween(s, p)) insert(s.inner, p);
      }
    }
    return true;
  }

  /// Does the same for a face without area: all of its points lie on one line.
  bool cutFlat(const PointSet& points, const Sheet& sheet) {
    for (const uint32_t s : sheet.segments)
      for (const uint32_t p : points)
        if (isBetween(segments_[s], p)) insert(segments_[s].inner, p);
    return true;
  }

  int longAxis(const Segment& s) const {
    const glm::dvec3 along = glm::abs(points_.rounded(s.to) - points_.rounded(s.from));
    return along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
  }
  bool isBetween(const Segment& s, uint32_t p) const {
    const int axis = longAxis(s);
    return points_.compare(s.from, p, axis) * points_.compare(p, s.to, axis) > 0;
  }

  bool mustCut(const Sheet& sheet) const {
    return hasArea(sheet.faces[0]) &&
           (sheet.faces.size() > 1 || sheet.segments.size() > 3 || innerPoints(sheet) > 0);
  }

  /// Returns the points of a segment from end to end.
  std::vector<uint32_t> chainOf(const Segment& s) const {
    const int axis = longAxis(s);
    std::vector<uint32_t> chain = s.inner;
    chain.push_back(s.from);
    chain.push_back(s.to);
    std::ranges::sort(chain, [&](uint32_t a, uint32_t b) { return points_.compare(a, b, axis) < 0; });
    if (chain[0] != s.from) std::ranges::reverse(chain);
    return chain;
  }

  bool cutSheet(const Sheet& sheet) {
    const int axis = WholePlane(face(sheet.faces[0])).steepestAxis();
    PlaneTriangles plane(points_, axis);
    PointSet added;
    std::vector<std::vector<uint32_t>> chains;
    for (const uint32_t s : sheet.segments) chains.push_back(chainOf(segments_[s]));
    for (const std::vector<uint32_t>& chain : chains)
      for (const uint32_t p : chain)
        if (insert(added, p)) plane.addPoint(p);
    for (const std::vector<uint32_t>& chain : chains)
      for (size_t k = 1; k < chain.size(); ++k)
        if (!plane.addEdge(chain[k - 1], chain[k])) return false;
    return collect(sheet, axis, plane.triangles());
  }

  /// Triangles of a plane, and where they are by their directed edges.
  struct TriangleMap {
    const std::vector<glm::uvec3>& triangles;
    std::unordered_map<uint64_t, uint32_t> at = {};

    explicit TriangleMap(const std::vector<glm::uvec3>& all) : triangles(all) {
      for (uint32_t t = 0; t < all.size(); ++t)
        for (int k = 0; k < 3; ++k) at[edge(t, k)] = t;
    }
    static uint64_t keyOf(uint32_t from, uint32_t to) { return uint64_t{from} << 32 | to; }
    static uint64_t turned(uint64_t edge) { return edge << 32 | edge >> 32; }
    uint64_t edge(uint32_t t, int k) const { return keyOf(triangles[t][k], triangles[t][(k + 1) % 3]); }
  };

  /// Returns the directed edges of triangles around a face, counter-clockwise in the plane.
  std::vector<uint64_t> rimOf(uint32_t f, bool isTurned) const {
    std::vector<uint64_t> rim;
    for (int k = 0; k < 3; ++k) {
      uint32_t from = corners_[f][k], to = corners_[f][(k + 1) % 3];
      if (isTurned) std::swap(from, to);
      const auto [low, high] = std::minmax(from, to);
      std::vector<uint32_t> chain = chainOf(segments_[segmentAt_.at(TriangleMap::keyOf(low, high))]);
      if (chain[0] != from) std::ranges::reverse(chain);
      for (size_t c = 1; c < chain.size(); ++c) rim.push_back(TriangleMap::keyOf(chain[c - 1], chain[c]));
    }
    std::ranges::sort(rim);
    return rim;
  }

  /// Visits the triangles within a rim. Returns false if the rim does not close.
  template <class Visit>
  static bool fill(const TriangleMap& map, const std::vector<uint64_t>& rim, const Visit& visit) {
    std::vector<uint64_t> open = rim;  // Edges whose triangles are in the face.
    while (!open.empty()) {
      const auto found = map.at.find(open.back());
      open.pop_back();
      if (found == map.at.end()) return false;
      const uint32_t t = found->second;
      if (!visit(t)) continue;
      for (int k = 0; k < 3; ++k)
        if (const uint64_t edge = map.edge(t, k); !std::ranges::binary_search(rim, edge))
          open.push_back(TriangleMap::turned(edge));
    }
    return true;
  }

  /// Appends the triangles that lie in the faces of a sheet.
  bool collect(const Sheet& sheet, int axis, const std::vector<glm::uvec3>& triangles) {
    const TriangleMap map(triangles);
    std::vector<int> layers(triangles.size());
    std::vector<uint32_t> firsts(triangles.size(), kNone), lasts(triangles.size(), kNone);
    for (const uint32_t f : sheet.faces) {
      const int side = WholePlane(face(f)).normal()[axis] > 0 ? 1 : -1;
      size_t parts = 0, repeated = 0;
      const auto visit = [&](uint32_t t) {
        if (lasts[t] == f) return false;
        ++parts;
        repeated += lasts[t] != kNone ? 1 : 0;
        lasts[t] = f;
        layers[t] += side;
        firsts[t] = std::min(firsts[t], f);
        return true;
      };
      if (!fill(map, rimOf(f, side < 0), visit)) return false;
      cutFaces_ += parts > 1 ? 1 : 0;
      repeatedFaces_ += parts == 1 ? repeated : 0;
    }
    for (size_t t = 0; t < triangles.size(); ++t) {
      if (firsts[t] == kNone) continue;
      glm::uvec3 corners = triangles[t];
      if (layers[t] < 0) std::swap(corners.y, corners.z);
      const bool isFaceBelow = WholePlane(face(firsts[t])).normal()[axis] < 0;
      parts_.push_back({corners, firsts[t], std::abs(layers[t]), isFaceBelow != (layers[t] < 0)});
    }
    return true;
  }

  VertexLattice lattice_;
  PackedMesh mesh_;
  std::vector<uint32_t> vertices_;
  std::vector<glm::uvec3> corners_;
  ExactPoints points_;
  std::vector<Segment> segments_;
  std::unordered_map<uint64_t, uint32_t> segmentAt_;
  std::vector<CutPiece> parts_;
  size_t cutFaces_ = 0, repeatedFaces_ = 0;
  std::vector<std::pair<uint32_t, uint32_t>> layered_;  // Faces that overlap others, and their group.
  std::vector<std::pair<uint32_t, uint32_t>> cuts_;     // Faces and segments in them.
  std::vector<std::pair<uint32_t, uint32_t>> touches_;  // Faces and points on them.
  std::vector<uint32_t> sheetOf_;
  std::vector<Sheet> sheets_;
  size_t tests_ = 0;
};

}  // namespace

std::optional<CutFaces> cutFaces(const PackedMesh& mesh) {
  return FaceCutter(mesh).cut();
}

}  // namespace raymap
