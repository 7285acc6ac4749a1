#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/names.h>
#include <raymap/sample.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "records.h"

namespace raymap::python {

namespace {

/// Calls `use` with the buffer of a field's array.
template <class AField, class Use>
auto withArray(AField& field, FieldArray array, Use&& use) {
  switch (array) {
    case FieldArray::Winding:
      return use(field.winding);
    case FieldArray::Confidence:
      return use(field.confidence);
    case FieldArray::Triangle:
      return use(field.triangle);
    case FieldArray::Distance:
      break;
  }
  return use(field.distance);
}

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

std::vector<std::string> arrayNames(const FieldHandle& handle) {
  std::vector<std::string> all;
  for (const std::string_view name : names<FieldArray>())
    withArray(handle.field, fromName<FieldArray>(name), [&](const auto& buffer) {
      if (!buffer.empty()) all.emplace_back(name);
    });
  return all;
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

template <class Array>
void setArray(FieldHandle& handle, std::string_view name, const Array& array) {
  withArray(handle.field, fromName<FieldArray>(name), [&](auto& buffer) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(buffer[0])>,
                                 std::remove_const_t<typename Array::Scalar>>) {
      buffer.resizeUninitialized(array.size());
      std::copy_n(array.data(), array.size(), buffer.data());
    }
  });
}

using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

nb::ndarray<nb::numpy, float> samplePoints(const FieldHandle& handle, const Points& points, bool gradients,
                                           bool isNanOutside, int threads) {
  const Outside outside = isNanOutside ? Outside::NaN : Outside::Bound;
  Samples samples;
  {
    const nb::gil_scoped_release release;
    const std::span all(reinterpret_cast<const glm::dvec3*>(points.data()), points.shape(0));
    sample(handle.field, all, {.gradients = gradients, .outside = outside}, samples, {.threads = threads});
  }
  if (gradients) return toArray<float>(std::move(samples.gradient), {points.shape(0), 3});
  return toArray<float>(std::move(samples.distance), {points.shape(0)});
}

std::shared_ptr<FieldHandle> load(const std::filesystem::path& path) {
  Call call{nb::none()};
  auto handle = std::make_shared<FieldHandle>();
  call.run([&] { handle->field = readField(path, {.warn = call.warn()}); });
  return handle;
}

}  // namespace

void bindField(nb::module_& module) {
  nb::class_<FieldHandle>(module, "Field")
      .def(nb::new_(&makeField), "dims"_a, "origin"_a, "spacing"_a, "clamp_distance"_a,
           "surface_bounds"_a.none())
      .def("set_floats", &setArray<FloatGrid>, "name"_a, "array"_a.noconvert())
      .def("set_wholes", &setArray<WholeGrid>, "name"_a, "array"_a.noconvert())
      .def("array", &viewArray, "name"_a)
      .def_prop_ro("arrays", &arrayNames)
      .def_prop_ro("dims",
                   [](const FieldHandle& self) {
                     const glm::ivec3 dims = self.field.grid.dims;
                     return std::tuple(dims.x, dims.y, dims.z);
                   })
      .def_prop_ro("origin", [](const FieldHandle& self) { return toTriple(self.field.grid.origin); })
      .def_prop_ro("spacing", [](const FieldHandle& self) { return self.field.grid.spacing; })
      .def_prop_ro("clamp_distance", [](const FieldHandle& self) { return self.field.clampDistance; })
      .def_prop_ro("surface_bounds",
                   [](const FieldHandle& self) -> std::optional<Bounds> {
                     const Box& box = self.field.surfaceBounds;
                     if (box.isEmpty()) return std::nullopt;
                     return Bounds{toTriple(box.min), toTriple(box.max)};
                   })
      .def("stats", [](const FieldHandle& self) { return toPython(self.stats); })
      .def("sample", &samplePoints, "points"_a.noconvert(), "gradients"_a, "nan_outside"_a, "threads"_a)
      .def(
          "save",
          [](const FieldHandle& self, const std::filesystem::path& path, const std::string& array,
             const std::string& format) {
            writeField(path, self.field, {.array = fromName<FieldArray>(array), .format = format});
          },
          "path"_a, "array"_a, "format"_a = "", nb::call_guard<nb::gil_scoped_release>());
  module.def("load_field", &load, "path"_a);
}

}  // namespace raymap::python
