#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/names.h>
#include <raymap/sample.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

/// Calls `use` with the buffer of a field's array.
template <class AField, class Use>
auto withArray(AField& field, std::string_view array, Use&& use) {
  switch (fromName<FieldArray>(array)) {
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

std::vector<std::string_view> arrayNames(const FieldHandle& handle) {
  std::vector<std::string_view> all;
  for (const FieldArray array : handle.field.arrays()) all.push_back(name(array));
  return all;
}

/// Views one array as (nx, ny, nz), x fastest, or of a narrow band as (n, 8, 8, 8), by leaf, x, y and z; None
/// if the field does not have it.
nb::object viewArray(nb::handle_t<FieldHandle> self, std::string_view name) {
  Field& field = nb::cast<FieldHandle&>(self).field;
  if (!field.has(fromName<FieldArray>(name))) return nb::none();
  return withArray(field, name, [&](auto& buffer) -> nb::object {
    using Array = nb::ndarray<nb::numpy, std::remove_reference_t<decltype(buffer[0])>>;
    if (field.narrow) {
      constexpr int64_t kSide = NarrowBand::kLeafSide;
      const size_t shape[] = {field.narrow->leaves.size(), kSide, kSide, kSide};
      const int64_t strides[] = {kSide * kSide * kSide, 1, kSide, kSide * kSide};
      return nb::cast(Array(buffer.data(), 4, shape, self, strides));
    }
    const glm::ivec3 dims = field.grid.dims;
    const size_t shape[] = {size_t(dims.x), size_t(dims.y), size_t(dims.z)};
    const int64_t strides[] = {1, dims.x, int64_t(dims.x) * dims.y};
    return nb::cast(Array(buffer.data(), 3, shape, self, strides));
  });
}

/// Copies the numbers of an array in the order of its memory. Throws `Error(Usage)` unless it has the shape
/// of the field. Those of narrow bands are checked together.
template <class Array>
void setArray(FieldHandle& handle, std::string_view name, const Array& array) {
  const glm::ivec3 dims = handle.field.grid.dims;
  for (int axis = 0; axis < 3 && !handle.field.narrow; ++axis)
    if (array.shape(size_t(axis)) != size_t(std::max(dims[axis], 0)))
      throw Error(ErrorCode::Usage, std::string(name) + " does not have the shape of the field");
  withArray(handle.field, name, [&](auto& buffer) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(buffer[0])>,
                                 std::remove_const_t<typename Array::Scalar>>) {
      buffer.resizeUninitialized(array.size());
      std::copy_n(array.data(), array.size(), buffer.data());
    }
  });
}

using FloatGrid = nb::ndarray<const float, nb::ndim<3>, nb::f_contig, nb::device::cpu>;
using WholeGrid = nb::ndarray<const uint32_t, nb::ndim<3>, nb::f_contig, nb::device::cpu>;
using FloatLeaves = nb::ndarray<const float, nb::shape<-1, 8, 8, 8>, nb::c_contig, nb::device::cpu>;
using WholeLeaves = nb::ndarray<const uint32_t, nb::shape<-1, 8, 8, 8>, nb::c_contig, nb::device::cpu>;

/// Returns a field without arrays, for `setArray`.
std::shared_ptr<FieldHandle> makeField(const std::tuple<int, int, int>& dims, const Triple& origin,
                                       double spacing, double clampDistance,
                                       const std::optional<Bounds>& surface) {
  auto handle = std::make_shared<FieldHandle>();
  handle->field.grid = {.dims = toWhole(dims), .origin = toVector(origin), .spacing = spacing};
  handle->field.clampDistance = clampDistance;
  if (surface) handle->field.surfaceBounds = Box{toVector(surface->first), toVector(surface->second)};
  return handle;
}

// Leaves and tiles of a narrow band.

using Wholes = nb::ndarray<nb::numpy, const int32_t>;

const NarrowBand& bandOf(nb::handle_t<FieldHandle> self) {
  return nb::cast<FieldHandle&>(self).field.narrow.value();
}

Wholes viewOrigins(nb::handle_t<FieldHandle> self) {
  const NarrowBand& band = bandOf(self);
  const size_t shape[] = {band.leaves.size(), 3};
  return {reinterpret_cast<const int32_t*>(band.leaves.data()), 2, shape, self};
}

static_assert(sizeof(NarrowBand::Tile) == 4 * sizeof(int32_t));
constexpr int64_t kTileStride = 4;

Wholes viewTileOrigins(nb::handle_t<FieldHandle> self) {
  const NarrowBand& band = bandOf(self);
  const size_t shape[] = {band.tiles.size(), 3};
  const int64_t strides[] = {kTileStride, 1};
  return {reinterpret_cast<const int32_t*>(band.tiles.data()), 2, shape, self, strides};
}

Wholes viewTileSides(nb::handle_t<FieldHandle> self) {
  const NarrowBand& band = bandOf(self);
  const size_t shape[] = {band.tiles.size()};
  const int32_t* first = band.tiles.empty() ? nullptr : &band.tiles[0].side;
  return {first, 1, shape, self, &kTileStride};
}

using Origins = nb::ndarray<const int32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Sides = nb::ndarray<const int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

