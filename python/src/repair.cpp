#include <raymap/repair.h>

#include <utility>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

/// Returns the mesh and the report.
std::pair<std::shared_ptr<MeshHandle>, nb::dict> repairMesh(
    const MeshHandle& mesh, std::optional<int> resolution, double voxelSize, const FieldOptions& options,
    const RepairOptions& how, const MachineOptions& machine, nb::object progress) {
  Call call(std::move(progress));
  Repaired result;
  call.run([&] {
    validate(mesh.view);
    const MachineOptions running = call.on(machine);
    const Grid grid =
        fitRepairGrid(mesh.view, {.resolution = resolution, .voxelSize = voxelSize}, how, running);
    result = repair(mesh.view, grid, options, how, running);
  });
  return {own(std::move(result.mesh)), toPython(result.report)};
}

}  // namespace

void bindRepair(nb::module_& module) {
  nb::class_<RepairOptions>(module, "RepairOptions")
      .def(nb::init<>())
      .def_rw("close_holes", &RepairOptions::closeHoles)
      .def_rw("offset", &RepairOptions::offset)
      .def_rw("shell", &RepairOptions::shell)
      .def_rw("drain_hole", &RepairOptions::drainHole)
      .def_rw("drain_holes", &RepairOptions::drainHoles)
      .def_rw("drop_smaller", &RepairOptions::dropSmaller)
      .def_rw("keep_cavities", &RepairOptions::keepCavities)
      .def_rw("base", &RepairOptions::base)
      .def_rw("remesh", &RepairOptions::remesh)
      .def_rw("triangles", &RepairOptions::triangles)
      .def_prop_rw(
          "min_thickness", [](const RepairOptions& self) { return self.minThickness.value_or(-1.0); },
          [](RepairOptions& self, double thickness) { self.minThickness = thickness; })
      .def_prop_rw(
          "tolerance", [](const RepairOptions& self) { return self.tolerance.value_or(-1.0); },
          [](RepairOptions& self, double tolerance) { self.tolerance = tolerance; })
      .def_prop_rw(
          "down", [](const RepairOptions& self) { return toTriple(self.down); },
          [](RepairOptions& self, const Triple& down) { self.down = toVector(down); });
  module.def("repair", &repairMesh, "mesh"_a, "resolution"_a.none(), "voxel_size"_a, "options"_a, "repair"_a,
             "machine"_a, "progress"_a.none());
}

}  // namespace raymap::python
