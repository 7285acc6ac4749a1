// Krayer & Müller 2019, §3: dynamic data. Linear-blend skinning follows glTF 2.0 (§3.7.3 there).

#include <raymap/animation.h>

namespace raymap {

namespace {

glm::vec3 moved(const AnimatedMesh& mesh, const std::vector<JointMatrix>& matrices, size_t vertex) {
  const glm::dvec4 p(mesh.rest.vertices[vertex], 1.0);
  glm::dvec3 sum(0.0);
  for (int k = 0; k < 4; ++k) {
    const JointMatrix& matrix = matrices[mesh.joints[vertex][k]];
    for (int row = 0; row < 3; ++row)
      sum[row] += double(mesh.weights[vertex][k]) * glm::dot(glm::dvec4(matrix.rows[row]), p);
  }
  return glm::vec3(sum);
}

}  // namespace

Mesh posed(const AnimatedMesh& mesh, double seconds) {
  Mesh result;
  posed(mesh, seconds, result);
  return result;
}

void posed(const AnimatedMesh& mesh, double seconds, Mesh& result) {
  const std::vector<JointMatrix> matrices = jointMatrices(mesh, seconds);
  result.triangles = mesh.rest.triangles;
  result.origin = mesh.origin;
  result.vertices.resize(mesh.rest.vertices.size());
  for (size_t v = 0; v < result.vertices.size(); ++v) result.vertices[v] = moved(mesh, matrices, v);
}

}  // namespace raymap
