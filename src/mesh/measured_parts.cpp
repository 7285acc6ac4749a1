#include "mesh/measured_parts.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/parallel.h"
#include "mesh/disjoint_sets.h"
#include "mesh/part_volumes.h"
#include "mesh/triangle.h"

namespace raymap {

int MeasuredPart::side() const {
  constexpr double kRounding = 1e-9;  // Share of the area to the power of 3/2: less volume may be rounding.
  constexpr double kOpenShare = 0.3;  // Share of the openings in the area of a sheet closed.
  const double openings = glm::length(normal);
  const glm::dvec3 change = glm::abs(normal) * (high - low) / 12.0;
  const double doubt = change.x + change.y + change.z + kRounding * std::pow(area, 1.5);
  if (openings >= kOpenShare * (area + openings) || !(std::abs(volume) > doubt)) return 0;
  return volume > 0.0 ? 1 : -1;
}

bool MeasuredParts::areMixed() const {
  const auto has = [&](int side) {
    return std::ranges::any_of(parts, [side](const MeasuredPart& part) { return part.side() == side; });
  };
  return has(1) && has(-1);
}

MeasuredParts measureParts(const PackedMesh& mesh, std::vector<uint32_t> ofFace, size_t count) {
  MeasuredParts found{std::move(ofFace), std::vector<MeasuredPart>(count)};
  for (uint32_t f = 0; f < found.ofFace.size(); ++f) {
    MeasuredPart& part = found.parts[found.ofFace[f]];
    const auto [a, b, c] = mesh.corners(mesh.triangles[f]);
    const glm::dvec3 normal = doubleAreaNormal(a, b, c);
    part.first = std::min(part.first, f);
    part.low = glm::min(glm::min(part.low, a), glm::min(b, c));
    part.high = glm::max(glm::max(part.high, a), glm::max(b, c));
    part.normal += normal;
    part.area += glm::length(normal);
  }
  const std::vector<double> volumes = partVolumes(mesh, found.ofFace, count);
  for (size_t p = 0; p < count; ++p) {
    MeasuredPart& part = found.parts[p];
    const glm::dvec3 from(mesh.vertices[mesh.triangles[part.first].x]), centre = 0.5 * (part.low + part.high);
    part.volume = volumes[p] - glm::dot(centre - from, part.normal) / 6.0;
  }
  return found;
}

MeasuredParts measureConnectedParts(const PackedMesh& mesh, std::span<const uint32_t> ids) {
  constexpr size_t kFacesPerLink = size_t{1} << 14;
  constexpr uint32_t kUnseen = UINT32_MAX;
  const auto idOf = [&](uint32_t vertex) { return ids.empty() ? vertex : ids[vertex]; };
  const std::span<const glm::uvec3> faces = mesh.triangles;
  DisjointSets sets(mesh.vertices.size());
  parallelFor(faces.size(), kFacesPerLink, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) {
      const uint32_t x = idOf(faces[f].x);
      sets.link(x, idOf(faces[f].y));
      sets.link(x, idOf(faces[f].z));
    }
  });
  const uint32_t first = sets.root(idOf(faces[0].x));
  std::atomic<bool> areSeveral{false};
  parallelFor(faces.size(), kFacesPerLink, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f)
      if (sets.root(idOf(faces[f].x)) != first) areSeveral.store(true, std::memory_order_relaxed);
  });
  if (!areSeveral) return {};
  size_t count = 0;
  std::vector<uint32_t> partAt(mesh.vertices.size(), kUnseen), ofFace(faces.size());
  for (size_t f = 0; f < faces.size(); ++f) {
    uint32_t& part = partAt[sets.root(idOf(faces[f].x))];
    if (part == kUnseen) part = uint32_t(count++);
    ofFace[f] = part;
  }
  return measureParts(mesh, std::move(ofFace), count);
}

}  // namespace raymap
