#include "repair/collapsible_mesh.h"

#include <raymap/error.h>

#include <algorithm>
#include <string>

#include "base/parallel.h"

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
  const size_t vertices = mesh.vertices.size();
  std::vector<uint32_t> start(vertices + 2), edges(corner_.size());
  for (uint32_t h = 0; h < corner_.size(); ++h) {
    corner_[h] = mesh.triangles[h / 3][int(h % 3)];
    ++start[corner_[h] + 2];
  }
  for (size_t v = 2; v < start.size(); ++v) start[v] += start[v - 1];
  for (uint32_t h = 0; h < corner_.size(); ++h) edges[start[corner_[h] + 1]++] = h;
  const auto leaving = [&](uint32_t v) {
    return std::span(edges).subspan(start[v], start[v + 1] - start[v]);
  };
  const auto linkVertex = [&](uint32_t v) {
    for (const uint32_t h : leaving(v)) {
      uint32_t twins = 0;
      for (const uint32_t t : leaving(to(h)))
        if (to(t) == v) ++twins, twin_[h] = t;
      const auto same = std::ranges::count_if(leaving(v), [&](uint32_t other) { return to(other) == to(h); });
      if (to(h) == v || twins != 1 || same != 1)
        refuse(v, "has an edge without exactly two faces that agree");
    }
  };
  const auto checkVertex = [&](uint32_t v) {
    if (leaving(v).empty()) return;
    outgoing_[v] = leaving(v).front();
    size_t around = 0;
    uint32_t h = outgoing_[v];
    do h = twin_[previous(h)], ++around;
    while (h != outgoing_[v]);
    if (around != leaving(v).size()) refuse(v, "joins two surfaces");
  };
  const auto forEachVertex = [&](const auto& work) {
    constexpr size_t kVerticesPerTask = size_t{1} << 14;
    parallelFor(vertices, kVerticesPerTask, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) work(uint32_t(v));
    });
  };
  forEachVertex(linkVertex);
  forEachVertex(checkVertex);
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
