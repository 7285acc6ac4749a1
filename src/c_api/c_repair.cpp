// The functions of raymap/c.h that inspect, repair and simplify meshes.

#include <raymap/c.h>
#include <raymap/names.h>
#include <raymap/repair.h>
#include <raymap/simplify.h>
#include <raymap/thickness.h>

#include <cmath>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

raymap_findings findingsOf(const raymap_inspection& inspection) {
  const auto& [found, crossings, verdict] = inspection;
  raymap_findings findings{.size = sizeof(raymap_findings),
                           .kind = c::nameOf(verdict.kind),
                           .remedy = c::nameOf(verdict.remedy),
                           .vertices = found.vertices,
                           .welded_vertices = found.weldedVertices,
                           .triangles = found.triangles,
                           .components = found.components,
                           .open_components = found.openComponents,
                           .inward_components = found.inwardComponents,
                           .sheets = found.sheets,
                           .holes = found.holes.size(),
                           .boundary_edges = found.boundaryEdges,
                           .non_manifold_edges = found.nonManifoldEdges,
                           .flipped_edges = found.flippedEdges,
                           .flipped_faces = found.flippedFaces,
                           .degenerate_faces = found.degenerateFaces,
                           .duplicate_faces = found.duplicateFaces,
                           .double_sided_faces = found.doubleSidedFaces,
                           .crossing_pairs = crossings.pairs,
                           .crossing_faces = crossings.faces.size(),
                           .crossings_complete = crossings.complete,
                           .watertight = found.watertight,
                           .consistently_oriented = found.consistentlyOriented,
                           .balanced = found.balanced,
                           .signed_volume = found.signedVolume,
                           .area = found.area,
                           .min = {},
                           .max = {},
                           .thinnest = verdict.thinnest.value_or(std::nan("")),
                           .voxel_size = verdict.voxelSize.value_or(std::nan("")),
                           .arrangement = c::nameOf(verdict.arrangement),
                           .coplanar_pairs = crossings.coplanarPairs};
  c::copyVector(found.bounds.min, findings.min);
  c::copyVector(found.bounds.max, findings.max);
  return findings;
}

RepairOptions repairOptions(const raymap_repair_options* options) {
  const raymap_repair_options given = c::read(options);
  RepairOptions wanted{.closeHoles = !given.close_holes_in_steps,
                       .offset = given.offset,
                       .shell = given.shell,
                       .drainHole = given.drain_hole,
                       .keepCavities = given.keep_cavities,
                       .remesh = given.remesh,
                       .triangles = size_t(given.triangles),
                       .measure = !given.is_brief};
  if (given.drain_holes != 0) wanted.drainHoles = given.drain_holes;
  if (given.has_drop_smaller) wanted.dropSmaller = given.drop_smaller;
  if (given.min_thickness != 0.0 || given.loses_thin_parts) wanted.minThickness = given.min_thickness;
  if (given.has_base) wanted.base = given.base;
  if (given.has_tolerance) wanted.tolerance = given.tolerance;
  if (const glm::dvec3 down = c::vectorOf(given.down); down != glm::dvec3(0.0)) wanted.down = down;
  return wanted;
}

raymap_repair_numbers numbersOf(const RepairReport& report) {
  return {.size = sizeof(raymap_repair_numbers),
          .solids = report.solids,
          .cavities = report.cavities,
          .hollows = report.hollows,
          .filled_hollows = report.filledHollows,
          .drain_holes = report.holes,
          .dropped = report.dropped.count,
          .filled = report.filled.count,
          .closed_holes = report.closedHoles,
          .kept = report.kept,
          .parts_overlap = report.partsOverlap,
          .watertight = report.after.watertight,
          .consistently_oriented = report.after.consistentlyOriented,
          .volume = report.after.signedVolume,
          .result_from_mesh = report.ofResult.max,
          .mesh_from_result = report.ofMesh.max,
          .lost_share = report.lostShare,
          .buried_share = report.buriedShare};
}

}  // namespace

raymap_inspection* raymap_inspect(const raymap_mesh* mesh, const raymap_options* options) {
  return create([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    const MachineOptions& machine = c::optionsOr(options).machine;
    auto handle = std::make_unique<raymap_inspection>();
    handle->found = diagnose(view, {}, machine);
    handle->crossings = findSelfIntersections(view, machine);
    handle->verdict = judge(view, handle->found, handle->crossings, machine);
    return handle;
  });
}

void raymap_inspection_free(raymap_inspection* inspection) {
  delete inspection;
}

raymap_result raymap_inspection_findings(const raymap_inspection* inspection, raymap_findings* findings) {
  return guard([&] { c::write(findingsOf(need(inspection, "the inspection")), findings); });
}

raymap_result raymap_fit_repair_grid(const raymap_mesh* mesh, const raymap_grid_options* options,
                                     const raymap_repair_options* repair, raymap_grid* grid) {
  return guard([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    need(grid, "the grid");
    validate(view);
    *grid = c::toC(fitRepairGrid(view, c::gridOptions(options), repairOptions(repair)));
  });
}

raymap_repaired* raymap_repair(const raymap_mesh* mesh, const raymap_grid* grid,
                               const raymap_repair_options* repair, const raymap_options* options) {
  return create([&] {
    const raymap_options& given = c::optionsOr(options);
    Repaired made = raymap::repair(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")), given.field,
                                   repairOptions(repair), given.machine);
    auto handle = std::make_unique<raymap_repaired>();
    c::own(handle->mesh, std::move(made.mesh));
    handle->report = std::move(made.report);
    return handle;
  });
}

void raymap_repaired_free(raymap_repaired* repaired) {
  delete repaired;
}

const raymap_mesh* raymap_repaired_mesh(const raymap_repaired* repaired) {
  return repaired ? &repaired->mesh : nullptr;
}

raymap_result raymap_repaired_numbers(const raymap_repaired* repaired, raymap_repair_numbers* numbers) {
  return guard([&] { c::write(numbersOf(need(repaired, "the repaired mesh").report), numbers); });
}

raymap_mesh* raymap_simplify(const raymap_mesh* mesh, const raymap_simplify_options* how,
                             const raymap_options* options, raymap_simplified* simplified) {
  return create([&] {
    const raymap_simplify_options given = c::read(how);
    Simplified made =
        simplify(need(mesh, "the mesh").view,
                 {.tolerance = given.tolerance, .step = given.step, .triangles = size_t(given.triangles)},
                 c::optionsOr(options).machine);
    if (simplified)
      c::write({.size = sizeof(raymap_simplified),
                .deviation = made.deviation,
                .undone = made.undone,
                .tolerance = made.tolerance},
               simplified);
    return c::ownMesh(std::move(made.mesh));
  });
}
