#include <raymap/diagnostics.h>
#include <raymap/thickness.h>

#include <optional>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

nb::dict info(const MeshHandle& mesh, bool isFast, nb::object progress) {
  Call call(std::move(progress));
  Diagnostics found;
  std::optional<SelfIntersections> crossings;
  Verdict verdict;
  call.run([&] {
    const MachineOptions machine = call.on({});
    found = diagnose(mesh.view, {}, machine);
    if (!isFast) crossings = findSelfIntersections(mesh.view, machine);
    verdict = crossings ? judge(mesh.view, found, *crossings, machine) : judge(found, crossings);
  });
  nb::dict dict = toPython(found);
  dict["self_intersections"] = crossings ? nb::object(toPython(*crossings)) : nb::none();
  dict["verdict"] = toPython(verdict);
  return dict;
}

}  // namespace

void bindDiagnostics(nb::module_& module) {
  module.def("info", &info, "mesh"_a, "fast"_a, "progress"_a.none());
}

}  // namespace raymap::python
