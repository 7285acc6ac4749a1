#pragma once

#include <raymap/mesh.h>
#include <raymap/verdict.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/inverted_parts.h"
#include "mesh/model.h"
#include "repair/topology/fill_holes.h"

namespace raymap {

/// A mesh with nothing wrong that is the union of the parts of another one.
struct UnitedParts {
  Mesh mesh = {};
  size_t cutFaces = 0;          ///< Number of faces that were cut, also to part solids at edges.
  size_t cleanedFaces = 0;      ///< Number of degenerate and repeated faces that were removed.
  size_t sewnVertices = 0;      ///< Number of vertices that went as cracks were closed.
  size_t movedVertices = 0;     ///< Number of vertices that moved so that no faces cross once rounded.
  double thickenedShare = 0.0;  ///< Share of the area that was sheets, which are plates now.
  double buriedShare = 0.0;     ///< Share of the area that lies within the union.
  double lostShare = 0.0;       ///< Share of the area whose sides lie on each other, and that fits nowhere.
  Box lostBounds = {};          ///< Bounds of this area.
  FilledHoles filled = {};      ///< Holes that were closed, and the faces that do.
  InvertedParts inverted = {};  ///< Parts that were inside out, crossed others and were turned.
  std::vector<uint32_t> turned = {};   ///< All faces that were turned, ascending.
  std::vector<uint32_t> sources = {};  ///< Given face that each face is a part of; `kNoTriangle` if none.
  FieldReason failure = FieldReason::None;  ///< Why there is no such mesh.
};

/// Meaning of parts that are inside out.
enum class InsideOut : uint8_t {
  Turned,     ///< For solids; they are turned, those that cross others before anything else.
  Kept,       ///< For solids where they cross no others.
  Subtracted  ///< They take away from the others.
};

struct UniteOptions {
  InsideOut insideOut = InsideOut::Turned;
  bool closesHoles = false;     ///< Whether to close all holes, unless faces contradict each other.
  double sheetThickness = 0.0;  ///< Thickness of the plates of sheets; 0 = there may be no sheets.
  double crack = 0.0;           ///< Width of cracks to join before holes are closed; 0 = `widestCrack`.
};

/// Cuts the faces of a mesh where they cross, overlap or touch, and keeps what bounds the union. If parts may
/// be turned, turns back faces that contradict their part before. Sheets become plates, unless they may bound
/// a solid together or have details finer than their thickness. So do sheets whose other side lies on them,
/// also beside solids; solids of which both sides are there keep one.
UnitedParts uniteParts(const Model& mesh, const UniteOptions& options = {});

}  // namespace raymap
