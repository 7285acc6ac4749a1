#include "io/import/import_mesh.h"

#include <raymap/error.h>

#include "io/field/field_array.h"
#include "io/import/import_attributes.h"
#include "io/import/import_stream.h"
#include "io/import/importer.h"
#include "io/import/oversized_number.h"

namespace raymap {

namespace {

/// Starts the importer. If it fails on a DAE with an impossible number, that is the reason.
Importer startImport(const SourceFile& source, std::string_view format, const MeshFile& file) {
  try {
    return Importer(source, format, regularFileSize(source));
  } catch (const Error& error) {
    if (format != ".dae" || error.code() != ErrorCode::Input) throw;
    const Buffer<std::byte> bytes = loadFile(source);
    if (const auto number = oversizedNumber({reinterpret_cast<const char*>(bytes.data()), bytes.size()}))
      file.fail(*number);
    throw;
  }
}

}  // namespace

Mesh importMesh(const SourceFile& source, std::string_view format, const MeshFile& file) {
  const std::filesystem::path& path = source.path();
  Importer importer = startImport(source, format, file);
  MeshHeader header;
  importer.receive(&header, sizeof header);
  if (header.otherFaces > 0)
    file.warnThat(std::to_string(header.otherFaces) + " points, lines or empty faces ignored");
  warnOfPolygons(file, 0, header.uncutFaces);
  if (header.vertices > UINT32_MAX || header.triangles > UINT32_MAX)
    throwUnsupported(path, "more than 2^32 triangles or vertices");
  for (const uint64_t count : {header.runs, header.parts, header.materials, header.nameBytes})
    if (count > UINT32_MAX) throwUnsupported(path, "more than 2^32 parts, materials or bytes of their names");
  checkMemory(file, header.vertices * sizeof(glm::dvec3) + header.triangles * sizeof(glm::uvec3) +
                        (file.attributes ? attributeBytes(header) : 0));
  std::vector<glm::dvec3> positions(header.vertices);
  std::vector<glm::uvec3> triangles(header.triangles);
  importer.receive(positions.data(), positions.size() * sizeof(glm::dvec3));
  importer.receive(triangles.data(), triangles.size() * sizeof(glm::uvec3));
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int c = 0; c < 3; ++c)
      if (triangles[t][c] >= positions.size())
        file.fail("triangle " + std::to_string(t) + ": " + outOfRange(triangles[t][c], positions.size()));
  if (file.attributes) importAttributes(file, header, triangles, importer);
  return finishMesh(file, std::move(positions), std::move(triangles));
}

}  // namespace raymap
