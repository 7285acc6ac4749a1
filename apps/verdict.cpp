#include "verdict.h"

#include <raymap/grid.h>
#include <raymap/io.h>
#include <raymap/json.h>
#include <raymap/repair.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "mesh_units.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

/// Returns a number in three digits, as an argument.
std::string plain(double number) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.3g", number);
  return digits.data();
}

/// Returns a number in three digits, or a whole one from a thousand on.
std::string text(double number) {
  return number >= 1000.0 && number < 1e12 ? grouped(size_t(std::llround(number))) : plain(number);
}

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
         text(widest->diameter) + " wide";
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

std::filesystem::path resultFor(const std::filesystem::path& mesh) {
  const std::vector<std::string> writable = writableMeshExtensions();
  const std::string extension = mesh.extension().string();
  const bool canWrite = std::ranges::find(writable, extension) != writable.end();
  std::filesystem::path result = mesh.filename();
  return result.replace_extension(canWrite ? ".solid" + extension : ".solid.stl");
}

/// Returns the number of samples along each side of a repair's grid.
glm::dvec3 samplesFor(const Box& box, double spacing) {
  const glm::dvec3 size = box.size();
  const double padding = 2.0 * GridOptions{}.padding * std::max({size.x, size.y, size.z});
  return glm::ceil((size + padding) / spacing);
}

/// Returns the number of samples along the longest side of a grid.
std::string samplesAlong(const Grid& grid) {
  return std::to_string(std::max({grid.dims.x, grid.dims.y, grid.dims.z})) + " samples";
}

std::string describeThickness(const Verdict& verdict, const Mesh& mesh, bool isFast,
                              const MachineOptions& machine) {
  if (verdict.sought == 0.0) {
    const bool isSolid = verdict.kind != MeshKind::NoSurface && verdict.remedy != Remedy::Thicken;
    return isSolid && !isFast ? "The thickness was not measured: there are too many triangles.\n" : "";
  }
  const RepairGrid grid = chooseRepairGrid(mesh, verdict, {}, {}, machine);
  if (!verdict.voxelSize)
    return "No part is thinner than " + text(verdict.sought) + "; a repair with " + samplesAlong(grid) +
           " keeps all.\n";
  const std::string part = "Its thinnest part is about " + text(*verdict.thinnest) + " thick. ";
  const std::string voxels = "--voxel-size " + plain(*verdict.voxelSize);
  if (!grid.thinnest && *verdict.voxelSize >= grid.spacing)
    return part + "A repair with " + samplesAlong(grid) + " keeps it; so does " + voxels + ".\n";
  const bool isKept = grid.thinnest && grid.keepsThinnest();
  const glm::dvec3 n = isKept ? glm::dvec3(grid.dims) : samplesFor(bounds(mesh), *verdict.voxelSize);
  const std::string samples = voxels + ": " + text(n.x) + " x " + text(n.y) + " x " + text(n.z) + " samples";
  if (isKept) return part + "A repair chooses what keeps it, " + samples + ".\n";
  return part + "To keep it as it is would take " + samples + ". A repair takes " + samplesAlong(grid) +
         ", and makes what is thinner " + text(kThinnestWall * grid.spacing) + " thick.\n";
}

/// Returns the file to read and the file to write.
std::string filesOf(const std::filesystem::path& mesh) {
  return asArgument(mesh) + " -o " + quoted(resultFor(mesh).string());
}

}  // namespace

std::string thickenCommand(double thickness, const std::filesystem::path& mesh) {
  return "raymap mesh " + filesOf(mesh) + " --thickness " + plain(thickness) + " --voxel-size " +
         plain(thickness / 4.0);
}

std::string describeKind(const Verdict& verdict, const Diagnostics& found,
                         const std::optional<SelfIntersections>& crossings) {
  std::string words = nameKind(verdict.kind, found, crossings) + ".";
  if (const std::string rest = describeRest(verdict.kind, found, crossings); !rest.empty())
    words += " " + rest;
  if (!crossings) words += " Faces that cross and parts that overlap were not looked for (--fast).";
  return words;
}

Json toJson(const Verdict& verdict, const Diagnostics& found,
            const std::optional<SelfIntersections>& crossings, const std::optional<LengthUnit>& unit) {
  Json json = toJson(found);
  json["unit"] = unit ? Json(nameOf(*unit)) : Json();
  json["self_intersections"] = crossings ? toJson(*crossings) : Json();
  json["verdict"] = toJson(verdict);
  return json;
}

std::string describe(const Verdict& verdict, const Diagnostics& found,
                     const std::optional<SelfIntersections>& crossings, const Mesh& mesh,
                     const std::filesystem::path& path, const MachineOptions& machine) {
  std::string words = "This is " + describeKind(verdict, found, crossings) + "\n";
  if (verdict.remedy == Remedy::Repair)
    words += "To make it a clean solid: raymap repair " + filesOf(path) + "\n";
  if (verdict.kind == MeshKind::Sheet)
    words +=
        "To join its rim to a flat base, as of a terrain: raymap repair " + filesOf(path) + " --base Z\n";
  if (verdict.remedy == Remedy::Thicken)
    words += "To give it a thickness of your choice: " + thickenCommand(verdict.thickness, path) + "\n";
  return words + describeThickness(verdict, mesh, !crossings, machine);
}

}  // namespace raymap
