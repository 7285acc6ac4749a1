#include <raymap/atomic_file.h>
#include <raymap/memory.h>
#include <raymap/threads.h>
#include <raymap/version.h>

#include <filesystem>
#include <ostream>

#include "bindings.h"

namespace {

void writeWhole(const std::filesystem::path& path, const nanobind::bytes& content) {
  const char* const data = content.c_str();
  const auto size = static_cast<std::streamsize>(content.size());
  const nanobind::gil_scoped_release release;
  raymap::writeAtomically(path, [&](std::ostream& out) { out.write(data, size); });
}

}  // namespace

NB_MODULE(_raymap, module) {
  using namespace raymap::python;
  module.doc() = "The C++ library. Use the package raymap, which wraps it.";
  module.def("version", [] { return std::string(raymap::version().text); });
  module.def("set_threads", &raymap::setDefaultThreads, "threads"_a);
  module.def("get_threads", &raymap::defaultThreads);
  module.def("limit_memory", &raymap::limitMemory, "bytes"_a, "strict"_a);
  module.def("memory_left", &raymap::memoryLeft);
  module.def("set_leak_warnings", &nanobind::set_leak_warnings, "on"_a);
  module.def("write_whole", &writeWhole, "path"_a, "content"_a);
  bindErrors(module);
  bindOptions(module);
  bindMesh(module);
  bindDiagnostics(module);
  bindField(module);
  bindGenerate(module);
  bindIsosurface(module);
  bindSurface(module);
  bindScene(module);
  bindSamplePoints(module);
  bindMeasure(module);
  bindRepair(module);
  bindRender(module);
  bindDevices(module);
}
