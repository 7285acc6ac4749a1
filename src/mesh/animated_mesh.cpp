// Krayer & Müller 2019, §3: dynamic data. Joints and tracks follow glTF 2.0 (§3.11 and appendix C there).

#include <raymap/animation.h>
#include <raymap/error.h>
#include <raymap/mesh_view.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "base/text.h"

namespace raymap {

namespace {

using Node = AnimatedMesh::Node;
using Track = AnimatedMesh::Track;

size_t valuesPerTime(const Track& track) {
  return track.interpolation == Track::Interpolation::CubicSpline ? 3 : 1;
}

glm::dquat quaternion(const glm::dvec4& v) {
  return {v.w, v.x, v.y, v.z};
}

/// Evaluates the Hermite spline from `key` to the next key, at `share` (0 to 1) of the way.
glm::dvec4 onSpline(const Track& track, size_t key, double share) {
  const glm::dvec4* v = &track.values[3 * key];
  const double length = track.times[key + 1] - track.times[key];
  const double s = share, s2 = s * s, s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * v[1] + length * (s3 - 2.0 * s2 + s) * v[2] +
         (3.0 * s2 - 2.0 * s3) * v[4] + length * (s3 - s2) * v[3];
}

glm::dvec4 onArc(const glm::dvec4& from, const glm::dvec4& to, double share) {
  const glm::dquat q = glm::slerp(glm::normalize(quaternion(from)), glm::normalize(quaternion(to)), share);
  return {q.x, q.y, q.z, q.w};
}

glm::dvec4 valueAt(const Track& track, double seconds) {
  const std::vector<double>& times = track.times;
  const size_t count = valuesPerTime(track);
  const auto value = [&](size_t key) { return track.values[count * key + count / 2]; };
  if (!(seconds > times.front())) return value(0);
  if (seconds >= times.back()) return value(times.size() - 1);
  const auto next =
      static_cast<size_t>(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
  const size_t key = next - 1;
  const double share = (seconds - times[key]) / (times[next] - times[key]);
  switch (track.interpolation) {
    case Track::Interpolation::Step:
      return value(key);
    case Track::Interpolation::CubicSpline:
      return onSpline(track, key, share);
    default:
      return track.target == Track::Target::Rotation ? onArc(value(key), value(next), share)
                                                     : glm::mix(value(key), value(next), share);
  }
}

void move(Node& node, const Track& track, double seconds) {
  const glm::dvec4 value = valueAt(track, seconds);
  switch (track.target) {
    case Track::Target::Translation:
      node.translation = glm::dvec3(value);
      break;
    case Track::Target::Rotation:
      node.rotation = quaternion(value);
      break;
    case Track::Target::Scale:
      node.scale = glm::dvec3(value);
      break;
    case Track::Target::Weight:
      break;
  }
}

glm::dmat4 transform(const Node& node) {
  return glm::scale(glm::translate(glm::dmat4(1.0), node.translation) *
                        glm::mat4_cast(glm::normalize(node.rotation)),
                    node.scale) *
         node.matrix;
}

/// Returns the transform of every node to world space.
std::vector<glm::dmat4> nodeTransforms(const AnimatedMesh& mesh, double seconds) {
  std::vector<Node> nodes = mesh.nodes;
  for (const Track& track : mesh.tracks)
    if (track.target != Track::Target::Weight) move(nodes[track.node], track, seconds);
  std::vector<glm::dmat4> transforms;
  transforms.reserve(nodes.size());
  for (const Node& node : nodes)
    transforms.push_back(node.parent < 0 ? transform(node)
                                         : transforms[static_cast<size_t>(node.parent)] * transform(node));
  return transforms;
}

JointMatrix rounded(const glm::dmat4& m, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 shift = glm::dvec3(m * glm::dvec4(from, 1.0)) - to;
  JointMatrix result;
  for (int row = 0; row < 3; ++row) result.rows[row] = {m[0][row], m[1][row], m[2][row], shift[row]};
  return result;
}

[[noreturn]] void fail(const std::string& what) {
  throw Error(ErrorCode::Input, "the animated mesh is not valid: " + what);
}

/// Fails with the first number of a value that is not finite.
template <class Value>
void checkFinite(const Value& value, const std::string& what) {
  for (glm::length_t i = 0; i < value.length(); ++i)
    if (!std::isfinite(value[i]))
      fail(what + " holds " + numberText(double(value[i])) + ", which is not finite");
}

void checkFinite(const glm::dmat4& matrix, const std::string& what) {
  for (glm::length_t column = 0; column < 4; ++column) checkFinite(matrix[column], what);
}

void validateVertices(const AnimatedMesh& mesh) {
  const size_t count = mesh.rest.vertices.size();
  if (mesh.joints.size() != count || mesh.weights.size() != count)
    fail(std::to_string(count) + " vertices have " + std::to_string(mesh.joints.size()) +
         " sets of joints and " + std::to_string(mesh.weights.size()) + " of weights");
  for (size_t v = 0; v < count; ++v)
    for (int k = 0; k < 4; ++k)
      if (mesh.joints[v][k] >= mesh.skeleton.size())
        fail("vertex " + std::to_string(v) + " follows joint " + std::to_string(mesh.joints[v][k]) + " of " +
             std::to_string(mesh.skeleton.size()));
  for (size_t v = 0; v < count; ++v) checkFinite(mesh.weights[v], "a weight of vertex " + std::to_string(v));
}

void validateNode(const AnimatedMesh& mesh, size_t index) {
  const Node& node = mesh.nodes[index];
  const std::string what = "node " + std::to_string(index);
  if (node.parent >= static_cast<int>(index))
    fail(what + " hangs on node " + std::to_string(node.parent) + ", which does not come before it");
  checkFinite(node.translation, "the translation of " + what);
  const glm::dquat& turn = node.rotation;
  checkFinite(glm::dvec4(turn.x, turn.y, turn.z, turn.w), "the rotation of " + what);
  checkFinite(node.scale, "the scale of " + what);
  checkFinite(node.matrix, "the matrix of " + what);
}

void validateJoint(const AnimatedMesh& mesh, size_t index) {
  const AnimatedMesh::Joint& joint = mesh.skeleton[index];
  const std::string what = "joint " + std::to_string(index);
  if (joint.node >= mesh.nodes.size())
    fail(what + " is node " + std::to_string(joint.node) + " of " + std::to_string(mesh.nodes.size()));
  checkFinite(joint.inverseBind, "the inverse bind matrix of " + what);
}

void validateTrack(const AnimatedMesh& mesh, size_t index) {
  const Track& track = mesh.tracks[index];
  const std::string what = "track " + std::to_string(index);
  const bool isWeight = track.target == Track::Target::Weight;
  if (track.node >= (isWeight ? mesh.morphs.size() : mesh.nodes.size()))
    fail(what + " moves " + (isWeight ? "morph " : "node ") + std::to_string(track.node));
  if (track.times.empty()) fail(what + " has no times");
  for (size_t i = 0; i < track.times.size(); ++i) {
    if (!std::isfinite(track.times[i]))
      fail("time " + std::to_string(i) + " of " + what + " is " + numberText(track.times[i]) +
           ", which is not finite");
    if (i > 0 && track.times[i] < track.times[i - 1])
      fail(what + " goes back in time: time " + std::to_string(i) + " is " + numberText(track.times[i]) +
           ", after " + numberText(track.times[i - 1]));
  }
  if (track.values.size() != track.times.size() * valuesPerTime(track))
    fail(what + " has " + std::to_string(track.values.size()) + " values for " +
         std::to_string(track.times.size()) + " times");
  for (size_t i = 0; i < track.values.size(); ++i)
    checkFinite(track.values[i], "value " + std::to_string(i) + " of " + what);
}

void validateMorph(const AnimatedMesh& mesh, size_t index) {
  const AnimatedMesh::Morph& morph = mesh.morphs[index];
  const size_t count = mesh.rest.vertices.size(), first = morph.firstVertex;
  if (first > count || morph.offsets.size() > count - first)
    fail("morph " + std::to_string(index) + " moves vertex " +
         std::to_string(first + morph.offsets.size() - 1) + " of " + std::to_string(count));
  if (!std::isfinite(morph.weight))
    fail("morph " + std::to_string(index) + " has the weight " + numberText(morph.weight));
  for (size_t v = 0; v < morph.offsets.size(); ++v)
    checkFinite(morph.offsets[v],
                "the offset of vertex " + std::to_string(first + v) + " by morph " + std::to_string(index));
}

}  // namespace

double AnimatedMesh::seconds() const {
  double last = 0.0;
  for (const Track& track : tracks)
    if (!track.times.empty()) last = std::max(last, track.times.back());
  return last;
}

void validate(const AnimatedMesh& mesh) {
  validate(mesh.rest);
  validateVertices(mesh);
  for (size_t n = 0; n < mesh.nodes.size(); ++n) validateNode(mesh, n);
  for (size_t j = 0; j < mesh.skeleton.size(); ++j) validateJoint(mesh, j);
  for (size_t t = 0; t < mesh.tracks.size(); ++t) validateTrack(mesh, t);
  for (size_t m = 0; m < mesh.morphs.size(); ++m) validateMorph(mesh, m);
}

std::vector<double> morphWeights(const AnimatedMesh& mesh, double seconds) {
  std::vector<double> weights;
  weights.reserve(mesh.morphs.size());
  for (const AnimatedMesh::Morph& morph : mesh.morphs) weights.push_back(morph.weight);
  for (const Track& track : mesh.tracks)
    if (track.target == Track::Target::Weight) weights[track.node] = valueAt(track, seconds).x;
  return weights;
}

std::vector<JointMatrix> jointMatrices(const AnimatedMesh& mesh, double seconds) {
  const std::vector<glm::dmat4> nodes = nodeTransforms(mesh, seconds);
  std::vector<JointMatrix> matrices;
  matrices.reserve(mesh.skeleton.size());
  for (const AnimatedMesh::Joint& joint : mesh.skeleton)
    matrices.push_back(rounded(nodes[joint.node] * joint.inverseBind, mesh.rest.origin, mesh.origin));
  return matrices;
}

}  // namespace raymap
