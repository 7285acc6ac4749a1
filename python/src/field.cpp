#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "field_calls.h"
#include "records.h"

namespace raymap::python {

namespace {

/// Views one array as (nx, ny, nz), x fastest; None if the field does not have it.
nb::object viewArray(nb::handle_t<FieldHandle> self, std::string_view name) {
  Field& field = nb::cast<FieldHandle&>(self).field;
  return withArray(field, fromName<FieldArray>(name), [&](auto& buffer) -> nb::object {
    using Number = std::remove_reference_t<decltype(buffer[0])>;
    if (buffer.empty()) return nb::none();
    const glm::ivec3 dims = field.grid.dims;
    const size_t shape[] = {size_t(dims.x), size_t(dims.y), size_t(dims.z)};
    const int64_t strides[] = {1, dims.x, int64_t(dims.x) * dims.y};
    return nb::cast(nb::ndarray<nb::numpy, Number>(buffer.data(), 3, shape, self, strides));
  });
}

using FloatGrid = nb::ndarray<const float, nb::ndim<3>, nb::f_contig, nb::device::cpu>;
using WholeGrid = nb::ndarray<const uint32_t, nb::ndim<3>, nb::f_contig, nb::device::cpu>;

/// Returns a field without arrays, for `setArray`.
std::shared_ptr<FieldHandle> makeField(const std::tuple<int, int, int>& dims, const Triple& origin,
                                       double spacing, double clampDistance,
                                       const std::optional<Bounds>& surface) {
  auto handle = std::make_shared<FieldHandle>();
  const auto [x, y, z] = dims;
  handle->field.grid = {.dims = {x, y, z}, .origin = toVector(origin), .spacing = spacing};
  handle->field.clampDistance = clampDistance;
  if (surface) handle->field.surfaceBounds = Box{toVector(surface->first), toVector(surface->second)};
  return handle;
}

std::shared_ptr<FieldHandle> load(const std::filesystem::path& path, const std::string& grid) {
  Call call{nb::none()};
  auto handle = std::make_shared<FieldHandle>();
  constexpr std::string_view kFrame[] = {"centre", "scale"};  // _frames.py reads them.
  call.run(
      [&] { handle->field = readField(path, {.warn = call.warn(), .gridName = grid, .alsoRead = kFrame}); });
  return handle;
}

}  // namespace

void bindField(nb::module_& module) {
  nb::class_<FieldHandle> field(module, "Field");
  bindPlacement(field);
  field
      .def(nb::new_(&makeField), "dims"_a, "origin"_a, "spacing"_a, "clamp_distance"_a,
           "surface_bounds"_a.none())
      .def("set_floats", &setArray<FieldHandle, FloatGrid>, "name"_a, "array"_a.noconvert())
      .def("set_wholes", &setArray<FieldHandle, WholeGrid>, "name"_a, "array"_a.noconvert())
      .def("validate",
           [](const FieldHandle& self) {
             Samples none;
             sample(self.field, {}, {}, none, {.threads = 1});  // Checks the field first.
           })
      .def("array", &viewArray, "name"_a)
      .def_prop_ro("arrays", &arrayNames<FieldHandle>)
      .def_prop_ro("clamp_distance", [](const FieldHandle& self) { return self.field.clampDistance; })
      .def("stats", [](const FieldHandle& self) { return toPython(self.stats); })
      .def("sample", &sampleAt<FieldHandle>, "points"_a.noconvert(), "gradients"_a, "nan_outside"_a,
           "threads"_a)
      .def(
          "save",
          [](const FieldHandle& self, const std::filesystem::path& path, const std::string& array,
             const std::string& format) {
            writeField(path, self.field, {.array = fromName<FieldArray>(array), .format = format});
          },
          "path"_a, "array"_a, "format"_a = "", nb::call_guard<nb::gil_scoped_release>());
  module.def("load_field", &load, "path"_a, "grid"_a);
}

}  // namespace raymap::python
