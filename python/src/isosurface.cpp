#include <raymap/isosurface.h>

#include "call.h"

namespace raymap::python {

namespace {

std::shared_ptr<MeshHandle> makeSurface(const FieldHandle& field, const AllOptions& options,
                                        nb::object progress) {
  Call call(std::move(progress));
  Mesh mesh;
  call.run([&] { mesh = isosurface(field.field, options.isosurface, call.on(options.machine)); });
  return own(std::move(mesh));
}

}  // namespace

void bindIsosurface(nb::module_& module) {
  module.def("isosurface", &makeSurface, "field"_a, "options"_a, "progress"_a.none());
}

}  // namespace raymap::python
