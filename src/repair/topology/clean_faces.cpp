#include "repair/topology/clean_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "mesh/compact.h"
#include "mesh/disjoint_sets.h"
#include "mesh/double_sided.h"
#include "mesh/face_measures.h"
#include "mesh/half_edges.h"
#include "mesh/triangle.h"

namespace raymap {

namespace {

constexpr double kShortEdge = 1e-6;         // Share of the face's longest edge.
constexpr double kShortRoundedEdge = 1e-5;  // The same where corners are rounded.
constexpr double kMoved = 1.5e-7;           // Share of the mesh's size by which a vertex may be off.
constexpr double kRoundedEdge = 1e-6;       // Share of the mesh's size that rounding may make of a point.

/// Leaves out the faces that are marked.
void leaveOut(const std::vector<bool>& isLeftOut, CleanedFaces& cleaned) {
  size_t kept = 0;
  for (size_t f = 0; f < cleaned.given.size(); ++f) {
    if (isLeftOut[f]) continue;
    cleaned.mesh.triangles[kept] = cleaned.mesh.triangles[f];
    cleaned.given[kept++] = cleaned.given[f];
  }
  cleaned.count += cleaned.given.size() - kept;
  cleaned.mesh.triangles.resize(kept);
  cleaned.given.resize(kept);
}

void leaveOutFlat(CleanedFaces& cleaned) {
  std::vector<bool> isFlat;
  for (const glm::uvec3& t : cleaned.mesh.triangles) isFlat.push_back(hasRepeatedCorner(t));
  leaveOut(isFlat, cleaned);
}

void leaveOutRepeated(CleanedFaces& cleaned) {
  std::vector<bool> isRepeated(cleaned.given.size());
  for (const uint32_t face : findDoubleSidedFaces(PackedMesh(cleaned.mesh)).repeated) isRepeated[face] = true;
  leaveOut(isRepeated, cleaned);
}

/// Leaves out one of two faces that lie on each other, one of them turned, where the other one continues the
/// surface around it: the edges between them are not balanced.
void leaveOutOtherSides(CleanedFaces& cleaned) {
  const DoubleSidedFaces found = findDoubleSidedFaces(PackedMesh(cleaned.mesh));
  if (found.empty()) return;
  const std::vector<glm::uvec3>& faces = cleaned.mesh.triangles;
  struct Edge {
    int surplus = 0;              // Faces that run along it, less those that run back.
    std::vector<size_t> at = {};  // Those of `others` that lie at it.
  };
  std::map<std::pair<uint32_t, uint32_t>, Edge> edges;
  const auto add = [&](const glm::uvec3& t, int count) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      if (const auto edge = edges.find({low, high}); edge != edges.end())
        edge->second.surplus += low == t[k] ? count : -count;
    }
  };
  const auto along = [&](const glm::uvec3& t) {
    int sum = 0;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      sum += (low == t[k] ? 1 : -1) * edges.at({low, high}).surplus;
    }
    return sum;
  };
  std::vector<size_t> waiting;
  for (size_t k = found.others.size(); k-- > 0;) {
    const glm::uvec3& t = faces[found.others[k]];
    for (int c = 0; c < 3; ++c) edges[std::minmax({t[c], t[(c + 1) % 3]})].at.push_back(k);
    waiting.push_back(k);
  }
  for (const glm::uvec3& t : faces) add(t, 1);
  std::vector<bool> isLeftOut(faces.size()), isDecided(found.firsts.size());
  while (!waiting.empty()) {
    const size_t k = waiting.back(), group = found.groupOf[k];
    waiting.pop_back();
    const uint32_t first = found.firsts[group], other = found.others[k];
    const int more = isDecided[group] ? 0 : along(faces[first]);
    if (more == 0 || along(faces[other]) == more) continue;  // The same if both face one way.
    const uint32_t out = more > 0 ? first : other;
    const glm::uvec3& t = faces[out];
    add(t, -1);
    isLeftOut[out] = isDecided[group] = true;
    for (int c = 0; c < 3; ++c) {
      const std::vector<size_t>& beside = edges.at(std::minmax({t[c], t[(c + 1) % 3]})).at;
      waiting.insert(waiting.end(), beside.begin(), beside.end());
    }
  }
  leaveOut(isLeftOut, cleaned);
}

/// Edges of a face by length: edge k goes from corner k to the next.
struct EdgeLengths {
  int shortest = 0, longest = 0;
  double shortLength = 0.0, longLength = 0.0;
};

EdgeLengths edgeLengths(const Mesh& mesh, const glm::uvec3& t) {
  glm::dvec3 squares;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 edge = glm::dvec3(mesh.vertices[t[(k + 1) % 3]]) - glm::dvec3(mesh.vertices[t[k]]);
    squares[k] = glm::dot(edge, edge);
  }
  EdgeLengths lengths;
  for (int k = 1; k < 3; ++k) {
    if (squares[k] < squares[lengths.shortest]) lengths.shortest = k;
    if (squares[k] > squares[lengths.longest]) lengths.longest = k;
  }
  lengths.shortLength = std::sqrt(squares[lengths.shortest]);
  lengths.longLength = std::sqrt(squares[lengths.longest]);
  return lengths;
}

