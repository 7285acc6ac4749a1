#include "mesh/inverted_parts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/progress.h"
#include "mesh/disjoint_sets.h"
#include "mesh/measured_parts.h"
#include "mesh/patches.h"
#include "mesh/self_intersections.h"
#include "mesh/triangle.h"
#include "mesh/weld.h"
#include "predicates/line_triangle.h"

namespace raymap {

namespace {

constexpr uint32_t kNone = UINT32_MAX;
/// Share of its diagonal by which a part is shrunk, so that parts that touch do not cross.
constexpr double kHair = 1e-5;

/// Measures the parts of a mesh. Patches that end unevenly at an edge of more than two faces belong together:
/// a part ends nowhere but at holes.
MeasuredParts partsOf(const PackedMesh& mesh, Patches patches, std::span<const SortKey> halfEdges) {
  DisjointSets sets(patches.count);
  std::vector<std::pair<uint32_t, int>> sides;  // The patch of each half edge, and its direction.
  forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
    if (edge.size() < 3) return;
    sides.clear();
    for (const SortKey& key : edge) {
      const HalfEdge side = halfEdgeOf(key);
      sides.emplace_back(patches.ids[side.face], side.isForward ? 1 : -1);
    }
    std::ranges::sort(sides);
    uint32_t uneven = kNone;
    for (size_t s = 0; s < sides.size();) {
      const uint32_t patch = sides[s].first;
      int sum = 0;
      for (; s < sides.size() && sides[s].first == patch; ++s) sum += sides[s].second;
      if (sum != 0 && uneven != kNone) sets.link(uneven, patch);
      if (sum != 0) uneven = patch;
    }
  });
  std::vector<uint32_t> numbers(patches.count, kNone);
  uint32_t count = 0;
  for (uint32_t& id : patches.ids) {
    uint32_t& number = numbers[sets.root(id)];
    if (number == kNone) number = count++;
    id = number;
  }
  return measureParts(mesh, std::move(patches.ids), count);
}

/// Forms of a part to search for crossings: none, as given, shrunk by a hair, or both.
using Forms = uint8_t;
constexpr Forms kGiven = 1, kShrunk = 2;

/// Parts in the forms that are asked for, with faces and vertices of their own.
struct FormedParts {
  std::vector<glm::vec3> vertices;
  std::vector<glm::uvec3> faces;
  std::vector<uint32_t> parts;  ///< Part of each face.
  size_t firstShrunk = 0;       ///< Faces from this one on are shrunk.

  bool isShrunk(uint32_t face) const { return face >= firstShrunk; }
};

class PartFormer {
 public:
  PartFormer(const Model& mesh, const MeasuredParts& found, const std::vector<Forms>& forms)
      : mesh_(mesh), found_(found), forms_(forms), vertexAt_(mesh.welding().count, kNone) {}

  FormedParts form() {
    for (uint32_t f = 0; f < found_.ofFace.size(); ++f)
      if (forms_[found_.ofFace[f]] != 0) given_.push_back(f);
    std::ranges::stable_sort(given_, {}, [&](uint32_t f) { return found_.ofFace[f]; });
    for (const uint32_t f : given_) addCorners(f);
    const auto count = uint32_t(formed_.vertices.size());
    for (uint32_t v = 0; v < count; ++v) formed_.vertices.push_back(shrunk(v));
    addFaces(kGiven, 0);
    formed_.firstShrunk = formed_.faces.size();
    addFaces(kShrunk, count);
    return std::move(formed_);
  }

 private:
  /// Gives a face vertices of its part, and adds its normal to theirs.
  void addCorners(uint32_t face) {
    const auto [a, b, c] = mesh_.corners(mesh_.triangles[face]);
    const glm::dvec3 normal = unitNormal(a, b, c);
    const glm::uvec3 welded = weldedFace(mesh_, mesh_.welding(), face);
    glm::uvec3 corners;
    for (int k = 0; k < 3; ++k) {
      corners[k] = vertexOf(welded[k], mesh_.triangles[face][k], found_.ofFace[face]);
      normals_[corners[k]] += normal;
    }
    corners_.push_back(corners);
  }

