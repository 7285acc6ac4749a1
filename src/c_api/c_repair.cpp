// The functions of raymap/c.h that inspect, repair and simplify meshes.

#include <raymap/c.h>
#include <raymap/repair.h>
#include <raymap/simplify.h>
#include <raymap/words.h>

#include "c_api/c_report.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

char* raymap_inspect(const raymap_mesh* mesh, const raymap_options* options) {
  return c::report([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    const MachineOptions& machine = c::optionsOr(options).machine;
    const Diagnostics found = diagnose(view, {}, machine);
    const SelfIntersections crossings = findSelfIntersections(view, machine);
    nlohmann::ordered_json json = toJson(Inspection{found, crossings});
    const Verdict verdict = judge(view, found, crossings, machine);
    json["verdict"] = toJson(verdict);
    json["kind_text"] = describe(verdict, found, crossings);
    json["defects_text"] = describeDefects(found, crossings);
    json["thickness_text"] = describeThickness(view, verdict, machine);
    return json;
  });
}

raymap_result raymap_fit_repair_grid(const raymap_mesh* mesh, const raymap_options* options,
                                     raymap_grid* grid) {
  return guard([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    need(grid, "the grid");
    validate(view);
    const AllOptions& given = c::optionsOr(options);
    *grid = c::toC(fitRepairGrid(view, given.grid, given.repair, given.machine));
  });
}

raymap_mesh* raymap_repair(const raymap_mesh* mesh, const raymap_grid* grid, const raymap_options* options,
                           char** report) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    FieldOptions field = given.field;
    field.closeHoles = false;  // `RepairOptions::closeHoles` has the same name.
    Repaired made = repair(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")), field, given.repair,
                           given.machine);
    auto handle = c::ownMesh(std::move(made.mesh));
    if (report) *report = c::ownText(textOf(toJson(made.report)));
    return handle;
  });
}

raymap_mesh* raymap_simplify(const raymap_mesh* mesh, const raymap_options* options, char** report) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    const MeshView& view = need(mesh, "the mesh").view;
    Simplified made = simplify(view, given.simplify, given.machine);
    const SimplifyReport found{made.tolerance, view.triangleCount, made.mesh.triangles.size(),
                               made.deviation};
    auto handle = c::ownMesh(std::move(made.mesh));
    if (report) *report = c::ownText(textOf(toJson(found)));
    return handle;
  });
}
