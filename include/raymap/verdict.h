#pragma once

#include <raymap/diagnostics.h>

#include <cstdint>
#include <optional>

namespace raymap {

/// What kind of thing a mesh is. Where several hold, it is the first of these.
enum class MeshKind : uint8_t {
  NoSurface,          ///< All faces are degenerate.
  DoubleSided,        ///< At least half of the faces are double-sided.
  Soup,               ///< Faces apart: hardly any share edges.
  Sheet,              ///< Open, and most of it too much so to have an inside.
  OpenSolid,          ///< With holes, as scans have, or with loose sheets.
  TurnedFaces,        ///< Closed, but some faces point the other way than their neighbours.
  OverlappingSolids,  ///< Several closed parts with faces that cross.
  CrossingSolid,      ///< One closed part that crosses itself.
  FlawedSolid,        ///< Closed, with non-manifold edges, or with degenerate or duplicate faces.
  InsideOut,          ///< Closed, with all faces inwards.
  SeveralSolids,      ///< Several closed parts with nothing wrong.
  CleanSolid,         ///< One closed part with nothing wrong, or with parts inside that face inwards.
};

/// What makes a clean solid of a mesh.
enum class Remedy : uint8_t {
  None,    ///< Nothing can or need be done.
  Repair,  ///< `repair`.
  Thicken  ///< `generate` with a thickness, then `isosurface`.
};

/// Judgement of a mesh.
struct Verdict {
  MeshKind kind = MeshKind::NoSurface;
  Remedy remedy = Remedy::None;
};

/// Judges a mesh by what `diagnose` and `findSelfIntersections` found. The diagnostics must not be brief.
/// Without crossings, the mesh is taken for one without any.
RAYMAP_API Verdict judge(const Diagnostics& found, const std::optional<SelfIntersections>& crossings);

}  // namespace raymap
