#include "verdict.h"

#include <raymap/grid.h>
#include <raymap/io.h>
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

/// Returns the number of samples of `raymap repair` by default.
std::string defaultSamples() {
  return std::to_string(kRepairResolution) + " samples";
}

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

std::string pairsOf(const SelfIntersections& crossings) {
  return (crossings.complete ? "" : "at least ") + counted(crossings.pairs, "pair") + " of faces";
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
      return parts + " that overlap: " + pairsOf(*crossings) + " cross";
    case MeshKind::CrossingSolid:
      return "a closed solid that crosses itself: " + pairsOf(*crossings);
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
  if (kind == MeshKind::FlawedSolid) return {};
  std::vector<std::string> rest;
  if (found.flippedFaces > 0 && kind != MeshKind::TurnedFaces)
    rest.push_back(counted(found.flippedFaces, "turned face"));
  if (crossings && crossings->pairs > 0 && kind != MeshKind::OverlappingSolids &&
      kind != MeshKind::CrossingSolid)
    rest.push_back(pairsOf(*crossings) + " that cross");
  if (found.nonManifoldEdges > 0 && kind != MeshKind::DoubleSided)
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

double longestSide(const Diagnostics& found) {
  const glm::dvec3 size = found.bounds.size();
  return std::max({size.x, size.y, size.z});
}

/// Returns a thickness for a sheet: a fiftieth of its longest side, in one digit.
double thicknessFor(const Diagnostics& found) {
  const double thickness = longestSide(found) / 50.0;
  const double digit = std::pow(10.0, std::floor(std::log10(thickness)));
  return std::round(thickness / digit) * digit;
}

/// Distance between samples of `raymap repair` by default.
double defaultSpacing(const Diagnostics& found) {
  return longestSide(found) * (1.0 + 2.0 * GridOptions{}.padding) / kRepairResolution;
}

/// Number of samples along each side of a repair's grid.
glm::dvec3 samplesFor(const Diagnostics& found, double spacing) {
  const double padding = 2.0 * GridOptions{}.padding * longestSide(found);
  return glm::ceil((found.bounds.size() + padding) / spacing);
}

/// How well samples keep the thinnest part.
enum class Keeps : uint8_t { Unknown, ByDefault, WithVoxelSize, TooMany };

Keeps keeps(const Verdict& verdict, const Diagnostics& found) {
  if (!verdict.voxelSize) return Keeps::Unknown;
  if (*verdict.voxelSize >= defaultSpacing(found)) return Keeps::ByDefault;
  const glm::dvec3 n = samplesFor(found, *verdict.voxelSize);
  return n.x * n.y * n.z > double(kMostRepairSamples) ? Keeps::TooMany : Keeps::WithVoxelSize;
}

std::string describeThickness(const Verdict& verdict, const Diagnostics& found, bool isFast) {
  if (verdict.sought == 0.0) {
    const bool isSolid = verdict.kind != MeshKind::NoSurface && verdict.remedy != Remedy::Thicken;
    return isSolid && !isFast ? "The thickness was not measured: there are too many triangles.\n" : "";
  }
  if (!verdict.voxelSize)
    return "No part is thinner than " + text(verdict.sought) + "; a repair with " + defaultSamples() +
           " keeps all.\n";
  const std::string part = "Its thinnest part is about " + text(*verdict.thinnest) + " thick. ";
  const std::string voxels = "--voxel-size " + plain(*verdict.voxelSize);
  const glm::dvec3 n = samplesFor(found, *verdict.voxelSize);
  const std::string grid = voxels + ": " + text(n.x) + " x " + text(n.y) + " x " + text(n.z) + " samples";
  switch (keeps(verdict, found)) {
    case Keeps::ByDefault:
      return part + "A repair with " + defaultSamples() + " keeps it; so does " + voxels + ".\n";
    case Keeps::TooMany:
      return part + "To keep it as it is would take " + grid + ". A repair takes " + defaultSamples() +
             ", and makes what is thinner " + text(1.75 * defaultSpacing(found)) + " thick.\n";
    default:
      return part + "A repair chooses what keeps it, " + grid + ".\n";
  }
}

std::string commandFor(const Verdict& verdict, const Diagnostics& found, const std::filesystem::path& mesh) {
  const std::string files = quoted(mesh.string()) + " -o " + quoted(resultFor(mesh).string());
  if (verdict.remedy == Remedy::None) return {};
  if (verdict.remedy == Remedy::Thicken) {
    const double thickness = thicknessFor(found);
    return "raymap mesh " + files + " --thickness " + plain(thickness) + " --voxel-size " +
           plain(thickness / 4.0);
  }
  return "raymap repair " + files;
}

}  // namespace

std::string describeKind(const Verdict& verdict, const Diagnostics& found,
                         const std::optional<SelfIntersections>& crossings) {
  std::string words = nameKind(verdict.kind, found, crossings) + ".";
  if (const std::string rest = describeRest(verdict.kind, found, crossings); !rest.empty())
    words += " " + rest;
  if (!crossings) words += " Faces that cross were not counted (--fast).";
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
                     const std::optional<SelfIntersections>& crossings, const std::filesystem::path& mesh) {
  std::string words = "This is " + describeKind(verdict, found, crossings) + "\n";
  const std::string command = commandFor(verdict, found, mesh);
  if (verdict.remedy == Remedy::Repair) words += "To make it a clean solid: " + command + "\n";
  if (verdict.remedy == Remedy::Thicken) words += "To give it a thickness of your choice: " + command + "\n";
  return words + describeThickness(verdict, found, !crossings);
}

}  // namespace raymap
