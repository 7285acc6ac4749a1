#include "mesh_output.h"

#include <raymap/error.h>
#include <raymap/json.h>
#include <raymap/split.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

#include "batch.h"
#include "checks.h"
#include "mesh_units.h"
#include "repair_report.h"
#include "terminal.h"
#include "text.h"
#include "warnings.h"

namespace raymap {

namespace {

std::string text(const glm::dvec3& v) {
  std::string result;
  for (int axis = 0; axis < 3; ++axis) {
    char digits[32];
    result.append(axis > 0 ? " " : "").append(digits, std::to_chars(digits, digits + 32, v[axis]).ptr);
  }
  return result;
}

/// Returns the centre of the bounds as multiples of the power of ten that is a tenth of the size or less.
glm::dvec3 roundCentre(const Box& box) {
  const glm::dvec3 size = box.size(), centre = box.centre();
  const double exponent = std::floor(std::log10(0.1 * std::max({size.x, size.y, size.z})));
  // Divides by a whole number: a step below 1 has no exact value.
  const double whole = std::pow(10.0, std::abs(exponent));
  return exponent < 0.0 ? glm::round(centre * whole) / whole : glm::round(centre / whole) * whole;
}

bool isRounded(const StoredMesh& mesh) {
  if (mesh.exact.origin == mesh.stored.origin) return mesh.exact.vertices != mesh.stored.vertices;
  for (uint32_t v = 0; v < mesh.exact.vertices.size(); ++v)
    if (mesh.exact.position(v) != mesh.stored.position(v)) return true;
  return false;
}

/// Returns whether a mesh is a solid if the exact one is, with as many positions.
bool holds(const Diagnostics& found, const Diagnostics& exact) {
  return (isSound(found) || !isSound(exact)) && found.weldedVertices >= exact.weldedVertices;
}

/// Returns other formats that hold the mesh with at most so many pairs of faces that cross, as ".ply or
/// .obj".
std::string formatsThatHold(const StoredMesh& mesh, const Diagnostics& exact, size_t crossing) {
  std::vector<std::string> fit;
  const auto add = [&](const std::string& extension) {
    if (hasExtension(named(mesh.path, std::string(mesh.options.format)), {extension})) return;
    MeshWriteOptions options = mesh.options;
    options.format = {};
    const Mesh stored = asStored("mesh" + extension, mesh.exact, options);
    if (holds(diagnose(stored, {.brief = true}), exact) && findSelfIntersections(stored).pairs <= crossing)
      fit.push_back(extension);
  };
  for (const std::string& extension : writableMeshExtensions()) add(extension);
  return joined(fit, ", ", " or ");
}

[[noreturn]] void fail(const StoredMesh& mesh, const Diagnostics& exact, size_t crossing,
                       const std::string& what) {
  const std::string formats = formatsThatHold(mesh, exact, crossing);
  throw Error(ErrorCode::Unsupported,
              mesh.path.string() + ": the precision of this format breaks the mesh so far from (0, 0, 0): " +
                  what + "; " + (formats.empty() ? "no format holds it there" : "write a " + formats) +
                  (mesh.options.offset == glm::dvec3(0.0) ? ", or add --recenter" : ""));
}

/// Returns some faces of a mesh with the vertices that they use, in their order.
template <class AnyMesh>
AnyMesh partOf(const AnyMesh& mesh, const std::vector<uint32_t>& faces) {
  AnyMesh part{.origin = mesh.origin};
  std::vector<bool> isUsed(mesh.vertices.size());
  for (const uint32_t face : faces)
    for (int c = 0; c < 3; ++c) isUsed[mesh.triangles[face][c]] = true;
  std::vector<uint32_t> numbers(mesh.vertices.size());
  for (size_t v = 0; v < isUsed.size(); ++v) {
    numbers[v] = uint32_t(part.vertices.size());
    if (isUsed[v]) part.vertices.push_back(mesh.vertices[v]);
  }
  for (const uint32_t face : faces) {
    const glm::uvec3& t = mesh.triangles[face];
    part.triangles.emplace_back(numbers[t.x], numbers[t.y], numbers[t.z]);
  }
  return part;
}

}  // namespace

MeshWriteOptions writeOptions(const MeshView& mesh, const StoreOptions& options) {
  return {.offset = options.recenter ? roundCentre(bounds(mesh)) : glm::dvec3(0.0),
          .unit = options.unit,
          .format = options.format,
          .warn = warn};
}

StoredMesh storeMesh(const std::filesystem::path& path, Mesh mesh, const StoreOptions& options) {
  StoredMesh result{path, writeOptions(mesh, options), std::move(mesh), {}};
  result.stored = asStored(path, result.exact, result.options);
  return result;
}

void checkSplit(bool isSplit, const std::filesystem::path& output) {
  if (isSplit && output == "-")
    throw Error(ErrorCode::Usage, "--split writes a file for each part; name a file for --output, not -");
}

std::vector<std::filesystem::path> inputsKept(const StreamFormat& format,
                                              const std::filesystem::path& input) {
  return format.mayOverwrite ? std::vector<std::filesystem::path>{} : std::vector{input};
}

template <class AnyMesh>
void writeParts(const std::filesystem::path& path, const AnyMesh& mesh, const MeshWriteOptions& options,
                const std::vector<std::filesystem::path>& kept, Json& written) {
  const std::vector<std::vector<uint32_t>> parts = splitParts(mesh);
  std::vector<std::filesystem::path> files;
  for (size_t p = 0; p < parts.size(); ++p) {
    const std::string number = "_" + std::to_string(written.size() + p + 1);
    files.push_back(path.parent_path() / ((path.stem() += number) += path.extension()));
    checkInputs({{"--split", files.back(), {}}}, kept);
  }
  MeshWriteOptions each = options;
  bool hasWarned = false;
  each.warn = [&](const Warning& warning) {
    const bool isLoss = warning.code == WarningCode::AttributesLost;
    if (!isLoss || !std::exchange(hasWarned, true)) warn(warning);
  };
  for (size_t p = 0; p < parts.size(); ++p) {
    const AnyMesh part = partOf(mesh, parts[p]);
    MeshAttributes attributes;
    if (options.attributes) attributes = carryAttributes(*options.attributes, mesh, part, parts[p]);
    each.attributes = &attributes;
    writeMesh(files[p], part, each);
    written.push_back({{"file", files[p].string()},
                       {"triangles", part.triangles.size()},
                       {"size", toJson(bounds(part).size())},
                       {"volume", diagnose(part, {.brief = true}).signedVolume}});
  }
}
template void writeParts(const std::filesystem::path&, const Mesh&, const MeshWriteOptions&,
                         const std::vector<std::filesystem::path>&, Json&);
template void writeParts(const std::filesystem::path&, const DoubleMesh&, const MeshWriteOptions&,
                         const std::vector<std::filesystem::path>&, Json&);

void printParts(const Json& written) {
  std::vector<Row> rows{{"part", "size", "triangles", "volume", "written"}};
  for (const Json& part : written) {
    std::string size;
    for (const double side : part["size"]) size += (size.empty() ? "" : " x ") + numberText("%.5g", side);
    rows.push_back({std::to_string(rows.size()), size, grouped(part["triangles"]),
                    numberText("%.6g", part["volume"]), displayName(part["file"].get<std::string>())});
  }
  printTable(rows);
}

void checkStored(const StoredMesh& mesh) {
  if (isRounded(mesh)) checkStored(mesh, diagnose(mesh.stored, {.brief = true}), 0);
}

void checkStored(const StoredMesh& mesh, const Diagnostics& found, size_t crossing) {
  if (!isRounded(mesh)) return;
  if (!isSound(found) || found.weldedVertices != found.vertices) {
    const Diagnostics exact = diagnose(mesh.exact, {.brief = true});
    if (!holds(found, exact))
      fail(mesh, exact, findSelfIntersections(mesh.exact).pairs,
           grouped(exact.weldedVertices - found.weldedVertices) + " of " +
               counted(exact.weldedVertices, "position") + " coincide with others and " +
               counted(found.degenerateFaces, "face") + " of " + grouped(found.triangles) + " have no area");
  }
  if (crossing == 0) return;
  const size_t before = findSelfIntersections(mesh.exact).pairs;
  if (crossing > before)
    fail(mesh, diagnose(mesh.exact, {.brief = true}), before,
         counted(crossing, "pair") + " of faces cross instead of " + grouped(before));
}

void checkSimplification(const std::optional<double>& tolerance, size_t triangles) {
  if (tolerance == 0.0 && triangles > 0)
    throw Error(ErrorCode::Usage,
                "--tolerance 0 keeps all triangles, so --triangles cannot limit them; leave one of both out");
}

void printWritten(const std::filesystem::path& path, const MeshWriteOptions& options) {
  printWritten(path);
  printOffset(options);
}

void printOffset(const MeshWriteOptions& options) {
  const glm::dvec3& offset = options.offset;
  if (offset != glm::dvec3(0.0))
    std::printf("recentered: add %s to the positions in the file\n", text(offset).c_str());
}

}  // namespace raymap