std::vector<uint32_t> degenerateFaces(const Model& mesh) {
  std::vector<uint32_t> faces;
  forEachFaceMeasure(mesh, glm::dvec3(0.0), [&](size_t face, const FaceMeasure& measure) {
    if (measure.isDegenerate) faces.push_back(uint32_t(face));
  });
  return faces;
}

/// Welds the ends of edges of faces that are shorter than `least`, or than a share of the longest edge of
/// their face. Returns whether there were any.
bool weldShortEdges(CleanedFaces& cleaned, const std::vector<uint32_t>& faces, double least, double share) {
  Mesh& mesh = cleaned.mesh;
  DisjointSets sets(mesh.vertices.size());
  bool isAny = false;
  for (const uint32_t f : faces) {
    const glm::uvec3& t = mesh.triangles[f];
    const EdgeLengths lengths = edgeLengths(mesh, t);
    if (lengths.shortLength >= std::max(least, share * lengths.longLength)) continue;
    sets.link(t[lengths.shortest], t[(lengths.shortest + 1) % 3]);
    isAny = true;
  }
  if (!isAny) return false;
  for (glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) t[c] = sets.root(t[c]);
  leaveOutFlat(cleaned);
  return true;
}

/// A face across an edge, and the corner that it does not share.
struct Neighbour {
  uint32_t face, apex;
};

/// Returns the face across edge `k` of a face; nothing unless exactly these two have it, in opposite order.
std::optional<Neighbour> neighbourOf(const Model& mesh, uint32_t face, int k) {
  const std::span<const SortKey> keys = mesh.halfEdges();
  const glm::uvec3 t = weldedFace(mesh, mesh.welding(), face);
  const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
  const uint64_t edge = uint64_t{low} << 32 | high;
  const auto first = size_t(std::ranges::lower_bound(keys, edge, {}, &SortKey::high) - keys.begin());
  if (edgeStart(keys, first + 1) != first + 2) return {};
  const HalfEdge a = halfEdgeOf(keys[first]), b = halfEdgeOf(keys[first + 1]);
  if (a.isForward == b.isForward) return {};
  const uint32_t other = a.face == face ? b.face : a.face;
  const glm::uvec3 welded = weldedFace(mesh, mesh.welding(), other);
  for (int c = 0; c < 3; ++c)
    if (welded[c] != low && welded[c] != high) return Neighbour{other, mesh.triangles[other][c]};
  return {};
}

/// Leaves out faces that a flip has laid on others which face the other way: the flipped edge was there
/// already.
void leaveOutFlaps(CleanedFaces& cleaned, const std::vector<bool>& isFlipped) {
  const DoubleSidedFaces found = findDoubleSidedFaces(PackedMesh(cleaned.mesh));
  std::vector<bool> isFlap, isLeftOut(cleaned.given.size());
  for (const uint32_t face : found.firsts) isFlap.push_back(isFlipped[face]);
  for (size_t k = 0; k < found.others.size(); ++k)
    if (isFlipped[found.others[k]]) isFlap[found.groupOf[k]] = true;
  for (size_t g = 0; g < isFlap.size(); ++g) isLeftOut[found.firsts[g]] = isFlap[g];
  for (size_t k = 0; k < found.others.size(); ++k) isLeftOut[found.others[k]] = isFlap[found.groupOf[k]];
  leaveOut(isLeftOut, cleaned);
}

/// Flips the longest edges of degenerate faces, each face at most once. Their neighbours there are sound, or
/// if corners are rounded, any with which the edge gets shorter. Returns whether there were any.
bool flipLongEdges(CleanedFaces& cleaned, const std::vector<uint32_t>& degenerate, bool areRounded) {
  const Model mesh(cleaned.mesh);
  std::vector<bool> isTaken(cleaned.given.size()), isDegenerate(cleaned.given.size());
  for (const uint32_t face : degenerate) isDegenerate[face] = true;
  const auto length = [&](uint32_t a, uint32_t b) {
    return glm::distance(glm::dvec3(mesh.vertices[a]), glm::dvec3(mesh.vertices[b]));
  };
  std::vector<std::pair<uint32_t, glm::uvec3>> replaced;
  for (const uint32_t face : degenerate) {
    const glm::uvec3 t = mesh.triangles[face];
    const int k = edgeLengths(cleaned.mesh, t).longest;
    const std::optional<Neighbour> across = neighbourOf(mesh, face, k);
    if (!across || isTaken[face] || isTaken[across->face]) continue;
    const uint32_t from = t[k], to = t[(k + 1) % 3], apex = t[(k + 2) % 3];
    if (isDegenerate[across->face] && !(areRounded && length(apex, across->apex) < length(from, to)))
      continue;
    isTaken[face] = isTaken[across->face] = true;
    replaced.emplace_back(face, glm::uvec3(from, across->apex, apex));
    replaced.emplace_back(across->face, glm::uvec3(across->apex, to, apex));
    if (!isDegenerate[across->face]) cleaned.given[face] = cleaned.given[across->face];
    ++cleaned.count;
  }
  std::vector<bool> isFlipped(cleaned.given.size());
  for (const auto& [face, corners] : replaced) {
    cleaned.mesh.triangles[face] = corners;
    isFlipped[face] = true;
  }
  if (!replaced.empty()) leaveOutFlaps(cleaned, isFlipped);
  return !replaced.empty();
}

