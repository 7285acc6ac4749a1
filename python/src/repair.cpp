#include <raymap/repair.h>

#include <utility>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

/// Returns the mesh and the report.
std::pair<std::shared_ptr<MeshHandle>, nb::dict> repairMesh(const MeshHandle& mesh, const AllOptions& options,
                                                            nb::object progress) {
  Call call(std::move(progress));
  Repaired result;
  call.run([&] {
    validate(mesh.view);
    const MachineOptions machine = call.on(options.machine);
    const Grid grid = fitRepairGrid(mesh.view, options.grid, options.repair, machine);
    FieldOptions field = options.field;
    field.closeHoles = false;  // `RepairOptions::closeHoles` has the same name.
    result = repair(mesh.view, grid, field, options.repair, machine);
  });
  return {own(std::move(result.mesh)), toPython(result.report)};
}

}  // namespace

void bindRepair(nb::module_& module) {
  module.def("repair", &repairMesh, "mesh"_a, "options"_a, "progress"_a.none());
}

}  // namespace raymap::python