/// Makes a field a narrow band with these leaves and tiles.
void setBand(FieldHandle& handle, double outside, double inside, const Origins& leaves, const Origins& tiles,
             const Sides& sides) {
  NarrowBand& band = handle.field.narrow.emplace(NarrowBand{.outside = outside, .inside = inside});
  band.leaves.resizeUninitialized(leaves.shape(0));
  std::copy_n(reinterpret_cast<const glm::ivec3*>(leaves.data()), leaves.shape(0), band.leaves.begin());
  for (size_t t = 0; t < std::min(tiles.shape(0), sides.shape(0)); ++t)
    band.tiles.push_back({reinterpret_cast<const glm::ivec3*>(tiles.data())[t], sides.data()[t]});
}

std::shared_ptr<FieldHandle> makeDense(const FieldHandle& self, const AllOptions& options) {
  const nb::gil_scoped_release release;
  return std::make_shared<FieldHandle>(toDense(self.field, options.machine), self.stats);
}

std::shared_ptr<FieldHandle> makeSparse(const FieldHandle& self, const AllOptions& options) {
  const nb::gil_scoped_release release;
  return std::make_shared<FieldHandle>(toSparse(self.field, options.band, options.machine), self.stats);
}

std::shared_ptr<FieldHandle> load(const std::filesystem::path& path, const std::string& grid, bool sparse) {
  Call call{nb::none()};
  auto handle = std::make_shared<FieldHandle>();
  constexpr std::string_view kFrame[] = {"centre", "scale"};  // _frames.py reads them.
  call.run([&] {
    handle->field = readField(path, {.warn = call.warn(),
                                     .gridName = grid,
                                     .levelSet = sparse ? LevelSet::Narrow : LevelSet::Dense,
                                     .alsoRead = kFrame});
  });
  return handle;
}

using SamplePoints = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

nb::ndarray<nb::numpy, float> sampleAt(const FieldHandle& handle, const SamplePoints& points, bool gradients,
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

std::optional<Bounds> surfaceBounds(const FieldHandle& self) {
  const Box& box = self.field.surfaceBounds;
  if (box.isEmpty()) return std::nullopt;
  return Bounds{toTriple(box.min), toTriple(box.max)};
}

void bindBand(nb::class_<FieldHandle>& field) {
  field.def_prop_ro("is_narrow", [](const FieldHandle& self) { return self.field.narrow.has_value(); })
      .def("set_band", &setBand, "outside"_a, "inside"_a, "leaves"_a.noconvert(), "tiles"_a.noconvert(),
           "sides"_a.noconvert())
      .def("origins", &viewOrigins)
      .def("tile_origins", &viewTileOrigins)
      .def("tile_sides", &viewTileSides)
      .def_prop_ro("outside", [](const FieldHandle& self) { return self.field.narrow.value().outside; })
      .def_prop_ro("inside", [](const FieldHandle& self) { return self.field.narrow.value().inside; })
      .def("to_dense", &makeDense, "options"_a)
      .def("to_sparse", &makeSparse, "options"_a);
}

}  // namespace

void bindField(nb::module_& module) {
  nb::class_<FieldHandle> field(module, "Field");
  field
      .def(nb::new_(&makeField), "dims"_a, "origin"_a, "spacing"_a, "clamp_distance"_a,
           "surface_bounds"_a.none())
      .def_prop_ro("dims",
                   [](const FieldHandle& self) {
                     const glm::ivec3 dims = self.field.grid.dims;
                     return std::tuple(dims.x, dims.y, dims.z);
                   })
      .def_prop_ro("origin", [](const FieldHandle& self) { return toTriple(self.field.grid.origin); })
      .def_prop_ro("spacing", [](const FieldHandle& self) { return self.field.grid.spacing; })
      .def_prop_ro("surface_bounds", &surfaceBounds)
      .def_prop_ro("clamp_distance", [](const FieldHandle& self) { return self.field.clamp(); })
      .def_prop_ro("active_count", [](const FieldHandle& self) { return self.field.activeCount(); })
      .def_prop_ro("nbytes", [](const FieldHandle& self) { return self.field.bytes(); })
      .def("set_floats", &setArray<FloatGrid>, "name"_a, "array"_a.noconvert())
      .def("set_leaf_floats", &setArray<FloatLeaves>, "name"_a, "array"_a.noconvert())
      .def("set_wholes", &setArray<WholeGrid>, "name"_a, "array"_a.noconvert())
      .def("set_leaf_wholes", &setArray<WholeLeaves>, "name"_a, "array"_a.noconvert())
      .def("validate", [](const FieldHandle& self) { validate(self.field); })
      .def("array", &viewArray, "name"_a)
      .def_prop_ro("arrays", &arrayNames)
      .def("stats", [](const FieldHandle& self) { return toPython(self.stats); })
      .def("sample", &sampleAt, "points"_a.noconvert(), "gradients"_a, "nan_outside"_a, "threads"_a)
      .def(
          "save",
          [](const FieldHandle& self, const std::filesystem::path& path, const std::string& array,
             const std::string& format) {
            writeField(path, self.field, {.array = fromName<FieldArray>(array), .format = format});
          },
          "path"_a, "array"_a, "format"_a = "", nb::call_guard<nb::gil_scoped_release>());
  bindBand(field);
  module.def("load_field", &load, "path"_a, "grid"_a, "sparse"_a);
}

}  // namespace raymap::python
