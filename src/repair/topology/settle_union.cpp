#include "repair/topology/settle_union.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mesh/diagnostics.h"
#include "mesh/triangle.h"
#include "repair/topology/clean_faces.h"
#include "repair/topology/mend.h"
#include "repair/topology/part_edges.h"

namespace raymap {

namespace {

/// Unites a mesh until no faces cross. Degenerate faces may stay with `keepsNeedles`. Returns the faces of
/// the mesh whose parts crossed others first, if it does not end.
std::vector<uint32_t> settle(const Mesh& closed, bool mayTurn, bool keepsNeedles, SettledUnion& settled) {
  constexpr int kMostRounds = 4;        // New vertices are rounded, so that faces may cross again.
  constexpr double kSameVolume = 1e-3;  // Share of the volume that rounding and cleaning may change.
  std::vector<uint32_t> crossed;
  size_t pairs = SIZE_MAX;  // Of crossing faces, after the round before.
  settled.mesh = closed;
  settled.partedFaces = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    std::optional<UnitedFaces> cut = uniteFaces(Model(settled.mesh), mayTurn);
    if (!cut) break;
    if (cut->mesh.triangles.empty()) {
      if (round == 0) settled.exact = std::move(*cut);
      break;
    }
    CleanedFaces cleaned =
        cleanFaces(Model(cut->mesh), keepsNeedles ? Cleaning::Repeated : Cleaning::Rounded);
    for (uint32_t& f : cleaned.given) f = round == 0 ? cut->sources[f] : settled.sources[cut->sources[f]];
    settled.sources = std::move(cleaned.given);
    settled.mesh = std::move(cleaned.mesh);
    if (settled.exact.mesh.triangles.empty()) settled.exact = std::move(*cut);
    settled.partedFaces += partEdges(settled.mesh, settled.sources);
    if (!keepsNeedles) raiseDegenerate(settled.mesh);
    SelfIntersections crossing;
    if (!isAllRight(Model(settled.mesh), &crossing, keepsNeedles)) {
      if (crossed.empty()) crossed = facesOf(crossing.faces, settled.sources);
      if (crossing.pairs > pairs) break;  // Rounding makes ever more.
      pairs = crossing.pairs;
      if (keepsNeedles) continue;
      raiseLowFaces(settled.mesh, crossing.faces);
      if (!isAllRight(Model(settled.mesh))) continue;
    }
    const double made = diagnose(settled.mesh, {.brief = true}).signedVolume;
    settled.isRight = std::abs(made - settled.exact.volume) <= kSameVolume * settled.exact.volume;
    return {};
  }
  return crossed;
}

/// Moves the corners of faces along their normals: farther in every attempt up to a limit, but the same in
/// every run. Marks them in `haveMoved`.
void moveCorners(Mesh& mesh, const std::vector<uint32_t>& faces, uint32_t attempt,
                 std::vector<bool>& haveMoved) {
  constexpr double kLeast = 2e-6;  // Share of the size: more than rounding, less than anybody sees.
  constexpr uint32_t kMostDoublings = 4;
  const glm::dvec3 size = bounds(mesh).size();
  const double most =
      std::ldexp(kLeast, int(std::min(attempt, kMostDoublings))) * std::max({size.x, size.y, size.z});
  std::vector<bool> moves(mesh.vertices.size());
  for (const uint32_t f : faces)
    for (int c = 0; c < 3; ++c) moves[mesh.triangles[f][c]] = true;
  std::vector<glm::dvec3> normals(mesh.vertices.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c)
      if (moves[t[c]])
        normals[t[c]] += doubleAreaNormal(glm::dvec3(mesh.vertices[t.x]), glm::dvec3(mesh.vertices[t.y]),
                                          glm::dvec3(mesh.vertices[t.z]));
  for (uint32_t v = 0; v < moves.size(); ++v) {
    if (!moves[v] || !(glm::length(normals[v]) > 0.0)) continue;
    const double share = double((v * 16u + attempt) * 2654435761u) * 0x1p-31 - 1.0;
    mesh.vertices[v] += glm::vec3(share * most * glm::normalize(normals[v]));
    haveMoved[v] = true;
  }
}

/// Unites a mesh, and moves corners of faces that cross.
SettledUnion settleMoving(Mesh closed, bool mayTurn, bool keepsNeedles) {
  constexpr uint32_t kMostAttempts = 8;
  // With a larger share of crossing faces, moved ones only cross elsewhere, which takes long in large meshes.
  constexpr size_t kShare = 16, kFew = 256;
  SettledUnion settled;
  std::vector<bool> haveMoved(closed.vertices.size());
  for (uint32_t attempt = 0; attempt < kMostAttempts; ++attempt) {
    const std::vector<uint32_t> crossed = settle(closed, mayTurn, keepsNeedles, settled);
    if (crossed.empty() || crossed.size() > std::max(closed.triangles.size() / kShare, kFew)) break;
    moveCorners(closed, crossed, attempt, haveMoved);
  }
  settled.movedVertices = size_t(std::ranges::count(haveMoved, true));
  return settled;
}

}  // namespace

SettledUnion settleUnion(Mesh closed, bool mayTurn) {
  SettledUnion settled = settleMoving(closed, mayTurn, false);
  if (!settled.isRight && diagnose(closed, {.brief = true}).degenerateFaces > 0)
    settled = settleMoving(std::move(closed), mayTurn, true);
  return settled;
}

}  // namespace raymap
