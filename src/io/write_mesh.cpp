#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "io/3mf/properties.h"
#include "io/3mf/write_3mf.h"
#include "io/file_format.h"
#include "io/mesh/mesh_formats.h"
#include "io/mesh/named_objects.h"
#include "mesh/model.h"
#include "mesh/strided_mesh.h"

namespace raymap {

namespace {

struct MeshFormat {
  std::string_view extension;
  /// Null for 3MF, which has a unit and a title.
  void (*write)(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset);
  Precision precision;
  AttributeKinds held = {};  ///< Attributes that it has a place for.
};

constexpr std::array kMeshFormats{
    MeshFormat{".ply", writePly, Precision::Double, {.uvs = true, .colours = true}},
    MeshFormat{".obj", writeObj, Precision::Double, {true, true, true, true}},
    MeshFormat{".stl", writeStl, Precision::Single},
    MeshFormat{".glb", writeGlb, Precision::Origin, {true, true, true, true}},
    MeshFormat{".3mf", nullptr, Precision::Double, {.parts = true, .materials = true, .colours = true}}};

const MeshFormat& formatFor(const std::filesystem::path& path, std::string_view given) {
  const auto* format = std::ranges::find(kMeshFormats, formatOf(path, given, writableMeshExtensions()),
                                         &MeshFormat::extension);
  if (format == kMeshFormats.end())
    throw Error(ErrorCode::Usage,
                path.string() + ": meshes are written as " + listOf(writableMeshExtensions()));
  return *format;
}

/// Returns the mesh moved by -offset. It refers to the arrays of the model.
WritableMesh moved(const MeshView& view, const glm::dvec3& offset, Model& model) {
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(offset[axis])) throw Error(ErrorCode::Usage, "the offset of a mesh must be finite");
  validate(view);
  model.pack(view);
  WritableMesh mesh{model};
  mesh.origin -= offset;
  if (view.scalar != Scalar::Double) return mesh;
  mesh.exact.reserve(view.vertexCount);
  const glm::dvec3 shift = view.origin - offset;
  visitTypes(view, [&](const auto& strided) {
    for (size_t v = 0; v < strided.vertexCount(); ++v) {
      const glm::dvec3 p(strided.position(v));
      mesh.exact.push_back(shift == glm::dvec3(0.0) ? p : p + shift);  // -0 stays.
    }
  });
  return mesh;
}

/// Returns how far single precision moves a vertex of a triangle at most.
double largestShift(const WritableMesh& mesh) {
  double shift = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c)
      shift =
          std::max(shift, glm::distance(mesh.exactPosition(t[c]), glm::dvec3(singlePosition(mesh, t[c]))));
  return shift;
}

/// Warns if single precision changes the shape of a mesh, as it does far from 0.
void warnOfShift(const std::filesystem::path& path, const WritableMesh& mesh, const WarningCallback& warn) {
  constexpr double kNoticeable = 1e-5;  // Relative to the mesh's size.
  if (!warn) return;
  const glm::dvec3 sides = bounds(mesh).size();
  const double size = std::max({sides.x, sides.y, sides.z}), shift = largestShift(mesh);
  if (size == 0.0 || shift <= kNoticeable * size) return;  // A point has no shape.
  std::string others;
  for (const MeshFormat& format : kMeshFormats)
    if (format.precision != Precision::Single) others.append(1, ' ').append(format.extension);
  warn({WarningCode::Rounding,
        path.string() +
            ": so far from (0, 0, 0), the single precision of this format moves vertices by up to " +
            numberText(shift, 3) + ", " + numberText(100.0 * shift / size, 3) +
            " % of the mesh's size; write one of" + others + ", or move the mesh closer",
        {.file = path.string(), .share = shift / size, .length = shift}});
}

/// Returns values of corners by vertex.
template <class Value>
VertexValues vertexValues(const CornerValues<Value>& given, const PackedMesh& mesh) {
  VertexValues found;
  if (given.corners.empty()) return found;
  found.ids.assign(mesh.vertices.size(), kNoAttribute);
  for (size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int c = 0; c < 3; ++c) {
      const uint32_t id = given.corners[f][c];
      uint32_t& first = found.ids[mesh.triangles[f][c]];
      if (id == kNoAttribute) continue;
      if (first == kNoAttribute) first = id;
      found.differ = found.differ || given.values[id] != given.values[first];
    }
  return found;
}

