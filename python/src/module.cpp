#include <raymap/threads.h>
#include <raymap/version.h>

#include "bindings.h"

NB_MODULE(_raymap, module) {
  using namespace raymap::python;
  module.doc() = "The C++ library. Use the package raymap, which wraps it.";
  module.def("version", [] { return std::string(raymap::version().text); });
  module.def("set_threads", &raymap::setDefaultThreads, "threads"_a);
  module.def("get_threads", &raymap::defaultThreads);
  bindErrors(module);
  bindMesh(module);
  bindDiagnostics(module);
  bindField(module);
  bindGenerate(module);
  bindIsosurface(module);
  bindSurface(module);
  bindRepair(module);
  bindRender(module);
  bindDevices(module);
}
