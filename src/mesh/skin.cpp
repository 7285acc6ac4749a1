// Krayer & Müller 2019, §3: dynamic data. Linear-blend skinning follows glTF 2.0 (§3.7.3 there).

#include <raymap/animation.h>

namespace raymap {

namespace {

/// Returns the vertices of `rest`, moved by the morphs.
std::vector<glm::dvec3> morphed(const AnimatedMesh& mesh, double seconds) {
  std::vector<glm::dvec3> result(mesh.rest.vertices.begin(), mesh.rest.vertices.end());
  const std::vector<double> weights = morphWeights(mesh, seconds);
  for (size_t m = 0; m < weights.size(); ++m) {
    if (weights[m] == 0.0) continue;
    const AnimatedMesh::Morph& morph = mesh.morphs[m];
    for (size_t v = 0; v < morph.offsets.size(); ++v)
      result[morph.firstVertex + v] += weights[m] * glm::dvec3(morph.offsets[v]);
  }
  return result;
}

glm::vec3 moved(const AnimatedMesh& mesh, const std::vector<JointMatrix>& matrices,
                const glm::dvec3& position, size_t vertex) {
  const glm::dvec4 p(position, 1.0);
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
  const std::vector<glm::dvec3> rest = morphed(mesh, seconds);
  result.triangles = mesh.rest.triangles;
  result.origin = mesh.origin;
  result.vertices.resize(rest.size());
  for (size_t v = 0; v < result.vertices.size(); ++v) result.vertices[v] = moved(mesh, matrices, rest[v], v);
}

}  // namespace raymap
