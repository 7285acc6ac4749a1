#include "implicit_mesh.h"

#include <array>
#include <limits>

namespace raymap {

namespace {

constexpr uint32_t kNoVertex = std::numeric_limits<uint32_t>::max();
constexpr double kPullToMean = 0.02;  // Keeps vertices of flat cubes in place without blunting edges.
constexpr double kMargin = 0.01;      // Share of a cube kept to its sides: no two vertices coincide.
constexpr int kBisections = 20;

/// A pattern of inside corners to fill. Corners of a cube have the numbers x + 2y + 4z.
struct Pinch {
  unsigned mask;    // Corners that are used.
  unsigned inside;  // Those of them that are inside.
  int fill;         // Corner to add.
};

constexpr unsigned bits(std::initializer_list<int> corners) {
  unsigned result = 0;
  for (const int corner : corners) result |= 1u << corner;
  return result;
}

/// Lists faces with two opposite corners inside, and cubes with two opposite corners inside or outside.
std::vector<Pinch> listPinches() {
  std::vector<Pinch> pinches;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, a = side << axis;
      const unsigned face = bits({a, a + u, a + v, a + u + v});
      pinches.push_back({face, bits({a, a + u + v}), a + u});
      pinches.push_back({face, bits({a + u, a + v}), a});
    }
  for (int corner = 0; corner < 4; ++corner) {
    const unsigned pair = bits({corner, 7 - corner});
    pinches.push_back({255, pair, corner ^ 1});
    pinches.push_back({255, 255 - pair, corner});
  }
  return pinches;
}

using Implicit = std::function<double(const glm::dvec3&)>;

glm::dvec3 gradient(const Implicit& implicit, const glm::dvec3& p, double step) {
  glm::dvec3 g;
  for (int a = 0; a < 3; ++a) {
    glm::dvec3 d(0.0);
    d[a] = step;
    g[a] = implicit(p + d) - implicit(p - d);
  }
  const double length = glm::length(g);
  return length > 0.0 ? g / length : g;
}

glm::dvec3 findCrossing(const Implicit& implicit, glm::dvec3 inside, glm::dvec3 outside) {
  for (int i = 0; i < kBisections; ++i) {
    const glm::dvec3 middle = 0.5 * (inside + outside);
    (implicit(middle) < 0.0 ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

/// Finds the point closest to all planes added.
class PlaneFit {
 public:
  void add(const glm::dvec3& point, const glm::dvec3& normal) {
    planes_ += glm::outerProduct(normal, normal);
    offsets_ += glm::dot(normal, point) * normal;
    sum_ += point;
    ++count_;
  }
  glm::dvec3 solve() const {
    const glm::dvec3 mean = sum_ / double(count_);
    const double pull = kPullToMean * count_;
    return glm::inverse(planes_ + glm::dmat3(pull)) * (offsets_ + pull * mean);
  }

 private:
  glm::dmat3 planes_{0.0};
  glm::dvec3 offsets_{0.0};
  glm::dvec3 sum_{0.0};
  int count_ = 0;
};

class ImplicitMesh {
 public:
  ImplicitMesh(const Implicit& implicit, const Box& box, double spacing)
      : implicit_(implicit), origin_(box.min), spacing_(spacing), dims_(glm::ceil(box.size() / spacing)) {
    isInside_.reserve(size_t(dims_.x + 1) * (dims_.y + 1) * (dims_.z + 1));
    for (int k = 0; k <= dims_.z; ++k)
      for (int j = 0; j <= dims_.y; ++j)
        for (int i = 0; i <= dims_.x; ++i) isInside_.push_back(implicit(position({i, j, k})) < 0.0);
  }

  Mesh run() {
    while (fillPinches()) {
    }
    vertexOfCube_.assign(isInside_.size(), kNoVertex);
    forEachCube([&](const glm::ivec3& node) {
      for (int axis = 0; axis < 3; ++axis) crossEdge(node, axis);
    });
    for (size_t v = 0; v < fits_.size(); ++v) {
      const glm::dvec3 low = position(cubes_[v]);
      positions_.push_back(
          glm::clamp(fits_[v].solve(), low + kMargin * spacing_, low + (1.0 - kMargin) * spacing_));
    }
    for (const Quad& quad : quads_) split(quad);
    return makeMesh(positions_, std::move(triangles_));
  }

 private:
  using Quad = std::array<uint32_t, 4>;

  glm::dvec3 position(const glm::ivec3& node) const { return origin_ + spacing_ * glm::dvec3(node); }
  size_t index(const glm::ivec3& node) const {
    return (size_t(node.z) * (dims_.y + 1) + node.y) * (dims_.x + 1) + node.x;
  }
  static glm::ivec3 along(int axis) {
    glm::ivec3 step(0);
    step[axis % 3] = 1;
    return step;
  }

  template <class Work>
  void forEachCube(Work&& work) const {
    for (int k = 0; k < dims_.z; ++k)
      for (int j = 0; j < dims_.y; ++j)
        for (int i = 0; i < dims_.x; ++i) work(glm::ivec3(i, j, k));
  }

  /// Adds a node where the solid touches itself only at an edge or a corner: more than one surface would pass
  /// through a cube there. Returns whether it found such a place.
  bool fillPinches() {
    bool isChanged = false;
    forEachCube([&](const glm::ivec3& cube) {
      std::array<size_t, 8> nodes;
      unsigned inside = 0;
      for (int c = 0; c < 8; ++c) {
        nodes[c] = index(cube + glm::ivec3(c & 1, c >> 1 & 1, c >> 2));
        inside |= unsigned(isInside_[nodes[c]]) << c;
      }
      for (const auto& [mask, pattern, fill] : pinches_)
        if ((inside & mask) == pattern) {
          isInside_[nodes[fill]] = isChanged = true;
          return;
        }
    });
    return isChanged;
  }

  /// Adds the surface's plane at a crossed edge to the four cubes around, and joins them by a quad.
  void crossEdge(const glm::ivec3& node, int axis) {
    const glm::ivec3 end = node + along(axis), u = along(axis + 1), v = along(axis + 2);
    const bool isIn = isInside_[index(node)];
    if (isIn == isInside_[index(end)]) return;
    const glm::dvec3 crossing =
        findCrossing(implicit_, position(isIn ? node : end), position(isIn ? end : node));
    const glm::dvec3 normal = gradient(implicit_, crossing, 1e-3 * spacing_);
    Quad quad{};
    const std::array<glm::ivec3, 4> around{node - u - v, node - v, node, node - u};
    for (int c = 0; c < 4; ++c) {
      quad[c] = vertexOf(around[c]);
      fits_[quad[c]].add(crossing, normal);
    }
    if (!isIn) std::swap(quad[1], quad[3]);
    quads_.push_back(quad);
  }

  uint32_t vertexOf(const glm::ivec3& cube) {
    uint32_t& vertex = vertexOfCube_[index(cube)];
    if (vertex == kNoVertex) {
      vertex = static_cast<uint32_t>(fits_.size());
      fits_.emplace_back();
      cubes_.push_back(cube);
    }
    return vertex;
  }

  /// Splits a quad along the shorter diagonal, which follows sharp edges.
  void split(const Quad& q) {
    const auto length = [&](int a, int b) { return glm::distance(positions_[q[a]], positions_[q[b]]); };
    if (length(0, 2) <= length(1, 3))
      triangles_.insert(triangles_.end(), {{q[0], q[1], q[2]}, {q[0], q[2], q[3]}});
    else
      triangles_.insert(triangles_.end(), {{q[0], q[1], q[3]}, {q[1], q[2], q[3]}});
  }

  const std::vector<Pinch> pinches_ = listPinches();
  const Implicit& implicit_;
  glm::dvec3 origin_;
  double spacing_;
  glm::ivec3 dims_;
  std::vector<bool> isInside_;          // Per node.
  std::vector<uint32_t> vertexOfCube_;  // By the cube's lowest node.
  std::vector<PlaneFit> fits_;          // Per vertex.
  std::vector<glm::ivec3> cubes_;       // Cube of each vertex.
  std::vector<Quad> quads_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
};

}  // namespace

Mesh meshImplicit(const Implicit& implicit, const Box& box, double spacing) {
  return ImplicitMesh(implicit, box, spacing).run();
}

}  // namespace raymap
