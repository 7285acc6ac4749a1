#pragma once

// Functions that bind dense fields and narrow bands alike.

#include <raymap/error.h>
#include <raymap/names.h>
#include <raymap/sample.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "bindings.h"

namespace raymap::python {

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

/// Returns whether this names the distances of a narrow band without leaves, which it has nonetheless.
template <class Handle>
bool isEmptyBand(const Handle& handle, std::string_view array) {
  return std::is_same_v<Handle, SparseHandle> && array == name(FieldArray::Distance) &&
         handle.field.distance.empty();
}

template <class Handle>
std::vector<std::string> arrayNames(const Handle& handle) {
  std::vector<std::string> all;
  for (const std::string_view name : names<FieldArray>())
    withArray(handle.field, fromName<FieldArray>(name), [&](const auto& buffer) {
      if (!buffer.empty() || isEmptyBand(handle, name)) all.emplace_back(name);
    });
  return all;
}

/// Throws `Error(Usage)` unless an array has the shape of the field. Those of narrow bands are checked
/// together.
template <class Array>
void checkShape(const FieldHandle& handle, std::string_view name, const Array& array) {
  const glm::ivec3 dims = handle.field.grid.dims;
  for (int axis = 0; axis < 3; ++axis)
    if (array.shape(size_t(axis)) != size_t(std::max(dims[axis], 0)))
      throw Error(ErrorCode::Usage, std::string(name) + " does not have the shape of the field");
}
template <class Array>
void checkShape(const SparseHandle&, std::string_view, const Array&) {}

/// Copies the numbers of an array in the order of its memory.
template <class Handle, class Array>
void setArray(Handle& handle, std::string_view name, const Array& array) {
  checkShape(handle, name, array);
  withArray(handle.field, fromName<FieldArray>(name), [&](auto& buffer) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(buffer[0])>,
                                 std::remove_const_t<typename Array::Scalar>>) {
      buffer.resizeUninitialized(array.size());
      std::copy_n(array.data(), array.size(), buffer.data());
    }
  });
}

using SamplePoints = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

template <class Handle>
nb::ndarray<nb::numpy, float> sampleAt(const Handle& handle, const SamplePoints& points, bool gradients,
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

/// Binds what tells where a field lies.
template <class Handle>
void bindPlacement(nb::class_<Handle>& bound) {
  bound
      .def_prop_ro("dims",
                   [](const Handle& self) {
                     const glm::ivec3 dims = self.field.grid.dims;
                     return std::tuple(dims.x, dims.y, dims.z);
                   })
      .def_prop_ro("origin", [](const Handle& self) { return toTriple(self.field.grid.origin); })
      .def_prop_ro("spacing", [](const Handle& self) { return self.field.grid.spacing; })
      .def_prop_ro("surface_bounds", [](const Handle& self) -> std::optional<Bounds> {
        const Box& box = self.field.surfaceBounds;
        if (box.isEmpty()) return std::nullopt;
        return Bounds{toTriple(box.min), toTriple(box.max)};
      });
}

}  // namespace raymap::python
