#pragma once

#include <raymap/machine.h>
#include <raymap/mesh_view.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

namespace raymap {

/// A boundary loop: a closed chain of edges with one face. Lengths are in the mesh's units.
struct Hole {
  size_t edges = 0;        ///< Number of edges.
  double length = 0.0;     ///< Length of the loop.
  glm::dvec3 centre{0.0};  ///< Mean of the edges' ends.
  double area = 0.0;       ///< Least area of a surface that closes it: that of its vector area.
  double diameter = 0.0;   ///< Twice the distance from the centre to the farthest vertex.
};

/// Size, topology and defects of a mesh, measured after welding vertices at exactly equal positions.
struct Diagnostics {
  size_t vertices = 0;          ///< Number of vertices as stored.
  size_t weldedVertices = 0;    ///< Number of distinct positions, used by a face or not.
  size_t triangles = 0;         ///< Number of triangles.
  size_t boundaryEdges = 0;     ///< Number of edges with one face.
  size_t nonManifoldEdges = 0;  ///< Number of edges with more than two faces.
  size_t flippedEdges = 0;      ///< Number of edges that two faces use in the same direction.
  size_t flippedFaces =
      0;  ///< Least number of faces to reverse so that neighbours agree; not which side is out.
  std::vector<Hole> holes = {};  ///< Boundary loops, the longest first.
  size_t components = 0;         ///< Number of parts connected through shared vertices.
  /// Number of components with boundary edges. A double-sided mesh counts one side only, as in the next
  /// three.
  size_t openComponents = 0;
  /// Number of closed components with a negative volume: cavities, or inside out.
  size_t inwardComponents = 0;
  /// Number of open components whose holes make up 30 % of their area or more, once closed.
  size_t sheets = 0;
  double sheetShare = 0.0;  ///< Share of the area that is in sheets.
  /// Number of faces with a repeated corner, or lower than 1e-6 of their longest edge.
  size_t degenerateFaces = 0;
  size_t farVertices = 0;  ///< Number of vertices of faces that lie 10^9 sizes of the others away, or more.
  /// Number of faces in groups on the same three corners, as many in one winding order as in the other.
  size_t doubleSidedFaces = 0;
  size_t duplicateFaces = 0;  ///< Number of further faces on the same three corners, either orientation.
  bool watertight = false;    ///< Whether every edge has exactly two faces.
  bool consistentlyOriented = false;  ///< Whether neighbours agree across every edge with two faces.
  bool balanced = false;  ///< Whether every edge is used equally often both ways: winding numbers are whole.
  double signedVolume = 0.0;  ///< Signed volume, in the mesh's units cubed; positive if faces point outwards.
  double area = 0.0;          ///< Area of all triangles, in the mesh's units squared.
  Box bounds = {};            ///< Bounds of the vertices that faces use.
};

/// Returns whether at least half of the faces are double-sided. Open components, inward ones and sheets are
/// then those of one side.
inline bool isDoubleSided(const Diagnostics& found) {
  return found.doubleSidedFaces > 0 && 2 * found.doubleSidedFaces >= found.triangles;
}

/// Options of `diagnose`.
struct DiagnoseOptions {
  bool brief = false;  ///< Leaves out holes, components, sheets and flipped faces: they take longest.
};

/// Measures a mesh. `machine.threads` and `progress` are used. Throws `Error`: Input (see `validate`),
/// Cancelled.
RAYMAP_API Diagnostics diagnose(const MeshView& mesh, const DiagnoseOptions& options = {},
                                const MachineOptions& machine = {});

/// Faces that cross others, so that inner points of the two coincide, and faces that overlap others in one
/// plane. Faces that only touch or share an edge do neither. The test is exact for corners rounded to a
/// lattice of at least 2^29 steps along the longest side.
struct SelfIntersections {
  size_t pairs = 0;                  ///< Number of crossing pairs.
  std::vector<uint32_t> faces = {};  ///< Indices of the faces in them, ascending.
  bool complete = true;              ///< False if the search stopped early: there are at least so many pairs.
  /// Number of pairs that overlap in one plane. Faces on the same three corners are duplicates instead.
  size_t coplanarPairs = 0;
  std::vector<uint32_t> coplanarFaces = {};  ///< Indices of the faces in these pairs, ascending.
};

/// Finds the faces that cross others or overlap them in one plane. Stops early where too many faces overlap.
/// `machine.threads` and `progress` are used. Throws `Error`: Input (see `validate`), Cancelled.
RAYMAP_API SelfIntersections findSelfIntersections(const MeshView& mesh, const MachineOptions& machine = {});

/// How the closed parts of a mesh lie to each other. Parts are faces that are linked through edges. Where
/// several apply, it is the last of these.
enum class Arrangement : uint8_t {
  Unknown,     ///< Some edge has not two faces that agree, a face has a repeated corner, or
               ///< nobody looked.
  Separate,    ///< One part, or parts outside of each other.
  Nested,      ///< Parts in others: cavities in solids, or solids in cavities.
  Misnested,   ///< Parts that face the wrong way for their place: solids in solids, cavities in no solid.
  Touching,    ///< Faces of different parts overlap in one plane.
  Overlapping  ///< Faces of different parts cross, or a part is inside another one and outside, too.
};

/// Returns whether the winding number of a mesh is 0 or 1 everywhere, as far as its parts tell.
inline bool isRight(Arrangement arrangement) {
  return arrangement == Arrangement::Separate || arrangement == Arrangement::Nested;
}

/// Finds how the closed parts of a mesh lie to each other, given what `diagnose` and `findSelfIntersections`
/// found; the diagnostics may be brief. Rays from up to 64 faces of each part find the parts around it.
/// `machine.threads` and `progress` are used. Throws `Error`: Input (see `validate`), Cancelled.
RAYMAP_API Arrangement arrangeParts(const MeshView& mesh, const Diagnostics& found,
                                    const SelfIntersections& crossings, const MachineOptions& machine = {});

/// Kinds of defects.
enum class Defect : uint8_t {
  Hole,             ///< Edges with one face.
  NonManifoldEdge,  ///< Edges with more than two faces.
  CrossedFace,      ///< Faces that cross others, as `findSelfIntersections` finds them.
  FlippedFace,      ///< Faces that point against their neighbours; the least number of them.
  DuplicateFace,    ///< Further faces on the same three corners.
  DoubleSidedFace,  ///< Faces in groups on the same three corners, as many in one winding order as in the
                    ///< other.
  DegenerateFace,   ///< Faces with a repeated corner, or lower than 1e-6 of their longest edge.
};

/// A hole, or edges or faces of one kind that touch each other.
struct DefectPlace {
  glm::dvec3 centre{0.0};  ///< In the mesh's units.
  double diameter = 0.0;   ///< In the mesh's units.
  size_t count = 0;        ///< Number of its edges or faces.
};

/// All defects of one kind in a mesh.
struct DefectList {
  Defect defect = Defect::Hole;
  std::string_view name = {};            ///< Name of the kind, in the plural: "Flipped faces".
  std::vector<uint32_t> faces = {};      ///< Indices of the faces; none if they are edges.
  std::vector<glm::uvec2> edges = {};    ///< Two vertices of each edge; none if they are faces.
  bool complete = true;                  ///< False if the search stopped early: there are at least so many.
  std::vector<DefectPlace> places = {};  ///< Places, the largest first.

  size_t count() const { return faces.size() + edges.size(); }
};

/// Finds where a mesh has defects. Leaves out kinds that it does not have. `machine.threads` and `progress`
/// are used. Throws `Error`: Input (see `validate`), Cancelled.
RAYMAP_API std::vector<DefectList> findDefectPlaces(const MeshView& mesh, const MachineOptions& machine = {});

}  // namespace raymap
