#include <raymap/mesh_thickness.h>
#include <raymap/repair.h>
#include <raymap/words.h>

#include <optional>
#include <string>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

nb::dict info(const MeshHandle& mesh, bool isFast, nb::object progress) {
  Call call(std::move(progress));
  Diagnostics found;
  std::optional<SelfIntersections> crossings;
  Verdict verdict;
  std::string thickness;
  call.run([&] {
    const MachineOptions machine = call.on({});
    found = diagnose(mesh.view, {}, machine);
    if (!isFast) crossings = findSelfIntersections(mesh.view, machine);
    verdict = crossings ? judge(mesh.view, found, *crossings, machine) : judge(found, crossings);
    if (!isFast) thickness = describeThickness(mesh.view, verdict, machine);
  });
  nb::dict dict = toPython(found);
  dict["self_intersections"] = crossings ? nb::object(toPython(*crossings)) : nb::none();
  dict["verdict"] = toPython(verdict);
  dict["kind_text"] = describe(verdict, found, crossings);
  dict["defects_text"] = describeDefects(found, crossings);
  dict["thickness_text"] = thickness;
  return dict;
}

}  // namespace

void bindDiagnostics(nb::module_& module) {
  module.def("info", &info, "mesh"_a, "fast"_a, "progress"_a.none());
}

}  // namespace raymap::python