/// Moves the apex of a face whose height rounding has made 0 or less away from the longest edge, in the plane
/// of the face across that edge. `rounding` is what it may move a vertex by. `links` knows which faces share
/// edges; moved vertices do not change that.
void raiseApex(const Model& links, Mesh& mesh, uint32_t face, double rounding) {
  constexpr double kHeight = 4e-6;  // Share of the longest edge; 1e-6 is degenerate.
  const glm::uvec3 t = mesh.triangles[face];
  const EdgeLengths lengths = edgeLengths(mesh, t);
  const int k = lengths.longest;
  const uint32_t apex = t[(k + 2) % 3];
  const auto at = [&](uint32_t v) { return glm::dvec3(mesh.vertices[v]); };
  const glm::dvec3 from = at(t[k]), along = (at(t[(k + 1) % 3]) - from) / lengths.longLength;
  const auto heightOf = [&](uint32_t v) { return at(v) - from - glm::dot(at(v) - from, along) * along; };
  const std::optional<Neighbour> across = neighbourOf(links, face, k);
  if (!across) return;
  const glm::dvec3 away = -heightOf(across->apex);
  if (!(glm::length(away) > 0.0)) return;
  const double height = std::max(kHeight * lengths.longLength, 2.0 * rounding);
  mesh.vertices[apex] = glm::vec3(at(apex) - heightOf(apex) + height * glm::normalize(away));
}

}  // namespace

CleanedFaces cleanFaces(const Model& mesh, Cleaning how) {
  const bool areRounded = how == Cleaning::Rounded;
  constexpr int kMostRounds = 16;  // A round takes one of several degenerate faces in a row.
  CleanedFaces cleaned{.mesh = weldedCopy(mesh)};
  for (uint32_t f = 0; f < cleaned.mesh.triangles.size(); ++f) cleaned.given.push_back(f);
  leaveOutFlat(cleaned);
  leaveOutRepeated(cleaned);
  leaveOutOtherSides(cleaned);
  const glm::dvec3 sides = bounds(mesh).size();
  const double size = areRounded ? std::max({sides.x, sides.y, sides.z}) : 0.0;
  if (areRounded) {
    std::vector<uint32_t> all(cleaned.given.size());
    std::iota(all.begin(), all.end(), 0u);
    weldShortEdges(cleaned, all, kMoved * size, 0.0);
  }
  const int rounds = how == Cleaning::Repeated ? 0 : kMostRounds;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<uint32_t> degenerate = degenerateFaces(Model(cleaned.mesh));
    if (degenerate.empty()) break;
    if (!weldShortEdges(cleaned, degenerate, kRoundedEdge * size,
                        areRounded ? kShortRoundedEdge : kShortEdge) &&
        !flipLongEdges(cleaned, degenerate, areRounded))
      break;
  }
  if (areRounded) raiseDegenerate(cleaned.mesh);
  removeUnusedVertices(cleaned.mesh);
  return cleaned;
}

std::vector<uint32_t> facesOf(const std::vector<uint32_t>& faces, const std::vector<uint32_t>& given) {
  std::vector<uint32_t> found;
  for (const uint32_t face : faces) found.push_back(given[face]);
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

void raiseDegenerate(Mesh& mesh) {
  const Model links(mesh);
  for (const uint32_t face : degenerateFaces(links)) raiseApex(links, mesh, face, 0.0);
}

void raiseLowFaces(Mesh& mesh, const std::vector<uint32_t>& crossing) {
  const glm::dvec3 size = bounds(mesh).size();
  const double rounding = kMoved * std::max({size.x, size.y, size.z});
  const Model links(mesh);
  std::vector<bool> isNear(mesh.vertices.size());
  for (const uint32_t face : crossing)
    for (int c = 0; c < 3; ++c) isNear[mesh.triangles[face][c]] = true;
  for (uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const glm::uvec3& t = mesh.triangles[face];
    if (!isNear[t.x] && !isNear[t.y] && !isNear[t.z]) continue;
    const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
    const double doubleArea = glm::length(doubleAreaNormal(a, b, c));
    if (doubleArea < rounding * edgeLengths(mesh, t).longLength) raiseApex(links, mesh, face, rounding);
  }
}

}  // namespace raymap
