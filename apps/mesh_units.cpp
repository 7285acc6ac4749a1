#include "mesh_units.h"

#include <raymap/raymap.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>
#include <utility>

#include "checks.h"
#include "parser.h"
#include "terminal.h"
#include "text.h"

namespace raymap {

namespace {

constexpr std::pair<const char*, LengthUnit> kUnits[] = {
    {"um", LengthUnit::Micron}, {"mm", LengthUnit::Millimetre}, {"cm", LengthUnit::Centimetre},
    {"m", LengthUnit::Metre},   {"in", LengthUnit::Inch},       {"ft", LengthUnit::Foot}};

std::optional<LengthUnit> unitNamed(const std::string& name) {
  for (const auto& [each, unit] : kUnits)
    if (name == each) return unit;
  return std::nullopt;
}

/// Returns "inches (in)".
std::string longName(LengthUnit unit) {
  constexpr std::array kNames{"micrometres", "millimetres", "centimetres", "metres", "inches", "feet"};
  const auto* row = std::ranges::find(kUnits, unit, &std::pair<const char*, LengthUnit>::second);
  return std::string(kNames[size_t(row - kUnits)]) + " (" + row->first + ")";
}

/// Returns the unit of the numbers of a file, if it is known.
std::optional<LengthUnit> sourceOf(const MeshUnits& units, const std::filesystem::path& path) {
  return units.from.empty() ? meshUnit(path) : unitNamed(units.from);
}

const std::string& targetOf(const MeshUnits& units) {
  return units.to.empty() ? units.unit : units.to;
}

/// Returns the unit that programs take for granted in a file.
std::optional<LengthUnit> impliedUnit(const std::filesystem::path& result) {
  if (hasExtension(result, {".stl"})) return LengthUnit::Millimetre;
  if (hasExtension(result, {".glb"})) return LengthUnit::Metre;
  return std::nullopt;
}

void warnOfUnit(const MeshUnits& units, const std::filesystem::path& mesh,
                const std::filesystem::path& result) {
  const std::optional<LengthUnit> given = unitOf(units, mesh), implied = impliedUnit(result);
  if (!targetOf(units).empty() || !given || !implied || *given == *implied) return;
  printWarning(result.string() + ": its lengths are in " + nameOf(*given) + ", as in " + mesh.string() +
               ", but programs take them for " + nameOf(*implied) + "; --unit " + nameOf(*implied) +
               " converts them");
}

/// Returns the factor that converts the unit of a file. Says so if a unit is taken for granted.
double unitFactor(const MeshUnits& units, const std::filesystem::path& path) {
  const std::optional<LengthUnit> from = sourceOf(units, path), to = unitNamed(targetOf(units));
  if (from && to) return millimetres(*from) / millimetres(*to);
  if (!to) return 1.0;
  if (!units.to.empty())
    throw Error(ErrorCode::Usage, "--to " + units.to + ": " + displayName(path) +
                                      " does not state its unit; add --from and the unit of its numbers");
  printNote(displayName(path) + " does not state its unit: its numbers are taken as " + longName(*to) +
            ", and stay; --from U --to " + units.unit + " converts them from U");
  return 1.0;
}

glm::dvec3 vectorOf(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

/// Returns the least rotation of one unit vector to another; by half a turn about x, or y, to the opposite
/// one. Exact for axes.
glm::dmat3 rotationTo(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 axis = glm::cross(from, to);
  const double cosine = glm::dot(from, to);
  if (cosine < -1.0 + 1e-12) {
    const glm::dvec3 about = std::abs(from.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 normal = glm::normalize(about - from * glm::dot(about, from));
    return 2.0 * glm::outerProduct(normal, normal) - glm::dmat3(1.0);
  }
  const glm::dmat3 k(0.0, axis.z, -axis.y, -axis.z, 0.0, axis.x, axis.y, -axis.x, 0.0);
  return glm::dmat3(1.0) + k + k * k / (1.0 + cosine);
}

/// Returns the rotation by degrees about x, then y, then z. Exact for quarter turns.
glm::dmat3 rotationBy(const glm::dvec3& degrees) {
  glm::dmat3 result(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double quarters = degrees[axis] / 90.0;
    const bool isExact = quarters == std::round(quarters);
    const double angle = glm::radians(degrees[axis]);
    const double sine = isExact ? std::round(std::sin(angle)) : std::sin(angle),
                 cosine = isExact ? std::round(std::cos(angle)) : std::cos(angle);
    glm::dmat3 turn(1.0);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    turn[u][u] = turn[v][v] = cosine;
    turn[u][v] = sine;
    turn[v][u] = -sine;
    result = turn * result;
  }
  return result;
}

/// Sets each vertex to `change` of it in double precision.
template <class AnyMesh, class Change>
void changeVertices(AnyMesh& mesh, Change&& change) {
  using Vertex = typename decltype(mesh.vertices)::value_type;
  for (Vertex& vertex : mesh.vertices) vertex = Vertex(change(glm::dvec3(vertex)));
}

template <class AnyMesh>
void turn(AnyMesh& mesh, const glm::dmat3& rotation) {
  changeVertices(mesh, [&](const glm::dvec3& vertex) { return rotation * vertex; });
  mesh.origin = rotation * mesh.origin;
}

template <class AnyMesh>
void scale(AnyMesh& mesh, double factor, double asked) {
  const glm::dvec3 size = bounds(mesh).size();
  const double before = std::max({size.x, size.y, size.z}), after = before * factor;
  const glm::dvec3 origin = mesh.origin * factor;
  const bool isFinite = after < FLT_MAX && std::isfinite(origin.x + origin.y + origin.z);
  if (!isFinite || (before > 0.0 && after < FLT_MIN))
    throw Error(ErrorCode::Usage,
                (std::ostringstream() << "--scale " << asked << ": the mesh becomes too "
                                      << (isFinite ? "small" : "large") << " for single precision")
                    .str());
  changeVertices(mesh, [&](const glm::dvec3& vertex) { return vertex * factor; });
  mesh.origin = origin;
}

/// Returns how far the triangles of a mesh extend along a unit vector.
template <class AnyMesh>
double extentAlong(const AnyMesh& mesh, const glm::dvec3& direction) {
  double low = DBL_MAX, high = -DBL_MAX;
  for (const glm::uvec3& triangle : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const double at = glm::dot(glm::dvec3(mesh.vertices[triangle[c]]), direction);
      low = std::min(low, at);
      high = std::max(high, at);
    }
  return std::max(high - low, 0.0);
}

/// Returns the factor of --scale, --height or --fit for a mesh whose numbers are multiplied by `unit`, too.
/// Prints the factor that a length chose. `up` is a unit vector.
template <class AnyMesh>
double scaleFor(const AnyMesh& mesh, const MeshUnits& units, double unit, const glm::dvec3& up,
                const std::filesystem::path& from) {
  if (!units.height && units.fit.empty()) return units.scale;
  std::ostringstream what;
  double factor = DBL_MAX;
  const auto limit = [&](const glm::dvec3& direction, double length) {
    if (const double extent = extentAlong(mesh, direction) * unit; extent > 0.0)
      factor = std::min(factor, length / extent);
  };
  if (units.height) {
    limit(up, *units.height);
    what << "to a height of " << *units.height;
  } else {
    for (int axis = 0; axis < 3; ++axis) limit(glm::dmat3(1.0)[axis], units.fit[size_t(axis)]);
    what << "to fit into " << units.fit[0] << " x " << units.fit[1] << " x " << units.fit[2];
  }
  if (factor == DBL_MAX)
    throw Error(ErrorCode::Input, displayName(from) + ": the mesh cannot be scaled " + what.str() +
                                      ": it has no extent" +
                                      (units.height ? " along the axis that is up" : ""));
  std::ostringstream line;
  line << "scaled by " << std::setprecision(9) << factor << ' ' << what.str();
  printNote(line.str());
  return factor;
}

}  // namespace

std::vector<std::string> unitNames() {
  std::vector<std::string> all;
  for (const auto& [name, unit] : kUnits) all.emplace_back(name);
  return all;
}

void addUnitOptions(Command& command, MeshUnits& units) {
  addOptions(command, {{"--unit", &units.unit},
                       {"--from", &units.from},
                       {"--to", &units.to},
                       {"--scale", &units.scale},
                       {"--height", &units.height},
                       {"--fit", &units.fit},
                       {"--rotate", &units.rotate},
                       {"--translate", &units.translate}});
}

void addMeshOutputOptions(Command& command, MeshUnits& units) {
  addUnitOptions(command, units);
  addOptions(command, {{"--up", &units.up}, {"--recenter", &units.recenter}});
}

void checkMeshUnits(const MeshUnits& units, const std::filesystem::path& result) {
  const std::string& to = targetOf(units);
  if (hasExtension(result, {".glb"}) && !to.empty() && to != "m")
    throw Error(ErrorCode::Usage, (units.to.empty() ? "--unit " : "--to ") + to + ": " + result.string() +
                                      " is in metres, as its format demands; use " +
                                      (units.to.empty() ? "--unit m" : "--to m"));
  if (!units.up.empty() && vectorOf(units.up) == glm::dvec3(0.0))
    throw Error(ErrorCode::Usage, "--up: must be a direction, not 0 0 0");
}

void warnOfLength(const char* option, double length, const Box& shape) {
  const glm::dvec3 size = shape.size();
  const double longest = std::max({size.x, size.y, size.z});
  if (longest <= 0.0 || length <= longest) return;
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(),
                "%s %g is more than the longest side of the whole shape, %.4g; is the unit right? "
                "(--from U --to V converts what is read)",
                option, length, longest);
  printWarning(text.data());
}

std::optional<LengthUnit> unitOf(const MeshUnits& units, const std::filesystem::path& mesh) {
  const std::string& to = targetOf(units);
  return to.empty() ? sourceOf(units, mesh) : unitNamed(to);
}

LengthUnit writtenUnit(const MeshUnits& units, const std::filesystem::path& mesh) {
  return unitOf(units, mesh).value_or(LengthUnit::Millimetre);
}

glm::dvec3 downIn(const std::filesystem::path& file) {
  const bool isYUp = hasExtension(file, {".glb", ".gltf", ".dae", ".fbx"});
  return isYUp ? glm::dvec3(0, -1, 0) : glm::dvec3(0, 0, -1);
}

std::string describeUp(const std::filesystem::path& file) {
  const std::string format = lower(file.extension().string());
  if (format == ".fbx") return "y, as most programs write it; --up names another one";
  if (downIn(file).y < 0.0 || format == ".3mf")
    return (format == ".3mf" ? "z" : "y") + (", as in every " + format);
  return "not stated; z is taken, and --up names another one";
}

namespace {

template <class AnyMesh>
double convertMesh(AnyMesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                   const glm::dvec3& up) {
  if (!units.rotate.empty()) turn(mesh, rotationBy(vectorOf(units.rotate)));
  const double unit = unitFactor(units, from), factor = scaleFor(mesh, units, unit, up, from);
  if (factor * unit != 1.0) scale(mesh, factor * unit, factor);
  if (!units.translate.empty()) mesh.origin += vectorOf(units.translate);
  return factor;
}

template <class AnyMesh>
double convertForFile(AnyMesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                      const std::filesystem::path& result) {
  warnOfUnit(units, from, result);
  const glm::dvec3 up = -downIn(result);
  if (!units.up.empty()) turn(mesh, rotationTo(glm::normalize(vectorOf(units.up)), up));
  return convertMesh(mesh, units, from, up);
}

}  // namespace

double convertUnits(Mesh& mesh, const MeshUnits& units, const std::filesystem::path& from) {
  const glm::dvec3 up = units.upright.empty() ? -downIn(from) : glm::normalize(vectorOf(units.upright));
  return convertMesh(mesh, units, from, up);
}

double convertUnits(Mesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                    const std::filesystem::path& result) {
  return convertForFile(mesh, units, from, result);
}

double convertUnits(DoubleMesh& mesh, const MeshUnits& units, const std::filesystem::path& from,
                    const std::filesystem::path& result) {
  return convertForFile(mesh, units, from, result);
}

namespace {

/// Returns what each distance of a narrow band is clamped to: 1 outside, 2 inside, 0 nothing.
std::vector<uint8_t> clampedSides(const Field& band) {
  const auto outside = float(band.narrow->outside), inside = -float(band.narrow->inside);
  std::vector<uint8_t> sides(band.distance.size());
  for (size_t i = 0; i < sides.size(); ++i)
    sides[i] = band.distance[i] == outside ? 1 : band.distance[i] == inside ? 2 : 0;
  return sides;
}

/// Scales the widths of a narrow band. Distances that are clamped become equal to the new ones, whatever
/// rounding did to them.
void scaleWidths(Field& band, const std::vector<uint8_t>& sides, double factor) {
  band.narrow->outside *= factor;
  band.narrow->inside *= factor;
  const auto outside = float(band.narrow->outside), inside = -float(band.narrow->inside);
  for (size_t i = 0; i < sides.size(); ++i)
    if (sides[i] != 0) band.distance[i] = sides[i] == 1 ? outside : inside;
}

}  // namespace

void convertUnits(Field& field, const MeshUnits& units, const std::filesystem::path& from) {
  if (!units.up.empty() || !units.rotate.empty() || units.recenter)
    throw Error(ErrorCode::Usage, "--up, --rotate and --recenter are for meshes, and " + from.string() +
                                      " is a field; leave them out, or turn the mesh before");
  if (units.height || !units.fit.empty())
    throw Error(ErrorCode::Usage,
                "--height and --fit are for meshes, and " + from.string() + " is a field; use --scale");
  const double factor = units.scale * unitFactor(units, from);
  const glm::dvec3 move = units.translate.empty() ? glm::dvec3(0.0) : vectorOf(units.translate);
  const std::vector<uint8_t> sides = field.narrow ? clampedSides(field) : std::vector<uint8_t>();
  for (float& distance : field.distance)
    if (std::abs(distance) < FLT_MAX) distance = float(distance * factor);  // Else it is far in any unit.
  field.grid.spacing *= factor;
  field.grid.origin = factor * field.grid.origin + move;
  if (field.surfaceBounds.min.x <= field.surfaceBounds.max.x)
    field.surfaceBounds = {factor * field.surfaceBounds.min + move, factor * field.surfaceBounds.max + move};
  field.clampDistance *= factor;
  if (field.narrow) scaleWidths(field, sides, factor);
}

std::variant<Mesh, Field> loadMeshOrField(const std::filesystem::path& path, const std::string& format,
                                          const std::string& grid, const MeshUnits& units) {
  std::variant<Mesh, Field> read = loadMeshOrField(path, format, grid);
  std::visit([&](auto& each) { convertUnits(each, units, named(path, format)); }, read);
  return read;
}

Mesh loadMesh(const std::filesystem::path& path, const std::string& format, const MeshUnits& units,
              bool allowEmpty) {
  Mesh mesh = loadMesh(path, format, allowEmpty);
  convertUnits(mesh, units, named(path, format));
  return mesh;
}

std::filesystem::path named(const std::filesystem::path& path, const std::string& format) {
  std::filesystem::path result = path;
  return result += format;
}

std::string nameOf(LengthUnit unit) {
  return std::ranges::find(kUnits, unit, &std::pair<const char*, LengthUnit>::second)->first;
}

}  // namespace raymap
