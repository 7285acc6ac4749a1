#include <raymap/io.h>

#include <algorithm>
#include <filesystem>

#include "call.h"
#include "field_calls.h"

namespace raymap::python {

namespace {

/// Views one array as (n, 8, 8, 8), by leaf, x, y and z; None if the band does not have it.
nb::object viewLeaves(nb::handle_t<SparseHandle> self, std::string_view name) {
  SparseField& field = nb::cast<SparseHandle&>(self).field;
  return withArray(field, fromName<FieldArray>(name), [&](auto& buffer) -> nb::object {
    using Number = std::remove_reference_t<decltype(buffer[0])>;
    if (buffer.empty() && name != "distance") return nb::none();
    constexpr size_t kSide = SparseField::kLeafSide;
    const size_t shape[] = {field.leaves.size(), kSide, kSide, kSide};
    const int64_t strides[] = {kSide * kSide * kSide, 1, kSide, kSide * kSide};
    return nb::cast(nb::ndarray<nb::numpy, Number>(buffer.data(), 4, shape, self, strides));
  });
}

using Wholes = nb::ndarray<nb::numpy, const int32_t>;

Wholes viewOrigins(nb::handle_t<SparseHandle> self) {
  const SparseField& field = nb::cast<SparseHandle&>(self).field;
  const size_t shape[] = {field.leaves.size(), 3};
  return {reinterpret_cast<const int32_t*>(field.leaves.data()), 2, shape, self};
}

static_assert(sizeof(SparseField::Tile) == 4 * sizeof(int32_t));
constexpr int64_t kTileStride = 4;

Wholes viewTileOrigins(nb::handle_t<SparseHandle> self) {
  const SparseField& field = nb::cast<SparseHandle&>(self).field;
  const size_t shape[] = {field.tiles.size(), 3};
  const int64_t strides[] = {kTileStride, 1};
  return {reinterpret_cast<const int32_t*>(field.tiles.data()), 2, shape, self, strides};
}

Wholes viewTileSides(nb::handle_t<SparseHandle> self) {
  const SparseField& field = nb::cast<SparseHandle&>(self).field;
  const size_t shape[] = {field.tiles.size()};
  const int32_t* first = field.tiles.empty() ? nullptr : &field.tiles[0].side;
  return {first, 1, shape, self, &kTileStride};
}

using Origins = nb::ndarray<const int32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Sides = nb::ndarray<const int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using FloatLeaves = nb::ndarray<const float, nb::shape<-1, 8, 8, 8>, nb::c_contig, nb::device::cpu>;
using WholeLeaves = nb::ndarray<const uint32_t, nb::shape<-1, 8, 8, 8>, nb::c_contig, nb::device::cpu>;

/// Returns a band without arrays, for `setArray`.
std::shared_ptr<SparseHandle> makeBand(const std::tuple<int, int, int>& dims, const Triple& origin,
                                       double spacing, double outside, double inside,
                                       const std::optional<Bounds>& surface, const Origins& leaves,
                                       const Origins& tiles, const Sides& sides) {
  auto handle = std::make_shared<SparseHandle>();
  SparseField& field = handle->field;
  const auto [x, y, z] = dims;
  field.grid = {.dims = {x, y, z}, .origin = toVector(origin), .spacing = spacing};
  field.outside = outside;
  field.inside = inside;
  if (surface) field.surfaceBounds = Box{toVector(surface->first), toVector(surface->second)};
  field.leaves.resizeUninitialized(leaves.shape(0));
  std::copy_n(reinterpret_cast<const glm::ivec3*>(leaves.data()), leaves.shape(0), field.leaves.begin());
  for (size_t t = 0; t < std::min(tiles.shape(0), sides.shape(0)); ++t)
    field.tiles.push_back({reinterpret_cast<const glm::ivec3*>(tiles.data())[t], sides.data()[t]});
  return handle;
}

std::shared_ptr<FieldHandle> makeDense(const SparseHandle& self, const AllOptions& options) {
  const nb::gil_scoped_release release;
  auto handle = std::make_shared<FieldHandle>();
  handle->field = toDense(self.field, options.machine);
  return handle;
}

std::shared_ptr<SparseHandle> makeSparse(const FieldHandle& field, const AllOptions& options) {
  const nb::gil_scoped_release release;
  auto handle = std::make_shared<SparseHandle>();
  handle->field = toSparse(field.field, options.band, options.machine);
  return handle;
}

std::shared_ptr<SparseHandle> loadBand(const std::filesystem::path& path, const std::string& grid) {
  Call call{nb::none()};
  auto handle = std::make_shared<SparseHandle>();
  call.run([&] { handle->field = readBand(path, {.warn = call.warn(), .gridName = grid}); });
  return handle;
}

}  // namespace

void bindSparseField(nb::module_& module) {
  nb::class_<SparseHandle> field(module, "SparseField");
  bindPlacement(field);
  field
      .def(nb::new_(&makeBand), "dims"_a, "origin"_a, "spacing"_a, "outside"_a, "inside"_a,
           "surface_bounds"_a.none(), "leaves"_a.noconvert(), "tiles"_a.noconvert(), "sides"_a.noconvert())
      .def("set_floats", &setArray<SparseHandle, FloatLeaves>, "name"_a, "array"_a.noconvert())
      .def("set_wholes", &setArray<SparseHandle, WholeLeaves>, "name"_a, "array"_a.noconvert())
      .def("validate", [](const SparseHandle& self) { validate(self.field); })
      .def("array", &viewLeaves, "name"_a)
      .def("origins", &viewOrigins)
      .def("tile_origins", &viewTileOrigins)
      .def("tile_sides", &viewTileSides)
      .def_prop_ro("arrays", &arrayNames<SparseHandle>)
      .def_prop_ro("outside", [](const SparseHandle& self) { return self.field.outside; })
      .def_prop_ro("inside", [](const SparseHandle& self) { return self.field.inside; })
      .def_prop_ro("active_count", [](const SparseHandle& self) { return self.field.activeCount(); })
      .def_prop_ro("nbytes", [](const SparseHandle& self) { return self.field.bytes(); })
      .def("sample", &sampleAt<SparseHandle>, "points"_a.noconvert(), "gradients"_a, "nan_outside"_a,
           "threads"_a)
      .def("to_dense", &makeDense, "options"_a)
      .def(
          "save",
          [](const SparseHandle& self, const std::filesystem::path& path) { writeBand(path, self.field); },
          "path"_a, nb::call_guard<nb::gil_scoped_release>());
  module.def("load_band", &loadBand, "path"_a, "grid"_a);
  module.def("to_sparse", &makeSparse, "field"_a, "options"_a);
}

}  // namespace raymap::python
