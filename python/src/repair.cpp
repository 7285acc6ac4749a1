#include <raymap/repair.h>

#include <utility>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

/// Returns the mesh, the report and the sources of faces.
nb::tuple repairMesh(const MeshHandle& mesh, const AllOptions& options, nb::object progress) {
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
  const size_t faces = result.faceSource.size();
  return nb::make_tuple(own(std::move(result.mesh)), toPython(result.report),
                        toArray<uint32_t>(std::move(result.faceSource), {faces}));
}

}  // namespace

void bindRepair(nb::module_& module) {
  module.def("repair", &repairMesh, "mesh"_a, "options"_a, "progress"_a.none());
}

}  // namespace raymap::python
