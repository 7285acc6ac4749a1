#include "mesh_units.h"

#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <utility>

#include "checks.h"
#include "terminal.h"

namespace raymap {

namespace {

constexpr std::array<std::pair<const char*, LengthUnit>, 6> kUnits{{{"um", LengthUnit::Micron},
                                                                    {"mm", LengthUnit::Millimetre},
                                                                    {"cm", LengthUnit::Centimetre},
                                                                    {"m", LengthUnit::Metre},
                                                                    {"in", LengthUnit::Inch},
                                                                    {"ft", LengthUnit::Foot}}};

std::optional<LengthUnit> unitNamed(const std::string& name) {
  for (const auto& [each, unit] : kUnits)
    if (name == each) return unit;
  return std::nullopt;
}

/// Returns the unit that programs take for granted in a file.
std::optional<LengthUnit> impliedUnit(const std::filesystem::path& result) {
  if (hasExtension(result, {".stl"})) return LengthUnit::Millimetre;
  if (hasExtension(result, {".glb"})) return LengthUnit::Metre;
  return std::nullopt;
}

void warnOfUnit(const MeshUnits& units, const std::filesystem::path& mesh,
                const std::filesystem::path& result) {
  const std::optional<LengthUnit> given = meshUnit(mesh), implied = impliedUnit(result);
  if (!units.unit.empty() || !given || !implied || *given == *implied) return;
  printWarning(result.string() + ": its lengths are in " + nameOf(*given) + ", as in " + mesh.string() +
               ", but programs take them for " + nameOf(*implied) + "; --unit " + nameOf(*implied) +
               " converts them");
}

/// Turns the mesh by a quarter about x, so that y becomes z, or z becomes y.
void turn(Mesh& mesh, bool toZ) {
  const auto turned = [&](auto p) { return toZ ? decltype(p)(p.x, -p.z, p.y) : decltype(p)(p.x, p.z, -p.y); };
  for (glm::vec3& vertex : mesh.vertices) vertex = turned(vertex);
  mesh.origin = turned(mesh.origin);
}

void scale(Mesh& mesh, double factor, const MeshUnits& units) {
  const glm::dvec3 size = bounds(mesh).size();
  const double before = std::max({size.x, size.y, size.z}), after = before * factor;
  const glm::dvec3 origin = mesh.origin * factor;
  const bool isFinite = after < FLT_MAX && std::isfinite(origin.x + origin.y + origin.z);
  if (!isFinite || (before > 0.0 && after < FLT_MIN))
    throw Error(ErrorCode::Usage, "--scale " + CLI::detail::to_string(units.scale) +
                                      ": the mesh becomes too " + (isFinite ? "small" : "large") +
                                      " for single precision");
  for (glm::vec3& vertex : mesh.vertices) vertex = glm::vec3(glm::dvec3(vertex) * factor);
  mesh.origin = origin;
}

}  // namespace

void addMeshUnits(CLI::App& command, MeshUnits& units) {
  std::vector<std::string> names;
  for (const auto& [name, unit] : kUnits) names.emplace_back(name);
  command
      .add_option(
          "--unit", units.unit,
          "Unit of all lengths, also of these options: um, mm, cm, m, in or ft. A 3MF, glTF or DAE is "
          "converted to it; the numbers of other files are taken to be in it. A .3mf states it")
      ->check(CLI::IsMember(names))
      ->type_name("U")
      ->group("Units");
  command.add_option("--scale", units.scale, "Multiply the mesh by this factor")
      ->check(numberFrom(0, true))
      ->group("Units");
  command
      .add_option("--up", units.up,
                  "Axis that points up in the mesh, y or z; the result is turned to z up, a .glb to y up")
      ->check(CLI::IsMember({"y", "z"}))
      ->type_name("AXIS")
      ->group("Units");
}

void checkMeshUnits(const MeshUnits& units, const std::filesystem::path& result) {
  if (hasExtension(result, {".glb"}) && !units.unit.empty() && units.unit != "m")
    throw Error(ErrorCode::Usage, "--unit " + units.unit + ": " + result.string() +
                                      " is in metres, as its format demands; use --unit m");
}

std::optional<LengthUnit> unitOf(const MeshUnits& units, const std::filesystem::path& mesh) {
  return units.unit.empty() ? meshUnit(mesh) : unitNamed(units.unit);
}

LengthUnit writtenUnit(const MeshUnits& units, const std::filesystem::path& mesh) {
  return unitOf(units, mesh).value_or(LengthUnit::Millimetre);
}

glm::dvec3 downIn(const std::filesystem::path& result) {
  return hasExtension(result, {".glb"}) ? glm::dvec3(0, -1, 0) : glm::dvec3(0, 0, -1);
}

void convertUnits(Mesh& mesh, const MeshUnits& units, const std::filesystem::path& path,
                  const std::filesystem::path& result) {
  warnOfUnit(units, path, result);
  const bool toZ = !hasExtension(result, {".glb"});
  if (!units.up.empty() && (units.up == "z") != toZ) turn(mesh, toZ);
  const std::optional<LengthUnit> from = meshUnit(path), to = unitNamed(units.unit);
  const double factor = units.scale * (from && to ? millimetres(*from) / millimetres(*to) : 1.0);
  if (factor != 1.0) scale(mesh, factor, units);
}

std::filesystem::path named(const std::filesystem::path& path, const std::string& format) {
  std::filesystem::path result = path;
  return result += format;
}

std::string nameOf(LengthUnit unit) {
  return std::ranges::find(kUnits, unit, &std::pair<const char*, LengthUnit>::second)->first;
}

}  // namespace raymap
