#include <raymap/words.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/text.h"

namespace raymap {

namespace {

std::string verb(size_t count, const char* one, const char* many) {
  return count == 1 ? one : many;
}

/// Returns "a clean solid" or "3 clean, separate solids", with the closed parts that face inwards.
std::string nameSolids(const Diagnostics& found) {
  const size_t inward = found.inwardComponents, outward = found.components - inward;
  std::string words = outward == 1 ? "a clean solid" : grouped(outward) + " clean, separate solids";
  if (inward > 0)
    words += " and " + (inward == 1 ? "a cavity" : grouped(inward) + " cavities") + " (" +
             counted(inward, "closed part") + verb(inward, " that faces", " that face") + " inwards)";
  return words;
}

std::string pairsOf(const SelfIntersections& crossings, size_t pairs) {
  return (crossings.complete ? "" : "at least ") + counted(pairs, "pair") + " of faces";
}

/// Returns how the closed parts of a mesh overlap or touch.
std::string describeMeeting(const SelfIntersections& crossings) {
  if (crossings.pairs > 0) return ": " + pairsOf(crossings, crossings.pairs) + " cross";
  if (crossings.coplanarPairs > 0)
    return ": " + pairsOf(crossings, crossings.coplanarPairs) + " overlap in one plane";
  return "";
}

std::string describeMisnested(const Diagnostics& found) {
  if (found.inwardComponents == 0) return ", solids in solids: none faces inwards, as a cavity does";
  return ", some of which face the wrong way: solids in solids, or cavities outside of solids";
}

std::string describeHoles(const Diagnostics& found) {
  const auto widest = std::max_element(found.holes.begin(), found.holes.end(),
                                       [](const Hole& a, const Hole& b) { return a.diameter < b.diameter; });
  return counted(found.holes.size(), "hole") + (found.holes.size() == 1 ? ", " : "; the widest is ") +
         rounded(widest->diameter) + " wide";
}

/// Returns what is open besides solids: holes in them, and sheets that lie loose.
std::string describeOpen(const Diagnostics& found) {
  const std::string sheets = found.sheets == 0
                                 ? ""
                                 : grouped(found.sheets) + " of its " + counted(found.components, "part") +
                                       verb(found.sheets, " is a sheet", " are sheets");
  if (found.sheets == found.openComponents) return "a solid with loose sheets: " + sheets;
  return "a solid with holes, as scans have: " + describeHoles(found) + (sheets.empty() ? "" : "; " + sheets);
}

/// Returns the end of "This is …".
std::string nameKind(MeshKind kind, const Diagnostics& found,
                     const std::optional<SelfIntersections>& crossings) {
  const std::string parts = counted(found.components, "closed part");
  switch (kind) {
    case MeshKind::NoSurface:
      return "no surface: all faces are degenerate";
    case MeshKind::DoubleSided:
      return "a double-sided model: " + grouped(found.doubleSidedFaces) + " of its " +
             counted(found.triangles, "face") + " lie back to back" +
             (found.sheetShare > 0.5 ? ", and bound nothing" : "");
    case MeshKind::Soup:
      return "a soup of faces: most of them share no edge with another one";
    case MeshKind::Sheet:
      return "a sheet: an open surface without a definite inside";
    case MeshKind::OpenSolid:
      return describeOpen(found);
    case MeshKind::TurnedFaces:
      return "a closed surface, but " + counted(found.flippedFaces, "face") +
             verb(found.flippedFaces, " points", " point") + " the wrong way";
    case MeshKind::OverlappingSolids:
      return parts + " that overlap" + describeMeeting(*crossings);
    case MeshKind::TouchingSolids:
      return parts + " that touch" + describeMeeting(*crossings);
    case MeshKind::MisnestedSolids:
      return parts + describeMisnested(found);
    case MeshKind::CrossingSolid:
      return (found.components == 1 ? "a closed solid that crosses itself: "
                                    : parts + ", one of which crosses itself: ") +
             pairsOf(*crossings, crossings->pairs);
    case MeshKind::FlawedSolid:
      return (found.components == 1 ? "a closed solid" : parts) +
             " with small faults: " + describeDefects(found, crossings);
    case MeshKind::InsideOut:
      return (found.components == 1 ? "a solid" : parts) + " turned inside out";
    case MeshKind::SeveralSolids:
    case MeshKind::CleanSolid:
      return nameSolids(found) + ", with nothing wrong";
  }
  return {};
}

/// Returns what else is wrong with a mesh of a kind.
std::string describeRest(MeshKind kind, const Diagnostics& found,
                         const std::optional<SelfIntersections>& crossings) {
  std::vector<std::string> rest;
  if (found.flippedFaces > 0 && kind != MeshKind::TurnedFaces)
    rest.push_back(counted(found.flippedFaces, "reversed face"));
  if (crossings && crossings->pairs > 0 && kind != MeshKind::OverlappingSolids &&
      kind != MeshKind::CrossingSolid)
    rest.push_back(pairsOf(*crossings, crossings->pairs) + " that cross");
  const bool isNamed =
      kind == MeshKind::TouchingSolids || (kind == MeshKind::OverlappingSolids && crossings->pairs == 0);
  if (crossings && crossings->coplanarPairs > 0 && !isNamed)
    rest.push_back(pairsOf(*crossings, crossings->coplanarPairs) + " that overlap in one plane");
  if (found.nonManifoldEdges > 0 && kind != MeshKind::DoubleSided && kind != MeshKind::FlawedSolid)
    rest.push_back(counted(found.nonManifoldEdges, "edge") + " with more than two faces");
  std::string words;
  for (size_t r = 0; r < rest.size(); ++r)
    words += (r == 0 ? "It also has " : r + 1 < rest.size() ? ", " : " and ") + rest[r];
  return words.empty() ? "" : words + ".";
}

}  // namespace

std::string grouped(size_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (size_t d = 0; d < digits.size(); ++d) {
    if (d > 0 && (digits.size() - d) % 3 == 0) text += ',';
    text += digits[d];
  }
  return text;
}

std::string counted(size_t number, const std::string& thing) {
  return grouped(number) + " " + thing + (number == 1 ? "" : "s");
}

std::string rounded(double number) {
  return number >= 1000.0 && number < 1e12 ? grouped(size_t(std::llround(number))) : numberText(number, 3);
}

std::string describeDefects(const Diagnostics& found, const std::optional<SelfIntersections>& crossings) {
  const std::array<std::pair<size_t, const char*>, 7> defects{
      {{found.boundaryEdges, "boundary edge"},
       {found.nonManifoldEdges, "non-manifold edge"},
       {found.flippedEdges, "flipped edge"},
       {found.degenerateFaces, "degenerate face"},
       {found.farVertices, "far point"},
       {found.duplicateFaces, "duplicate face"},
       {found.doubleSidedFaces, "double-sided face"}}};
  std::string text;
  for (const auto& [count, name] : defects)
    if (count > 0) text += (text.empty() ? "" : ", ") + counted(count, name);
  if (crossings && crossings->pairs > 0)
    text += (text.empty() ? "" : ", ") + std::string(crossings->complete ? "" : "at least ") +
            counted(crossings->pairs, "crossing pair") + " of faces";
  if (text.empty()) return crossings ? "nothing" : "nothing (faces that cross were not counted)";
  return text;
}

const char* describe(Arrangement arrangement) {
  switch (arrangement) {
    case Arrangement::Overlapping:
      return "parts of it overlap";
    case Arrangement::Touching:
      return "parts of it touch";
    case Arrangement::Misnested:
      return "parts of it face the wrong way: solids in solids, or cavities outside of solids";
    default:
      return "";
  }
}

const char* describe(FieldReason reason) {
  switch (reason) {
    case FieldReason::Asked:
      return "the options ask for new faces";
    case FieldReason::Open:
      return "its faces do not bound a solid, even with holes closed and faces reversed";
    case FieldReason::Sheet:
      return "its sheets may bound a solid together, have finer details than their thickness, or may get "
             "none";
    case FieldReason::Crossing:
      return "its parts cross or touch and could not be united exactly";
    default:
      return "";
  }
}

std::string describe(const Verdict& verdict, const Diagnostics& found,
                     const std::optional<SelfIntersections>& crossings) {
  std::string words = nameKind(verdict.kind, found, crossings) + ".";
  if (const std::string rest = describeRest(verdict.kind, found, crossings); !rest.empty())
    words += " " + rest;
  if (!crossings) words += " Faces that cross and parts that overlap were not looked for.";
  return words;
}

}  // namespace raymap
