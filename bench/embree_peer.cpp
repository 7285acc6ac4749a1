// Peer: exact distance by Embree point queries.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "methods.h"

namespace raymap::bench {

namespace {

/// Part of the triangle that the closest point lies on.
enum class Feature { CornerA, CornerB, CornerC, EdgeAb, EdgeBc, EdgeCa, Face };

struct ClosestPoint {
  glm::vec3 point;
  Feature feature;
};

/// Ericson, Real-Time Collision Detection, 2005, §5.1.5.
ClosestPoint closestPoint(const glm::vec3& p, const std::array<glm::vec3, 3>& t) {
  const glm::vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.f && d2 <= 0.f) return {t[0], Feature::CornerA};
  const glm::vec3 bp = p - t[1];
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.f && d4 <= d3) return {t[1], Feature::CornerB};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.f && d1 >= 0.f && d3 <= 0.f) return {t[0] + d1 / (d1 - d3) * ab, Feature::EdgeAb};
  const glm::vec3 cp = p - t[2];
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.f && d5 <= d6) return {t[2], Feature::CornerC};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.f && d2 >= 0.f && d6 <= 0.f) return {t[0] + d2 / (d2 - d6) * ac, Feature::EdgeCa};
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0.f && d4 - d3 >= 0.f && d5 - d6 >= 0.f)
    return {t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]), Feature::EdgeBc};
  const float scale = 1.f / (va + vb + vc);
  return {t[0] + vb * scale * ab + vc * scale * ac, Feature::Face};
}

/// Angle-weighted pseudo-normals (Bærentzen & Aanæs 2005) of every triangle's corners, edges and face.
class PseudoNormals {
 public:
  explicit PseudoNormals(const Mesh& mesh)
      : mesh_(mesh), corners_(mesh.vertices.size()), faces_(mesh.triangles.size()) {
    edges_.resize(mesh.triangles.size());
    std::vector<std::pair<uint64_t, uint32_t>> halfEdges;
    halfEdges.reserve(3 * mesh.triangles.size());
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const glm::uvec3 f = mesh.triangles[t];
      const std::array<glm::vec3, 3> p{mesh.vertices[f.x], mesh.vertices[f.y], mesh.vertices[f.z]};
      const glm::vec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
      faces_[t] = glm::dot(n, n) > 0.f ? glm::normalize(n) : n;
      for (int c = 0; c < 3; ++c) {
        const glm::vec3 a = p[(c + 1) % 3] - p[c], b = p[(c + 2) % 3] - p[c];
        corners_[f[c]] += std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * faces_[t];
        const uint32_t u = f[c], v = f[(c + 1) % 3];
        halfEdges.emplace_back((uint64_t{std::min(u, v)} << 32) | std::max(u, v), 3 * t + c);
      }
    }
    parallelSort(halfEdges.begin(), halfEdges.end());
    for (size_t begin = 0, end = 0; begin < halfEdges.size(); begin = end) {
      glm::vec3 sum(0.f);
      for (; end < halfEdges.size() && halfEdges[end].first == halfEdges[begin].first; ++end)
        sum += faces_[halfEdges[end].second / 3];
      for (size_t e = begin; e < end; ++e) edges_[halfEdges[e].second / 3][halfEdges[e].second % 3] = sum;
    }
  }

  glm::vec3 operator()(uint32_t triangle, Feature feature) const {
    switch (feature) {
      case Feature::CornerA:
        return corners_[mesh_.triangles[triangle].x];
      case Feature::CornerB:
        return corners_[mesh_.triangles[triangle].y];
      case Feature::CornerC:
        return corners_[mesh_.triangles[triangle].z];
      case Feature::EdgeAb:
        return edges_[triangle][0];
      case Feature::EdgeBc:
        return edges_[triangle][1];
      case Feature::EdgeCa:
        return edges_[triangle][2];
      case Feature::Face:
        break;
    }
    return faces_[triangle];
  }

 private:
  const Mesh& mesh_;
  std::vector<glm::vec3> corners_;
  std::vector<glm::vec3> faces_;
  std::vector<std::array<glm::vec3, 3>> edges_;
};