/// Returns "a, b and c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (size_t w = 0; w < words.size(); ++w)
    text += (w == 0 ? "" : w + 1 < words.size() ? ", " : " and ") + words[w];
  return text;
}

/// Warns of attributes that the file lacks.
void warnOfAttributes(const std::filesystem::path& path, const WritableMesh& mesh, const MeshFormat& format,
                      const WarningCallback& warn) {
  if (!warn) return;
  const MeshAttributes& attributes = *mesh.attributes;
  const AttributeKinds& held = format.held;
  // An .obj has texture coordinates at corners, and parts of any faces.
  const bool isObj = format.write == writeObj, isGlb = format.write == writeGlb, is3mf = !format.write;
  std::vector<std::string> lost =
      describe(attributes, {.parts = !isObj && (!held.parts || mesh.partOf.empty()),
                            .materials = !held.materials,
                            .uvs = !isObj && (!held.uvs || mesh.uvs.differ),
                            .colours = !held.colours});
  const std::string kept = listed(lost);
  if (held.colours && mesh.colours.differ) lost.emplace_back("colours that differ at a vertex");
  if (is3mf)
    std::ranges::move(lostIn3mf(attributes), std::back_inserter(lost));
  else if (held.materials &&
           (isGlb ? !attributes.gltf && !attributes.libraries.empty() : attributes.gltf != nullptr))
    lost.emplace_back("looks of materials");
  lost.insert(lost.end(), attributes.lost.begin(), attributes.lost.end());
  if (lost.empty()) return;
  const std::string all = listed(lost);
  warn({WarningCode::AttributesLost,
        path.string() + ": it lacks what the given mesh has: " + all +
            (kept.empty() ? ""
                          : (attributes.gltf && !isGlb && !is3mf ? "; a .glb keeps " : "; an .obj keeps ") +
                                (kept == all ? "them" : kept)),
        {.file = path.string()}});
}

/// Checks that attributes fit the mesh, and arranges them as the format has them.
void addAttributes(const MeshAttributes* attributes, const MeshFormat& format, WritableMesh& mesh) {
  if (!attributes) return;
  validate(*attributes, mesh.triangles.size());
  mesh.attributes = attributes;
  if (format.held.parts && format.write != writeObj) mesh.partOf = separateParts(mesh);
  // A .glb splits vertices whose corners differ, and a .3mf has colours of corners.
  if (format.write == writeGlb || !format.write) return;
  if (format.held.uvs) mesh.uvs = vertexValues(attributes->uvs, mesh);
  if (format.held.colours) mesh.colours = vertexValues(attributes->colours, mesh);
}

}  // namespace

void writeMesh(const std::filesystem::path& path, const MeshView& view, const MeshWriteOptions& options) {
  const MeshFormat& format = formatFor(path, options.format);
  Model model;
  WritableMesh mesh = moved(view, options.offset, model);
  addAttributes(options.attributes, format, mesh);
  mesh.folder = path.parent_path();
  if (format.precision == Precision::Single) warnOfShift(path, mesh, options.warn);
  try {
    writeAtomically(path, [&](std::ostream& out) {
      if (format.write)
        format.write(out, mesh, options.offset);
      else
        writeSeekable(out, [&](std::ostream& whole) {
          write3mf(whole, mesh, {options.unit, path.stem().string(), offsetNote(options.offset)});
        });
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::Unsupported) throw;
    throw Error(error.code(), path.string() + ": " + error.what());
  }
  if (mesh.attributes) warnOfAttributes(path, mesh, format, options.warn);
}

Mesh asStored(const std::filesystem::path& path, const MeshView& view, const MeshWriteOptions& options) {
  const MeshFormat& format = formatFor(path, options.format);
  Model model;
  Mesh mesh = rounded(moved(view, options.offset, model), format.precision);
  if (!format.write) std::erase_if(mesh.triangles, [](const glm::uvec3& t) { return !isIn3mf(t); });
  mesh.origin += options.offset;
  return mesh;
}

std::vector<std::string> writableMeshExtensions() {
  std::vector<std::string> extensions;
  extensions.reserve(kMeshFormats.size());
  for (const MeshFormat& format : kMeshFormats) extensions.emplace_back(format.extension);
  return extensions;
}

}  // namespace raymap
