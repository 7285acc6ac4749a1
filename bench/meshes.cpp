#include "meshes.h"

#include <raymap/io.h>

#include <algorithm>
#include <unordered_map>

#include "testing/mesh_rows.h"
#include "testing/shapes.h"

namespace raymap::bench {

namespace {

using Positions = std::vector<glm::dvec3>;

Positions positionsOf(const Mesh& mesh) {
  Positions positions;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) positions.push_back(mesh.position(v));
  return positions;
}

Positions vertexNormals(const Positions& positions, const std::vector<glm::uvec3>& triangles) {
  Positions normals(positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 n =
        glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);  // Area-weighted.
    for (int c = 0; c < 3; ++c) normals[t[c]] += n;
  }
  for (glm::dvec3& n : normals) n = glm::length(n) > 0.0 ? glm::normalize(n) : glm::dvec3(0.0);
  return normals;
}

/// Moves every vertex along its normal by a smooth wave of the given height and wave number.
void displace(Positions& positions, const std::vector<glm::uvec3>& triangles, double height, double waves) {
  const Positions normals = vertexNormals(positions, triangles);
  for (size_t v = 0; v < positions.size(); ++v) {
    const glm::dvec3 wave = glm::sin(waves * positions[v]);
    positions[v] += height * (wave.x + wave.y + wave.z) * normals[v];
  }
}

/// Cuts every triangle into four at the middles of its edges.
void subdivide(Positions& positions, std::vector<glm::uvec3>& triangles) {
  std::unordered_map<uint64_t, uint32_t> middles;
  middles.reserve(2 * triangles.size());
  const auto middle = [&](uint32_t a, uint32_t b) {
    const uint64_t edge = (uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    const auto [it, isNew] = middles.try_emplace(edge, static_cast<uint32_t>(positions.size()));
    if (isNew) positions.push_back(0.5 * (positions[a] + positions[b]));
    return it->second;
  };
  std::vector<glm::uvec3> finer;
  finer.reserve(4 * triangles.size());
  for (const glm::uvec3& t : triangles) {
    const uint32_t a = middle(t.x, t.y), b = middle(t.y, t.z), c = middle(t.z, t.x);
    finer.insert(finer.end(), {{t.x, a, c}, {t.y, b, a}, {t.z, c, b}, {a, b, c}});
  }
  triangles = std::move(finer);
}

Mesh bumpySphere() {
  const Mesh round = shapes::sphere(1.0, 6);
  Positions positions = positionsOf(round);
  displace(positions, round.triangles, 0.06, 9.0);
  return makeMesh(positions, round.triangles);
}

Mesh scan() {
  return readMesh(meshFolder() / "draco__bun_zipper.ply");
}

/// Removes the triangles around the vertices that reach farthest in five directions.
Mesh withFiveHoles(Mesh mesh) {
  const Box box = bounds(mesh);
  const double radius = 0.05 * std::max({box.size().x, box.size().y, box.size().z});
  Positions centres;
  for (const glm::dvec3& direction : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0),
                                      glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
    glm::dvec3 farthest = mesh.position(0);
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
      if (glm::dot(direction, mesh.position(v)) > glm::dot(direction, farthest)) farthest = mesh.position(v);
    centres.push_back(farthest);
  }
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return std::any_of(centres.begin(), centres.end(), [&](const glm::dvec3& centre) {
      return glm::distance(centre, mesh.position(t.x)) < radius;
    });
  });
  return mesh;
}

Mesh finer(const Mesh& mesh) {
  const Box box = bounds(mesh);
  const double size = std::max({box.size().x, box.size().y, box.size().z});
  Positions positions = positionsOf(mesh);
  std::vector<glm::uvec3> triangles = mesh.triangles;
  for (int level = 0; level < 2; ++level) subdivide(positions, triangles);
  displace(positions, triangles, 0.0003 * size, 400.0 / size);
  return makeMesh(positions, std::move(triangles));
}

}  // namespace

Mesh benchMesh(const std::string& name) {
  if (name == "scan") return scan();
  if (name == "holes") return withFiveHoles(scan());
  if (name == "million") return finer(scan());
  if (name == "sphere") return bumpySphere();
  return readMesh(name);
}

}  // namespace raymap::bench