/// One thread's queries, from sample to sample.
struct Walk {
  const std::vector<std::array<glm::vec3, 3>>* triangles = nullptr;
  uint32_t closest = 0;
  float squared = INFINITY;

  bool visit(const glm::vec3& p, uint32_t triangle) {
    const glm::vec3 offset = closestPoint(p, (*triangles)[triangle]).point - p;
    const float distance2 = glm::dot(offset, offset);
    if (distance2 >= squared) return false;
    squared = distance2;
    closest = triangle;
    return true;
  }
};

bool visitTriangle(RTCPointQueryFunctionArguments* arguments) {
  Walk& walk = *static_cast<Walk*>(arguments->userPtr);
  RTCPointQuery& query = *arguments->query;
  if (!walk.visit({query.x, query.y, query.z}, arguments->primID)) return false;
  query.radius = std::sqrt(walk.squared);
  return true;
}

struct Scene {
  RTCDevice device;
  RTCScene scene;

  Scene(const Mesh& mesh, int threads) {
    device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.vertices.size()));
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
    auto* triangles = static_cast<glm::uvec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    rtcSetGeometryPointQueryFunction(geometry, visitTriangle);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  ~Scene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
};

float signedDistance(const glm::vec3& p, RTCScene scene, const PseudoNormals& normals, Walk& walk) {
  walk.squared = INFINITY;
  walk.visit(p, walk.closest);
  RTCPointQuery query{p.x, p.y, p.z, 0.f, std::sqrt(walk.squared)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene, &query, &context, nullptr, &walk);
  const ClosestPoint closest = closestPoint(p, (*walk.triangles)[walk.closest]);
  const bool outside = glm::dot(p - closest.point, normals(walk.closest, closest.feature)) >= 0.f;
  const float distance = std::sqrt(walk.squared);
  return outside ? distance : -distance;
}

std::vector<std::array<glm::vec3, 3>> cornersOf(const Mesh& mesh) {
  std::vector<std::array<glm::vec3, 3>> triangles(mesh.triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) triangles[t][c] = mesh.vertices[mesh.triangles[t][c]];
  return triangles;
}

/// Visits one z slice back and forth along x and y, so that each sample is adjacent to the one before.
void fillSlice(const Case& input, RTCScene scene, const PseudoNormals& normals, Walk walk, int k,
               float* slice) {
  const glm::ivec3 dims = input.grid.dims;
  for (int j = 0; j < dims.y; ++j)
    for (int step = 0; step < dims.x; ++step) {
      const int i = j % 2 == 0 ? step : dims.x - 1 - step;
      const glm::vec3 p(input.grid.position({i, j, k}) - input.mesh.origin);
      slice[size_t(j) * dims.x + i] = signedDistance(p, scene, normals, walk);
    }
}

}  // namespace

void runEmbree(const Case& input, Buffer<float>& values) {
  values.resizeUninitialized(input.grid.sampleCount());
  const Scene scene(input.mesh, input.threads);
  withThreads(input.threads, [&] {
    const PseudoNormals normals(input.mesh);
    const std::vector<std::array<glm::vec3, 3>> triangles = cornersOf(input.mesh);
    parallelFor(input.grid.dims.z, 1, [&](size_t k, size_t) {
      fillSlice(input, scene.scene, normals, Walk{&triangles, 0, INFINITY}, int(k),
                values.data() + input.grid.index({0, 0, int(k)}));
    });
  });
}

void runEmbreePoints(const Case& input, Buffer<float>& values) {
  constexpr size_t kPointsPerTask = 4096;
  const Scene scene(input.mesh, input.threads);
  const glm::dvec3 origin = input.mesh.origin;
  withThreads(input.threads, [&] {
    const PseudoNormals normals(input.mesh);
    const std::vector<std::array<glm::vec3, 3>> triangles = cornersOf(input.mesh);
    input.prepared();
    values.resizeUninitialized(input.points.size());
    parallelFor(input.points.size(), kPointsPerTask, [&](size_t begin, size_t end) {
      Walk walk{&triangles, 0, INFINITY};
      for (size_t i = begin; i < end; ++i)
        values[i] =
            signedDistance(glm::vec3(glm::dvec3(input.points[i]) - origin), scene.scene, normals, walk);
    });
  });
}

}  // namespace raymap::bench
