#pragma once

#include <raymap/diagnostics.h>
#include <raymap/export.h>

#include <cstdint>
#include <optional>

namespace raymap {

/// Kind of a mesh. Where several apply, it is the first of these.
enum class MeshKind : uint8_t {
  NoSurface,          ///< All faces are degenerate.
  DoubleSided,        ///< At least half of the faces are double-sided.
  Soup,               ///< Faces apart: hardly any share edges.
  Sheet,              ///< Open, and most of it too much so to have an inside.
  OpenSolid,          ///< With holes, as scans have, or with loose sheets.
  TurnedFaces,        ///< Closed, but some faces point the other way than their neighbours.
  OverlappingSolids,  ///< Several closed parts, some of which overlap (`Arrangement::Overlapping`).
  TouchingSolids,     ///< Several closed parts, some of which touch in a plane (`Arrangement::Touching`).
  MisnestedSolids,    ///< Several closed parts, some of which face the wrong way for where they lie
                      ///< (`Arrangement::Misnested`).
  CrossingSolid,      ///< A closed part that crosses itself.
  FlawedSolid,        ///< Closed, with non-manifold edges, or with degenerate or duplicate faces.
  InsideOut,          ///< Closed, with all faces inwards.
  SeveralSolids,      ///< Several closed parts with nothing wrong.
  CleanSolid,         ///< One closed part with nothing wrong, or with parts inside that face inwards.
};

/// Command that makes a clean solid of a mesh.
enum class Remedy : uint8_t {
  None,    ///< Nothing can or need be done.
  Repair,  ///< `repair`.
  Thicken  ///< `generate` with a thickness, then `isosurface`.
};

/// How deeply a repair changed a mesh.
enum class RepairDepth : uint8_t {
  AsGiven,  ///< All faces are as they were: nothing was wrong. Small parts may be left out.
  Mended,   ///< Only wrong faces were changed, or cut where they cross others. The others are as they were.
  Field     ///< All faces are new, the isosurface of a field.
};

/// Why a repair needed a field.
enum class FieldReason : uint8_t {
  None,     ///< It did not.
  Asked,    ///< Options ask for new faces or for another shape.
  Open,     ///< Faces do not bound a solid, even with holes closed and faces reversed.
  Sheet,    ///< Most of it is sheets, open surface without an inside; or sheets may get no thickness.
  Crossing  ///< Parts that cross, overlap or touch could not be united exactly.
};

/// Kind of thing that a mesh is, and what makes a clean solid of it.
struct Verdict {
  MeshKind kind = MeshKind::NoSurface;             ///< Kind of the mesh.
  Remedy remedy = Remedy::None;                    ///< Command that makes a clean solid of it.
  Arrangement arrangement = Arrangement::Unknown;  ///< How its closed parts lie to each other.
  double sought = 0.0;  ///< Thickness up to which thin parts were looked for; 0 = it was not measured.
  /// Thickness of the thinnest part, in the mesh's units. Nothing if no part is thinner than `sought`.
  std::optional<double> thinnest = {};
  /// Largest distance between samples that keeps that part: half of it, rounded down to two digits.
  std::optional<double> voxelSize = {};
  /// Thickness that suits a sheet: a fiftieth of its longest side, in one digit. 0 = it is none.
  double thickness = 0.0;
};

/// Returns whether the parts of a mesh have a thickness: it bounds a solid, however wrongly.
inline bool hasThickness(const Verdict& verdict) {
  return verdict.kind != MeshKind::NoSurface && verdict.remedy != Remedy::Thicken;
}

/// Judges a mesh by what `diagnose` and `findSelfIntersections` found, without its thickness. The diagnostics
/// must not be brief. Without crossings, the mesh is taken for one without any. `arrangement` comes from
/// `arrangeParts`; unknown, closed parts are taken for apart unless faces cross.
RAYMAP_API Verdict judge(const Diagnostics& found, const std::optional<SelfIntersections>& crossings,
                         Arrangement arrangement = Arrangement::Unknown);

}  // namespace raymap
