#pragma once

// Declarations that the files of the Python bindings share. The package `raymap` (python/raymap/) wraps this
// module, raymap._raymap, with names, defaults and documentation for users.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>
#include <raymap/generate.h>
#include <raymap/grid.h>
#include <raymap/mesh.h>
#include <raymap/mesh_view.h>
#include <raymap/named_options.h>
#include <raymap/narrow_band.h>
#include <raymap/surface_pair.h>

#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace raymap::python {

namespace nb = nanobind;
using namespace nb::literals;

using Triple = std::tuple<double, double, double>;
/// Lowest and highest corner.
using Bounds = std::pair<Triple, Triple>;

/// A mesh of our own, or a view of arrays that Python owns.
struct MeshHandle {
  Mesh owned = {};
  std::vector<glm::dvec3> exact = {};  ///< Positions of a file that `owned` would round.
  /// Keep the viewed arrays alive. They are no `nb::ndarray`: NumPy does not let go of what DLPack exported
  /// once the interpreter ends.
  nb::object vertices = {}, faces = {};
  MeshView view = {};  ///< View of `owned`, with `exact` if that has any, or of the arrays.

  MeshHandle() = default;
  MeshHandle(const MeshHandle&) = delete;
  MeshHandle& operator=(const MeshHandle&) = delete;
};

/// A field and what it cost.
struct FieldHandle {
  Field field = {};
  Stats stats = {};
};

inline glm::dvec3 toVector(const Triple& v) {
  return {std::get<0>(v), std::get<1>(v), std::get<2>(v)};
}

inline glm::ivec3 toWhole(const std::tuple<int, int, int>& v) {
  return {std::get<0>(v), std::get<1>(v), std::get<2>(v)};
}

inline Triple toTriple(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// Returns a message as text. A path in it need not be UTF-8.
nb::str toText(std::string_view message);

/// Returns a handle that owns the mesh.
std::shared_ptr<MeshHandle> own(Mesh mesh);

/// Returns a NumPy array of this shape that owns the elements, for example of a vector.
template <class Number, class Elements>
nb::ndarray<nb::numpy, Number> toArray(Elements elements, std::initializer_list<size_t> shape) {
  auto memory = std::make_unique<Elements>(std::move(elements));
  auto* numbers = reinterpret_cast<Number*>(memory->data());
  const nb::capsule owner(memory.release(),
                          [](void* given) noexcept { delete static_cast<Elements*>(given); });
  return {numbers, shape, owner};
}

/// Poses as NumPy lays them out: rows of 4 numbers.
using PoseArray = nb::ndarray<const double, nb::shape<-1, 4, 4>, nb::c_contig, nb::device::cpu>;
std::vector<glm::dmat4> toPoses(const PoseArray& rows);
/// Returns the members of pairs as arrays.
nb::dict pairsToDict(const std::vector<SurfacePair>& pairs);

void bindDevices(nb::module_& module);
void bindDiagnostics(nb::module_& module);
void bindErrors(nb::module_& module);
void bindField(nb::module_& module);
void bindGenerate(nb::module_& module);
void bindIsosurface(nb::module_& module);
void bindMeasure(nb::module_& module);
void bindMesh(nb::module_& module);
void bindOptions(nb::module_& module);
void bindRender(nb::module_& module);
void bindRepair(nb::module_& module);
void bindSamplePoints(nb::module_& module);
void bindScene(nb::module_& module);
void bindSurface(nb::module_& module);

}  // namespace raymap::python