  /// Returns the vertex of a part at a position. All faces of a part follow one another.
  uint32_t vertexOf(uint32_t position, uint32_t vertex, uint32_t part) {
    uint32_t& at = vertexAt_[position];
    if (at == kNone || partOf_[at] != part) {
      at = uint32_t(partOf_.size());
      partOf_.push_back(part);
      normals_.emplace_back(0.0);
      formed_.vertices.push_back(mesh_.vertices[vertex]);
    }
    return at;
  }

  glm::vec3 shrunk(uint32_t vertex) const {
    const MeasuredPart& part = found_.parts[partOf_[vertex]];
    const double length = glm::length(normals_[vertex]),
                 step = kHair * glm::distance(part.low, part.high) * part.side();
    const glm::dvec3 inward = length > 0.0 ? normals_[vertex] * (-step / length) : glm::dvec3(0.0);
    return glm::vec3(glm::dvec3(formed_.vertices[vertex]) + inward);
  }

  void addFaces(Forms form, uint32_t firstVertex) {
    for (size_t f = 0; f < given_.size(); ++f) {
      const uint32_t part = found_.ofFace[given_[f]];
      if ((forms_[part] & form) == 0) continue;
      formed_.faces.push_back(corners_[f] + firstVertex);
      formed_.parts.push_back(part);
    }
  }

  const Model& mesh_;
  const MeasuredParts& found_;
  const std::vector<Forms>& forms_;
  std::vector<uint32_t> given_;      // The faces, part by part.
  std::vector<glm::uvec3> corners_;  // New vertices of each.
  std::vector<uint32_t> vertexAt_;   // Last vertex that was made at each position.
  std::vector<uint32_t> partOf_;     // Part of each new vertex.
  std::vector<glm::dvec3> normals_;
  FormedParts formed_;
};

/// Parts that cross, linked.
struct LinkedParts {
  DisjointSets sets;
  bool areMixed = false;  ///< Whether two that face different ways cross.
};

/// Finds which parts cross. Of two parts the smaller one is shrunk, so that it lies within the larger one, or
/// beside it, where it only touches.
LinkedParts linkCrossing(const Model& mesh, const MeasuredParts& found, const std::vector<Forms>& forms) {
  const FormedParts formed = PartFormer(mesh, found, forms).form();
  const auto sizeOf = [&](uint32_t part) { return std::pair(std::abs(found.parts[part].volume), part); };
  LinkedParts linked{DisjointSets(found.parts.size())};
  const auto visit = [&](const FacePair& pair) {
    if (pair.isInPlane || formed.isShrunk(pair.a) == formed.isShrunk(pair.b)) return;
    auto [small, large] = std::pair(formed.parts[pair.a], formed.parts[pair.b]);
    if (formed.isShrunk(pair.b)) std::swap(small, large);
    if (sizeOf(small) >= sizeOf(large)) return;
    linked.sets.link(small, large);
    if (found.parts[small].side() != found.parts[large].side()) linked.areMixed = true;
  };
  Progress silent;
  if (!formed.faces.empty()) forEachMeetingPair({formed.vertices, formed.faces, mesh.origin}, visit, silent);
  return linked;
}

/// Returns the forms in which each part may cross one that faces the other way.
std::vector<Forms> possibleForms(const std::vector<MeasuredPart>& parts) {
  struct All {
    MeasuredPart bounds;
    double least = INFINITY, most = 0.0;  // of their volumes
  };
  All all[3];  // Those that point inwards, enclose nothing, and point outwards.
  for (const MeasuredPart& part : parts) {
    auto& [bounds, least, most] = all[part.side() + 1];
    bounds.low = glm::min(bounds.low, part.low);
    bounds.high = glm::max(bounds.high, part.high);
    least = std::min(least, std::abs(part.volume));
    most = std::max(most, std::abs(part.volume));
  }
  std::vector<Forms> forms(parts.size());
  for (size_t p = 0; p < parts.size(); ++p) {
    const int side = parts[p].side();
    const All& other = all[1 - side];
    if (side == 0 || !parts[p].meets(other.bounds)) continue;
    const double volume = std::abs(parts[p].volume);
    forms[p] = Forms((volume >= other.least ? kGiven : 0) | (volume <= other.most ? kShrunk : 0));
  }
  return forms;
}

