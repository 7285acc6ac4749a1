// The functions of raymap/c.h that read and write files.

#include <raymap/c.h>
#include <raymap/io.h>
#include <raymap/names.h>

#include <utility>
#include <vector>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

raymap_mesh* raymap_mesh_load(const char* path, const raymap_options* options) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    std::vector<glm::dvec3> exact;
    auto mesh = c::ownMesh(
        readMesh(&need(path, "the path"),
                 {.warn = given.machine.warn, .allowEmpty = given.field.allowEmpty, .exact = &exact}));
    if (exact.empty()) return mesh;
    mesh->exact = std::move(exact);
    mesh->view = MeshView(mesh->exact, mesh->owned.triangles);
    return mesh;
  });
}

raymap_result raymap_mesh_write(const raymap_mesh* mesh, const char* path, const raymap_options* options) {
  return guard([&] {
    writeMesh(&need(path, "the path"), need(mesh, "the mesh").view,
              {.warn = c::optionsOr(options).machine.warn});
  });
}

raymap_field* raymap_field_load(const char* path, const raymap_options* options) {
  return create([&] {
    return c::ownField(readField(&need(path, "the path"), {.warn = c::optionsOr(options).machine.warn}));
  });
}

raymap_result raymap_field_write(const raymap_field* field, const char* path, const char* array) {
  return guard([&] {
    const std::filesystem::path file = &need(path, "the path");
    if (const auto* band = std::get_if<SparseField>(&need(field, "the field").field))
      return writeBand(file, *band);
    writeField(file, std::get<Field>(field->field),
               {.array = array ? fromName<FieldArray>(array) : FieldArray::Distance});
  });
}
