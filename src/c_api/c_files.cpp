// The functions of raymap/c.h that read and write files.

#include <raymap/c.h>
#include <raymap/generate_file.h>
#include <raymap/io.h>
#include <raymap/names.h>

#include <utility>
#include <vector>

#include "c_api/c_report.h"
#include "c_api/c_struct.h"

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
    writeField(&need(path, "the path"), c::fieldOf(field),
               {.array = array ? fromName<FieldArray>(array) : FieldArray::Distance});
  });
}

raymap_result raymap_generate_file(const raymap_mesh* mesh, const raymap_grid* grid,
                                   const raymap_field_files* files, const raymap_options* options,
                                   char** report) {
  return guard([&] {
    const raymap_field_files given = c::read(&need(files, "raymap_field_files"));
    const AllOptions& all = c::optionsOr(options);
    const auto text = [](const char* from) { return from ? from : ""; };
    const FieldFiles wanted{.distance = &need(given.distance, "the path of the distance"),
                            .triangle = text(given.triangle),
                            .winding = text(given.winding),
                            .confidence = text(given.confidence),
                            .gridName = text(given.grid_name),
                            .half = given.half,
                            .fullInside = given.full_inside};
    const FileReport made = generateFile(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")),
                                         all.field, wanted, all.machine);
    if (report) *report = c::ownText(textOf(toJson(made)));
  });
}
