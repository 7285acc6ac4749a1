#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/polygons.h>

#include <filesystem>
#include <vector>

#include "call.h"

namespace raymap::python {

std::shared_ptr<MeshHandle> own(Mesh mesh) {
  auto handle = std::make_shared<MeshHandle>();
  handle->owned = std::move(mesh);
  handle->view = handle->owned;
  return handle;
}

namespace {

/// An array of any type in host memory, by its own strides.
using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

/// Views arrays whose layout python/raymap/_inputs.py has checked: three native numbers after each other in
/// each row.
std::shared_ptr<MeshHandle> view(nb::object vertexArray, nb::object faceArray, const Triple& origin) {
  const auto vertices = nb::cast<AnyArray>(vertexArray, false), faces = nb::cast<AnyArray>(faceArray, false);
  auto handle = std::make_shared<MeshHandle>();
  MeshView& mesh = handle->view;
  const auto check = [](const AnyArray& array, bool isType, const char* what) {
    if (!isType || array.ndim() != 2 || array.shape(1) != 3 || (array.shape(0) > 0 && array.stride(1) != 1))
      throw Error(ErrorCode::Usage, what);
  };
  const nb::dlpack::dtype real = vertices.dtype(), whole = faces.dtype();
  check(vertices, real == nb::dtype<float>() || real == nb::dtype<double>(), "vertices: no (n, 3) of floats");
  check(faces, whole == nb::dtype<uint32_t>() || whole == nb::dtype<uint64_t>(),
        "faces: no (n, 3) of unsigned numbers");
  mesh.scalar = real == nb::dtype<float>() ? Scalar::Float : Scalar::Double;
  mesh.index = whole == nb::dtype<uint32_t>() ? MeshView::Index::UInt32 : MeshView::Index::UInt64;
  mesh.vertices = vertices.data();
  mesh.vertexCount = vertices.shape(0);
  mesh.vertexStride = size_t(vertices.stride(0)) * vertices.itemsize();
  mesh.triangles = faces.data();
  mesh.triangleCount = faces.shape(0);
  mesh.triangleStride = size_t(faces.stride(0)) * faces.itemsize();
  mesh.origin = toVector(origin);
  handle->vertices = std::move(vertexArray);
  handle->faces = std::move(faceArray);
  return handle;
}

template <class Number>
using Packed = nb::ndarray<const Number, nb::c_contig, nb::device::cpu>;

/// Returns the triangles of polygons, and the number of polygons that cannot be cut.
std::pair<nb::ndarray<nb::numpy, uint32_t>, size_t> cut(const Packed<double>& positions,
                                                        const Packed<uint32_t>& corners,
                                                        const Packed<uint32_t>& sizes) {
  CutPolygons result;
  {
    const nb::gil_scoped_release release;
    result = cutPolygons({reinterpret_cast<const glm::dvec3*>(positions.data()), positions.size() / 3},
                         {corners.data(), corners.size()}, {sizes.data(), sizes.size()});
  }
  const size_t count = result.triangles.size();
  return {toArray<uint32_t>(std::move(result.triangles), {count, 3}), result.uncut};
}

std::shared_ptr<MeshHandle> load(const std::filesystem::path& path, bool allowEmpty) {
  Call call{nb::none()};
  Mesh mesh;
  std::vector<glm::dvec3> exact;
  call.run([&] { mesh = readMesh(path, {.warn = call.warn(), .allowEmpty = allowEmpty, .exact = &exact}); });
  auto handle = own(std::move(mesh));
  if (exact.empty()) return handle;
  handle->exact = std::move(exact);
  handle->view = MeshView(handle->exact, handle->owned.triangles);
  return handle;
}

std::shared_ptr<AnimatedMesh> loadAnimation(const std::filesystem::path& path, size_t index) {
  Call call{nb::none()};
  auto animation = std::make_shared<AnimatedMesh>();
  call.run([&] { *animation = readAnimatedMesh(path, index, {.warn = call.warn()}); });
  return animation;
}

std::shared_ptr<MeshHandle> poseAt(const AnimatedMesh& animation, double seconds) {
  const nb::gil_scoped_release release;
  return own(posed(animation, seconds));
}

/// Views the vertices of a mesh of our own, about its origin: floats, or doubles of a file that they would
/// round.
nb::ndarray<nb::numpy, nb::ro> vertices(nb::handle_t<MeshHandle> self) {
  const MeshView& mesh = nb::cast<const MeshHandle&>(self).view;
  const size_t shape[] = {mesh.vertexCount, 3};
  const auto type = mesh.scalar == Scalar::Double ? nb::dtype<double>() : nb::dtype<float>();
  return {mesh.vertices, 2, shape, self, nullptr, type};
}

/// Views the triangles of a mesh of our own.
nb::ndarray<nb::numpy, const uint32_t> faces(nb::handle_t<MeshHandle> self) {
  const Mesh& mesh = nb::cast<const MeshHandle&>(self).owned;
  const size_t shape[] = {mesh.triangles.size(), 3};
  return {reinterpret_cast<const uint32_t*>(mesh.triangles.data()), 2, shape, self};
}

}  // namespace

void bindMesh(nb::module_& module) {
  nb::class_<MeshHandle>(module, "Mesh")
      .def(nb::new_(&view), "vertices"_a, "faces"_a, "origin"_a)
      .def("vertices", &vertices)
      .def("faces", &faces)
      .def_prop_ro("origin", [](const MeshHandle& mesh) { return toTriple(mesh.view.origin); })
      .def("bounds",
           [](const MeshHandle& mesh) {
             validate(mesh.view);
             const Box box = bounds(mesh.view);
             return std::pair(toTriple(box.min), toTriple(box.max));
           })
      .def(
          "save",
          [](const MeshHandle& mesh, const std::filesystem::path& path) {
            Call call{nb::none()};
            call.run([&] { writeMesh(path, mesh.view, {.warn = call.warn()}); });
          },
          "path"_a);
  module.def("cut_polygons", &cut, "positions"_a, "corners"_a, "sizes"_a);
  module.def("load_mesh", &load, "path"_a, "allow_empty"_a);
  nb::class_<AnimatedMesh>(module, "Animation")
      .def_prop_ro("duration", &AnimatedMesh::seconds)
      .def("mesh", &poseAt, "time"_a);
  module.def("load_animation", &loadAnimation, "path"_a, "index"_a);
  module.def("mesh_extensions", &meshExtensions);
}

}  // namespace raymap::python
