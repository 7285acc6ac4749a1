#include "mesh/components.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "mesh/face_measures.h"

namespace raymap {

namespace {

constexpr double kSheetShare =
    0.3;  // Least share of the holes in the area of a sheet closed. A half sphere: 1/3.
constexpr double kNoVolume = 1e-9;  // Share of the area to the power of 3/2: less may be rounding.

/// A component's area and volume, and the area that closes its holes.
struct Measure {
  double area = 0.0, volume = 0.0, holeArea = 0.0;
  bool isOpen = false;

  bool isSheet() const { return isOpen && holeArea >= kSheetShare * (area + holeArea); }
  bool isInward() const { return !isOpen && volume < -kNoVolume * std::pow(area, 1.5); }
};

/// Calls `work(face, measure, component)` for each face with an area.
template <class Work>
void forEachFaceOf(const Model& mesh, const glm::dvec3& centre, Components& components, Work&& work) {
  forEachFaceMeasure(mesh, centre, [&](size_t face, const FaceMeasure& measure) {
    if (measure.isSurface)
      work(face, measure, components.componentOf(mesh.welding().ids[mesh.triangles[face].x]));
  });
}

/// Adds each face to its component.
void addFaces(const Model& mesh, const glm::dvec3& centre, Components& components,
              std::span<Measure> measures) {
  forEachFaceOf(mesh, centre, components, [&](size_t, const FaceMeasure& measure, uint32_t component) {
    measures[component].area += measure.area;
    measures[component].volume += measure.volume;
  });
}

void addHoles(Components& components, std::span<const TracedHole> holes, std::span<Measure> measures) {
  for (const TracedHole& hole : holes) {
    Measure& m = measures[components.componentOf(hole.position)];
    m.holeArea += hole.hole.area;
    m.isOpen = true;
  }
}

/// Returns whether the normals of faces add up to nearly nothing, and the faces enclose a volume.
bool encloseVolume(const PackedMesh& mesh, std::span<const uint32_t> faces) {
  constexpr double kGap = 0.03;     // Share of the area. The sum of all normals is the area of the gaps.
  constexpr double kVolume = 0.01;  // Share of the area to the power of 3/2. A ball has 0.09.
  double area = 0.0, volume = 0.0;
  glm::dvec3 normals(0.0), centre(0.0);
  for (const uint32_t face : faces) {
    const auto [a, b, c] = mesh.corners(mesh.triangles[face]);
    const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
    const double faceArea = glm::length(normal);
    area += faceArea;
    volume += glm::dot(a, normal) / 3.0;
    normals += normal;
    centre += faceArea / 3.0 * (a + b + c);
  }
  if (area == 0.0) return false;
  volume -= glm::dot(centre / area, normals) / 3.0;  // As seen from the centre.
  return glm::length(normals) <= kGap * area && std::abs(volume) >= kVolume * std::pow(area, 1.5);
}

}  // namespace

Components::Components(const Model& mesh) : sets_(mesh.welding().count) {
  const std::span<const SortKey> halfEdges = mesh.halfEdges();
  const size_t positions = mesh.welding().count;
  std::vector<uint8_t> isLinked(positions, 0);  // Whether another position was linked to this one.
  parallelFor(halfEdges.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      if (k > 0 && halfEdges[k].high == halfEdges[k - 1].high) continue;
      const HalfEdge edge = halfEdgeOf(halfEdges[k]);
      if (const auto root = sets_.link(edge.low, edge.high))
        std::atomic_ref(isLinked[*root]).store(1, std::memory_order_relaxed);
    }
  });
  for (uint32_t p = 0; p < positions; ++p)
    if (isLinked[p] != 0 && sets_.root(p) == p) roots_.push_back(p);
}

uint32_t Components::componentOf(uint32_t position) {
  return uint32_t(std::lower_bound(roots_.begin(), roots_.end(), sets_.root(position)) - roots_.begin());
}

void measureComponents(const Model& mesh, Components& components, std::span<const TracedHole> holes,
                       Diagnostics& found) {
  std::vector<Measure> measures(components.count());
  if (measures.size() == 1)
    measures[0] = {.area = found.area, .volume = found.signedVolume};
  else
    addFaces(mesh, found.bounds.centre() - mesh.origin, components, measures);
  addHoles(components, holes, measures);
  double sheetArea = 0.0;
  for (const Measure& m : measures) {
    found.openComponents += m.isOpen ? 1 : 0;
    found.inwardComponents += m.isInward() ? 1 : 0;
    found.sheets += m.isSheet() ? 1 : 0;
    sheetArea += m.isSheet() ? m.area : 0.0;
  }
  found.sheetShare = found.area > 0.0 ? sheetArea / found.area : 0.0;
}

SheetFaces findSheets(const Model& mesh, Components& components, std::span<const TracedHole> holes) {
  std::vector<Measure> measures(components.count());
  addFaces(mesh, {}, components, measures);
  addHoles(components, holes, measures);
  SheetFaces sheets;
  forEachFaceOf(mesh, {}, components, [&](size_t face, const FaceMeasure&, uint32_t component) {
    if (measures[component].isSheet()) sheets.faces.push_back(uint32_t(face));
  });
  Measure largest;
  double area = 0.0;
  for (const Measure& m : measures) {
    area += m.area;
    if (m.isSheet() && m.area > largest.area) largest = m;
  }
  sheets.boundSolid = encloseVolume(mesh, sheets.faces);
  sheets.mayBoundSolid = !sheets.faces.empty() && area - largest.area >= largest.holeArea;
  return sheets;
}

}  // namespace raymap
