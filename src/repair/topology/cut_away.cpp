// Cuts a solid at a plane: takes a prism away that has a side in the plane and surrounds all beyond it.

#include "repair/topology/cut_away.h"

#include <raymap/error.h>
#include <raymap/mesh_view.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "mesh/single_origin.h"
#include "repair/topology/unite_parts.h"

namespace raymap {

namespace {

/// Throws unless a mesh has vertices on both sides of a plane.
void requireCut(const Mesh& solid, const Plane& plane) {
  double low = INFINITY, high = -INFINITY;
  for (const glm::uvec3& t : solid.triangles)
    for (int c = 0; c < 3; ++c) {
      const double height = glm::dot(plane.normal, solid.position(t[c]));
      low = std::min(low, height), high = std::max(high, height);
    }
  if (low < plane.offset && plane.offset < high) return;
  throw Error(ErrorCode::Input, "the plane of the cut, at " + numberText(plane.offset, 6) +
                                    ", misses the solid, which reaches from " + numberText(low, 6) + " to " +
                                    numberText(high, 6) + " along its normal");
}

/// Adds the prism, inside out. Its side in the plane is one triangle, so rounded corners do not bend it.
void addPrism(Mesh& mesh, const Plane& plane) {
  const double length = glm::length(plane.normal);
  const glm::dvec3 normal = plane.normal / length, n = glm::abs(normal);
  const Box box = bounds(mesh);
  const double reach = 1.5 * glm::length(box.size());
  const glm::dvec3 centre = box.centre() - mesh.origin;
  // Along an axis, the first term alone is the plane's coordinate.
  const glm::dvec3 foot = normal * (plane.offset / length - glm::dot(normal, mesh.origin)) +
                          (centre - normal * glm::dot(normal, centre));
  const glm::dvec3 aside = n.x <= n.y && n.x <= n.z ? glm::dvec3(1, 0, 0)
                           : n.y <= n.z             ? glm::dvec3(0, 1, 0)
                                                    : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(glm::cross(normal, aside)), v = glm::cross(normal, u);
  const auto first = uint32_t(mesh.vertices.size());
  for (const double height : {0.0, reach})
    for (const glm::dvec2& corner :
         {glm::dvec2(1.0, 0.0), glm::dvec2(-0.5, std::sqrt(0.75)), glm::dvec2(-0.5, -std::sqrt(0.75))})
      mesh.vertices.push_back(
          roundedToSingle(foot + reach * (corner.x * u + corner.y * v) + height * normal));
  const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
    mesh.triangles.emplace_back(first + a, first + b, first + c);
  };
  add(0, 1, 2), add(3, 5, 4);
  for (uint32_t a = 0; a < 3; ++a) {
    const uint32_t b = (a + 1) % 3;
    add(a, b + 3, b), add(a, a + 3, b + 3);
  }
}

}  // namespace

Mesh cutAway(const Mesh& solid, const Plane& plane, std::vector<uint32_t>& sources) {
  requireCut(solid, plane);
  Mesh mesh = solid;
  addPrism(mesh, plane);
  UnitedParts rest = uniteParts(Model(mesh), {.insideOut = InsideOut::Subtracted});
  sources = std::move(rest.sources);
  if (rest.failure == FieldReason::None) return std::move(rest.mesh);
  throw Error(ErrorCode::Unsupported,
              "the cut at " + numberText(plane.offset, 6) + " leaves no sound mesh; move the plane a little");
}

}  // namespace raymap
