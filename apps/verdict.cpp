#include "verdict.h"

#include <raymap/io.h>
#include <raymap/json.h>
#include <raymap/repair.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "mesh_units.h"
#include "report.h"
#include "terminal.h"
#include "text.h"

namespace raymap {

namespace {

/// Returns a number in three digits, as an argument.
std::string plain(double number) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.3g", number);
  return digits.data();
}

std::filesystem::path resultFor(const std::filesystem::path& mesh) {
  const std::vector<std::string> writable = writableMeshExtensions();
  const std::string extension = mesh.extension().string();
  const bool canWrite = std::ranges::find(writable, extension) != writable.end();
  std::filesystem::path result = mesh.filename();
  return result.replace_extension(canWrite ? ".solid" + extension : ".solid.stl");
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
  std::string words = describe(verdict, found, crossings);
  if (!crossings) words.insert(words.size() - 1, " (--fast)");
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
  const std::string thickness = crossings ? describeThickness(mesh, verdict, machine) : "";
  return words + replaced(thickness, "a voxel size of ", "--voxel-size ") + (thickness.empty() ? "" : "\n");
}

}  // namespace raymap
