// Peer: OpenVDB's mesh to volume conversion.

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>

#include <limits>

#include "base/parallel.h"
#include "methods.h"

namespace raymap::bench {

namespace {

/// A mesh in the cells of its grid.
struct CellMesh {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;

  explicit CellMesh(const Case& input) {
    points.reserve(input.mesh.vertices.size());
    for (uint32_t v = 0; v < input.mesh.vertices.size(); ++v) {
      const glm::vec3 p((input.mesh.position(v) - input.grid.origin) / input.grid.spacing);
      points.emplace_back(p.x, p.y, p.z);
    }
    triangles.reserve(input.mesh.triangles.size());
    for (const glm::uvec3& t : input.mesh.triangles) triangles.emplace_back(t.x, t.y, t.z);
  }

  openvdb::FloatGrid::Ptr toVolume(double spacing, float outside, float inside) const {
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
    const auto transform = openvdb::math::Transform::createLinearTransform(spacing);
    return openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, outside, inside);
  }
};

}  // namespace

void runOpenvdb(const Case& input, Buffer<float>& values) {
  openvdb::initialize();
  values.resizeUninitialized(input.grid.sampleCount());
  withThreads(input.threads, [&] {
    const float outside = input.band > 0.0 ? float(input.band) : 3.f;
    const float inside = outside > 3.f ? std::numeric_limits<float>::max() : outside;
    const auto grid = CellMesh(input).toVolume(input.grid.spacing, outside, inside);

    const glm::ivec3 last = input.grid.dims - 1;
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox({0, 0, 0}, {last.x, last.y, last.z}), values.data());
    openvdb::tools::copyToDense(*grid, dense);
  });
}

void runOpenvdbBand(const Case& input, Buffer<float>& values) {
  openvdb::initialize();
  values.resizeUninitialized(0);
  withThreads(input.threads, [&] {
    const auto band = float(input.band);
    CellMesh(input).toVolume(input.grid.spacing, band, band);
  });
}

}  // namespace raymap::bench