/// Returns the parts to turn: those of a linked set that do not face as its largest part.
std::vector<bool> chooseTurned(const MeasuredParts& found, DisjointSets& sets) {
  const std::vector<MeasuredPart>& parts = found.parts;
  std::vector<uint32_t> largest(parts.size(), kNone);
  for (uint32_t p = 0; p < parts.size(); ++p) {
    uint32_t& of = largest[sets.root(p)];
    if (of == kNone || std::abs(parts[p].volume) > std::abs(parts[of].volume)) of = p;
  }
  std::vector<bool> turned(parts.size());
  for (uint32_t p = 0; p < parts.size(); ++p)
    turned[p] = parts[p].side() * parts[largest[sets.root(p)]].side() < 0;
  return turned;
}

/// Returns a point inside a part, a hair below its first face.
glm::dvec3 pointIn(const PackedMesh& mesh, const MeasuredPart& part) {
  const auto [a, b, c] = mesh.corners(mesh.triangles[part.first]);
  return (a + b + c) / 3.0 - unitNormal(a, b, c) * (part.side() * kHair * glm::distance(part.low, part.high));
}

/// Returns whether a part encloses a point, by the crossings of a line upwards.
bool encloses(const PackedMesh& mesh, const MeasuredParts& found, uint32_t part, const glm::dvec3& p) {
  int sum = 0;
  for (size_t f = 0; f < found.ofFace.size(); ++f) {
    if (found.ofFace[f] != part) continue;
    const auto [a, b, c] = mesh.corners(mesh.triangles[f]);
    const auto [side, weights] = passLine(glm::dvec2(a - p), glm::dvec2(b - p), glm::dvec2(c - p));
    const glm::dvec3 heights(a.z - p.z, b.z - p.z, c.z - p.z);
    if (side != 0 && glm::dot(weights, heights) / (weights.x + weights.y + weights.z) > 0.0) sum += side;
  }
  return sum != 0;
}

/// Turns what lies within a turned part along with it: its cavities stay cavities.
void turnEnclosed(const PackedMesh& mesh, const MeasuredParts& found, DisjointSets& sets,
                  std::vector<bool>& turned) {
  const std::vector<bool> outer = turned;
  for (uint32_t p = 0; p < outer.size(); ++p) {
    if (!outer[p]) continue;
    const MeasuredPart& around = found.parts[p];
    for (uint32_t q = 0; q < outer.size(); ++q) {
      const MeasuredPart& part = found.parts[q];
      if (part.side() == 0 || sets.root(q) == sets.root(p) || glm::any(glm::lessThan(part.low, around.low)) ||
          glm::any(glm::greaterThan(part.high, around.high)))
        continue;
      if (encloses(mesh, found, p, pointIn(mesh, part))) turned[q] = !turned[q];
    }
  }
}

}  // namespace

bool mayHaveInvertedParts(const PackedMesh& mesh) {
  MeasuredParts found = measureConnectedParts(mesh);
  const auto isClosed = [](const MeasuredPart& part) { return part.side() != 0; };
  if (found.areMixed() || std::ranges::all_of(found.parts, isClosed)) return found.areMixed();
  // Open parts may belong together: vertices of a part may share positions with those of others.
  return measureConnectedParts(mesh, weldVertices(mesh.vertices).ids).areMixed();
}

InvertedParts findInvertedParts(const PackedMesh& given) {
  const Model mesh(given);
  const MeasuredParts found = partsOf(mesh, findPatches(mesh), mesh.halfEdges());
  if (!found.areMixed() || !linkCrossing(mesh, found, possibleForms(found.parts)).areMixed) return {};
  std::vector<Forms> all(found.parts.size());
  for (size_t p = 0; p < all.size(); ++p) all[p] = found.parts[p].side() != 0 ? kGiven | kShrunk : 0;
  LinkedParts linked = linkCrossing(mesh, found, all);
  std::vector<bool> turned = chooseTurned(found, linked.sets);
  InvertedParts inverted;
  for (size_t p = 0; p < turned.size(); ++p)
    if (turned[p]) inverted.firsts.push_back(found.parts[p].first);
  std::ranges::sort(inverted.firsts);
  turnEnclosed(mesh, found, linked.sets, turned);
  for (uint32_t f = 0; f < found.ofFace.size(); ++f)
    if (turned[found.ofFace[f]]) inverted.faces.push_back(f);
  return inverted;
}

}  // namespace raymap
