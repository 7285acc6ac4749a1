// The functions of raymap/c.h about meshes in memory and the grids over them.

#include <raymap/c.h>

#include <string>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"
#include "mesh/strided_mesh.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

MeshView viewOf(const raymap_mesh_arrays& arrays) {
  const auto view = [&](const auto* vertices, const auto* triangles) -> MeshView {
    return {vertices,
            arrays.vertex_count,
            triangles,
            arrays.triangle_count,
            {arrays.vertex_stride, arrays.triangle_stride},
            {arrays.origin[0], arrays.origin[1], arrays.origin[2]}};
  };
  const auto withVertices = [&](const auto* vertices) {
    return arrays.has_64_bit_indices ? view(vertices, static_cast<const uint64_t*>(arrays.triangles))
                                     : view(vertices, static_cast<const uint32_t*>(arrays.triangles));
  };
  return arrays.has_double_vertices ? withVertices(static_cast<const double*>(arrays.vertices))
                                    : withVertices(static_cast<const float*>(arrays.vertices));
}

}  // namespace

raymap_mesh* raymap_mesh_from_arrays(const raymap_mesh_arrays* arrays) {
  return create([&] {
    need(arrays, "raymap_mesh_arrays");
    const raymap_mesh_arrays given = c::read(arrays);
    if (given.vertex_count > 0) need(static_cast<const char*>(given.vertices), "the array of vertices");
    if (given.triangle_count > 0) need(static_cast<const char*>(given.triangles), "the array of triangles");
    auto mesh = std::make_unique<raymap_mesh>();
    mesh->view = viewOf(given);
    return mesh;
  });
}

void raymap_mesh_free(raymap_mesh* mesh) {
  delete mesh;
}

size_t raymap_mesh_vertex_count(const raymap_mesh* mesh) {
  return mesh ? mesh->view.vertexCount : 0;
}

size_t raymap_mesh_triangle_count(const raymap_mesh* mesh) {
  return mesh ? mesh->view.triangleCount : 0;
}

raymap_result raymap_mesh_copy_positions(const raymap_mesh* mesh, double* positions) {
  return guard([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    need(positions, "the array of positions");
    visitTypes(view, [&](const auto& strided) {
      for (size_t v = 0; v < strided.vertexCount(); ++v)
        c::copyVector(view.origin + glm::dvec3(strided.position(v)), positions + 3 * v);
    });
  });
}

raymap_result raymap_mesh_copy_triangles(const raymap_mesh* mesh, uint32_t* indices) {
  return guard([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    need(indices, "the array of indices");
    visitTypes(view, [&](const auto& strided) {
      for (size_t t = 0; t < strided.triangleCount(); ++t)
        for (int c = 0; c < 3; ++c) {
          const uint64_t vertex = strided.triangle(t)[c];
          if (vertex >= strided.vertexCount() || vertex > UINT32_MAX)
            throw Error(ErrorCode::Input, "triangle " + std::to_string(t) + " uses vertex " +
                                              std::to_string(vertex) + ", but there are only " +
                                              std::to_string(strided.vertexCount()));
          indices[3 * t + size_t(c)] = static_cast<uint32_t>(vertex);
        }
    });
  });
}

raymap_result raymap_mesh_bounds(const raymap_mesh* mesh, double min[3], double max[3]) {
  return guard([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    need(min, "the lower corner");
    need(max, "the upper corner");
    validate(view);
    const Box box = bounds(view);
    c::copyVector(box.min, min);
    c::copyVector(box.max, max);
  });
}

raymap_result raymap_fit_grid(const raymap_mesh* mesh, const raymap_options* options, raymap_grid* grid) {
  return guard([&] {
    const MeshView& view = need(mesh, "the mesh").view;
    need(grid, "the grid");
    const GridOptions& wanted = c::optionsOr(options).grid;
    if (!wanted.box) validate(view);
    *grid = c::toC(fitGrid(view, wanted));
  });
}
