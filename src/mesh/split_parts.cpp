#include <raymap/split.h>

#include <algorithm>

#include "mesh/disjoint_sets.h"
#include "mesh/half_edges.h"
#include "mesh/model.h"
#include "mesh/part_volumes.h"
#include "mesh/pieces.h"

namespace raymap {

namespace {

/// Rays that tell which closed part a part lies in.
constexpr size_t kRays = 3;

/// Returns the part of each face, numbered in the order of their first faces.
std::vector<uint32_t> connectedParts(const Model& mesh, uint32_t& count) {
  const Buffer<uint32_t>& ids = mesh.welding().ids;
  DisjointSets sets(mesh.vertices.size());
  for (const glm::uvec3& face : mesh.triangles) {
    sets.link(ids[face.x], ids[face.y]);
    sets.link(ids[face.x], ids[face.z]);
  }
  std::vector<uint32_t> numbers(mesh.vertices.size(), UINT32_MAX), parts;
  for (const glm::uvec3& face : mesh.triangles) {
    uint32_t& number = numbers[sets.root(ids[face.x])];
    if (number == UINT32_MAX) number = count++;
    parts.push_back(number);
  }
  return parts;
}

/// Gives cavities the part that they are in. Open parts enclose nothing.
void joinCavities(const Model& mesh, std::vector<uint32_t>& parts, uint32_t count) {
  std::vector<bool> isOpen(count);
  std::vector<uint32_t> partOfVertex(mesh.vertices.size());
  for (size_t f = 0; f < parts.size(); ++f)
    for (int c = 0; c < 3; ++c) partOfVertex[mesh.triangles[f][c]] = parts[f];
  const double size = glm::length(bounds(MeshView(mesh)).size());
  for (const RimEdge& edge : mesh.rims(size / 64.0)) isOpen[partOfVertex[edge.from]] = true;
  std::vector<glm::uvec3> closed;
  Pieces pieces{.pieces = std::vector<Piece>(count)};
  for (size_t f = 0; f < parts.size(); ++f)
    if (!isOpen[parts[f]]) closed.push_back(mesh.triangles[f]), pieces.ids.push_back(parts[f]);
  const PackedMesh closedMesh(mesh.vertices, closed, mesh.origin);
  const std::vector<double> volumes = partVolumes(closedMesh, pieces.ids, count);
  for (uint32_t p = 0; p < count; ++p) pieces.pieces[p].volume = volumes[p];
  if (!closed.empty()) nestPieces(closedMesh, kRays, pieces);
  for (uint32_t& part : parts)
    if (const Piece& piece = pieces.pieces[part]; piece.isCavity() && piece.around != Piece::kNone)
      part = piece.around;
}

}  // namespace

std::vector<std::vector<uint32_t>> splitParts(const MeshView& view) {
  const Model mesh(view);
  validate(mesh);
  uint32_t count = 0;
  std::vector<uint32_t> parts = connectedParts(mesh, count);
  if (count > 1) joinCavities(mesh, parts, count);
  std::vector<std::vector<uint32_t>> faces(count);
  for (uint32_t f = 0; f < parts.size(); ++f) faces[parts[f]].push_back(f);
  std::erase_if(faces, [](const std::vector<uint32_t>& part) { return part.empty(); });
  std::ranges::sort(faces, {}, [](const std::vector<uint32_t>& part) { return part.front(); });
  return faces;
}

}  // namespace raymap
