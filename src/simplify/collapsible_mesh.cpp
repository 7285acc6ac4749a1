#include "simplify/collapsible_mesh.h"

#include <raymap/error.h>

#include <algorithm>
#include <string>

#include "base/parallel.h"
#include "mesh/half_edges.h"

namespace raymap {

namespace {

[[noreturn]] void refuse(uint32_t vertex, const char* what) {
  throw Error(ErrorCode::Input, "vertex " + std::to_string(vertex) + " " + what +
                                    ": only a watertight, oriented manifold can be simplified; repair the "
                                    "mesh first");
}

}  // namespace

CollapsibleMesh::CollapsibleMesh(const PackedMesh& mesh)
    : corner_(3 * mesh.triangles.size()),
      twin_(corner_.size()),
      outgoing_(mesh.vertices.size(), kNoIndex),
      isDead_(mesh.triangles.size()),
      lastCollapse_(mesh.triangles.size(), kNoIndex),
      places_(mesh.vertices.size()) {
  link(mesh);
}

void CollapsibleMesh::link(const PackedMesh& mesh) {
  constexpr const char* kBadEdge = "has an edge without exactly two faces that agree";
  std::vector<uint32_t> valence(mesh.vertices.size());
  for (auto h = uint32_t(corner_.size()); h-- > 0;) {
    const glm::uvec3& face = mesh.triangles[h / 3];
    const int k = int(h % 3);
    if (face[k] == face[(k + 1) % 3]) refuse(face[k], kBadEdge);
    corner_[h] = face[k];
    outgoing_[face[k]] = h;
    ++valence[face[k]];
  }
  const auto halfEdgeFrom = [&](uint32_t face, uint32_t v) {
    return corner_[3 * face] == v ? 3 * face : corner_[3 * face + 1] == v ? 3 * face + 1 : 3 * face + 2;
  };
  Buffer<SortKey> keys;
  const std::span<const SortKey> halfEdges = sortHalfEdges(mesh, unwelded(mesh.vertices.size()), keys);
  parallelFor(halfEdges.size(), kCheapGrain, [&](size_t begin, size_t end) {
    forEachEdge(halfEdges, begin, end, [&](std::span<const SortKey> edge) {
      const HalfEdge a = halfEdgeOf(edge.front()), b = halfEdgeOf(edge.back());
      if (edge.size() != 2 || a.isForward == b.isForward) refuse(a.low, kBadEdge);
      const uint32_t h = halfEdgeFrom(a.face, a.from()), t = halfEdgeFrom(b.face, b.from());
      twin_[h] = t;
      twin_[t] = h;
    });
  });
  parallelFor(mesh.vertices.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      if (valence[v] == 0) continue;
      uint32_t around = 0, h = outgoing_[v];
      do h = twin_[previous(h)], ++around;
      while (h != outgoing_[v]);
      if (around != valence[v]) refuse(uint32_t(v), "joins two surfaces");
    }
  });
}

bool CollapsibleMesh::findRing(uint32_t v, Ring& ring) const {
  ring.count = 0;
  uint32_t h = outgoing_[v];
  do {
    if (ring.count == kMostValence) return false;
    ring.all[ring.count++] = h;
    h = twin_[previous(h)];
  } while (h != outgoing_[v]);
  return true;
}

uint32_t CollapsibleMesh::addRecords(size_t count) {
  const auto first = uint32_t(records_.size());
  records_.resize(first + count);
  return first;
}

bool CollapsibleMesh::canCollapse(const Ring& ring, const Ring& other) const {
  const uint32_t valence = ring.count + other.count - 4;
  const bool isTetrahedron = ring.count == 3 && other.count == 3;
  if (valence > kMostValence || isTetrahedron) return false;
  // The ends have no neighbours in common but the two that the edge's faces have.
  uint32_t common = 0;
  for (const uint32_t h : other.edges())
    for (const uint32_t g : ring.edges()) common += to(h) == to(g) ? 1 : 0;
  return common == 2;
}

void CollapsibleMesh::touch(const Ring& ring, uint32_t k, uint32_t record) {
  std::vector<Touch>& log = records_[record];
  const uint32_t h = ring.all[k];
  Place& place = places_[from(h)];
  place = {record, uint32_t(log.size()), ring.count + 2, h};
  const auto add = [&](uint32_t face) {
    log.push_back({face, lastCollapse_[face]});
    lastCollapse_[face] = corner_[h];
  };
  for (const uint32_t g : ring.edges()) add(g / 3);
  add(twin_[next(h)] / 3);
  add(twin_[previous(twin_[h])] / 3);
}

void CollapsibleMesh::collapse(const Ring& ring, uint32_t k, uint32_t record) {
  touch(ring, k, record);
  const uint32_t h = ring.all[k], t = twin_[h], end = to(h);
  for (const uint32_t g : ring.edges())
    if (g != h && g != next(t)) corner_[g] = end;
  for (const uint32_t e : {h, t}) {
    const uint32_t a = twin_[next(e)], b = twin_[previous(e)];
    twin_[a] = b;
    twin_[b] = a;
    const uint32_t third = opposite(e);
    outgoing_[third] = corner_[a] == third ? a : b;
    isDead_[e / 3] = 1;
  }
  outgoing_[end] = twin_[previous(h)];
  outgoing_[corner_[h]] = kNoIndex;
}

uint32_t CollapsibleMesh::laterCollapse(uint32_t v) const {
  for (const Touch& touch : touches(v))
    if (lastCollapse_[touch.face] != v) return lastCollapse_[touch.face];
  return kNoIndex;
}

void CollapsibleMesh::restore(uint32_t v) {
  const uint32_t h = places_[v].edge, t = twin_[h], end = to(h);
  const std::span<const Touch> touched = touches(v);
  for (const Touch& touch : touched.first(touched.size() - 2))
    for (uint32_t g = 3 * touch.face; g < 3 * touch.face + 3; ++g)
      if (isDead_[touch.face] == 0 && corner_[g] == end) corner_[g] = v;
  for (const uint32_t e : {h, t}) {
    isDead_[e / 3] = 0;
    twin_[twin_[next(e)]] = next(e);
    twin_[twin_[previous(e)]] = previous(e);
    outgoing_[opposite(e)] = previous(e);
  }
  outgoing_[v] = h;
  outgoing_[end] = t;
  // A face may stand there twice: the first record is the oldest.
  for (size_t k = touched.size(); k-- > 0;) lastCollapse_[touched[k].face] = touched[k].before;
}

}  // namespace raymap
