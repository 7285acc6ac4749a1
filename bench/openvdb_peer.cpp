// Peer: OpenVDB's mesh to volume conversion.

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>

#include <limits>

#include "base/parallel.h"
#include "methods.h"

namespace raymap::bench {

void runOpenvdb(const Case& input, Buffer<float>& values) {
  openvdb::initialize();
  values.resizeUninitialized(input.grid.sampleCount());
  withThreads(input.threads, [&] {
    std::vector<openvdb::Vec3s> points;
    points.reserve(input.mesh.vertices.size());
    for (uint32_t v = 0; v < input.mesh.vertices.size(); ++v) {
      const glm::vec3 p((input.mesh.position(v) - input.grid.origin) / input.grid.spacing);
      points.emplace_back(p.x, p.y, p.z);
    }
    std::vector<openvdb::Vec3I> triangles;
    triangles.reserve(input.mesh.triangles.size());
    for (const glm::uvec3& t : input.mesh.triangles) triangles.emplace_back(t.x, t.y, t.z);

    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
    const auto transform = openvdb::math::Transform::createLinearTransform(input.grid.spacing);
    const float outside = input.band > 0.0 ? float(input.band) : 3.f;
    const float inside = outside > 3.f ? std::numeric_limits<float>::max() : outside;
    const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, outside, inside);

    const glm::ivec3 last = input.grid.dims - 1;
    openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox({0, 0, 0}, {last.x, last.y, last.z}), values.data());
    openvdb::tools::copyToDense(*grid, dense);
  });
}

}  // namespace raymap::bench
