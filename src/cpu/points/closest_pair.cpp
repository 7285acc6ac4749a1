// The least distance of two surfaces: branch and bound over pairs of nodes of their trees.

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "cpu/points/segment_crossings.h"
#include "cpu/points/surface_pairs.h"
#include "cpu/points/triangle_pair.h"
#include "method/pose.h"

namespace raymap::cpu {

namespace {

/// Lengths that a pose moves may be longer by this factor, as poses are rigid within 1e-5.
constexpr double kStretch = 1.0001;

/// Disc with thickness around a node, in the units of the first mesh about its origin.
struct Disc {
  glm::dvec3 centre, normal;
  double radius, half;

  /// Returns a lower bound on the distance to another one, seen along and across the normal of this one.
  double beyond(const Disc& other) const {
    const glm::dvec3 to = other.centre - centre;
    const double height = glm::dot(to, normal),
                 cosine = std::min(1.0, std::abs(glm::dot(normal, other.normal))),
                 sine = std::sqrt(1.0 - cosine * cosine);
    const double along = std::abs(height) - half - other.radius * sine - other.half * cosine;
    const double reach = std::sqrt(other.radius * other.radius + other.half * other.half);
    const double across = std::sqrt(std::max(glm::dot(to, to) - height * height, 0.0)) - radius -
                          std::min(other.radius + other.half * sine, reach);
    return glm::length(glm::max(glm::dvec2(along, across), 0.0));
  }
  /// Returns how far it reaches from its centre along a unit vector.
  double reach(const glm::dvec3& along) const {
    const double cosine = std::min(1.0, std::abs(glm::dot(along, normal)));
    return radius * std::sqrt(1.0 - cosine * cosine) + half * cosine;
  }
};

struct Node {
  uint32_t number, level;
  Disc disc;
};

/// One of the two surfaces, and how it lies in the coordinates of the first, about its origin.
class Side {
 public:
  Side(const PreparedSurface& surface, const glm::dmat4& pose, const glm::dvec3& origin)
      : surface_(surface),
        pose_(pose),
        cells_(surface.grid.origin),
        scale_(kStretch * scaleOf(pose)),
        slack_(scale_ * double(slackOf(surface.tree, surface.grid.dims)) * surface.grid.spacing) {
    const glm::dvec3 shift = moved(pose, surface.mesh.origin) - origin;
    cells_ -= surface.mesh.origin;
    pose_[3] = glm::dvec4(shift, 1.0);
  }

  double slack() const { return slack_; }
  Node nodeAt(uint32_t number, uint32_t level) const {
    const DiscPacket& discs = surface_.tree.discs(number / kPacket);
    const uint32_t lane = number % kPacket;
    const double spacing = surface_.grid.spacing;
    const glm::dvec3 centre(discs.cx[lane], discs.cy[lane], discs.cz[lane]),
        normal(discs.nx[lane], discs.ny[lane], discs.nz[lane]);
    return {number,
            level,
            {moved(pose_, cells_ + spacing * centre), turned(pose_, normal),
             scale_ * spacing * double(discs.radius[lane]),
             scale_ * spacing * double(discs.halfThickness[lane])}};
  }
  Node root() const {
    const auto level = uint32_t(surface_.tree.levels().size() - 1);
    return nodeAt(surface_.tree.root(), level);
  }

  /// Visits the nodes below one that is no leaf.
  template <class Visit>
  void forEachChild(const Node& node, Visit&& visit) const {
    const SurfaceTree::Level below = surface_.tree.levels()[node.level - 1];
    const uint32_t first = surface_.tree.childPacket(node.number, node.level) * kPacket,
                   end = std::min(first + kPacket, below.start + below.count);
    for (uint32_t child = first; child < end; ++child) visit(nodeAt(child, node.level - 1));
  }

  /// Triangles of a leaf, and the box of each.
  struct Leaf {
    std::array<uint32_t, kPacket> ids;
    std::array<Corners, kPacket> corners;
    std::array<Box, kPacket> boxes;
  };
  Leaf leaf(const Node& node) const {
    Leaf leaf;
    for (uint32_t lane = 0; lane < kPacket; ++lane) {
      leaf.ids[lane] = surface_.tree.triangleId(node.number * kPacket + lane);
      leaf.corners[lane] = surface_.mesh.corners(surface_.mesh.triangles[leaf.ids[lane]]);
      for (glm::dvec3& corner : leaf.corners[lane]) corner = moved(pose_, corner);
      const auto& [a, b, c] = leaf.corners[lane];
      leaf.boxes[lane] = {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
    }
    return leaf;
  }

 private:
  const PreparedSurface& surface_;
  glm::dmat4 pose_;
  glm::dvec3 cells_;  // Where cell 0 lies, about the mesh's origin.
  double scale_;      // Of lengths, at most.
  double slack_;      // Exceeds the errors of the discs.
};

/// Returns how far two boxes are apart, squared.
double squaredGap(const Box& a, const Box& b) {
  const glm::dvec3 gap = glm::max(glm::max(a.min - b.max, b.min - a.max), 0.0);
  return glm::dot(gap, gap);
}

class PairSearch {
 public:
  PairSearch(const Side& a, const Side& b, double most, Progress& progress)
      : a_(a), b_(b), slack_(a.slack() + b.slack()), progress_(progress) {
    found_.distance = most;
    squared_ = most * most;
  }

  SurfacePair search() {
    const Node a = a_.root(), b = b_.root();
    measureFirst(a, b);
    open(a, b);
    while (!open_.empty() && open_.front().bound <= found_.distance + slack_ && squared_ > 0.0) {
      std::ranges::pop_heap(open_, isLater);
      const Open next = open_.back();
      open_.pop_back();
      visit(a_.nodeAt(next.a, next.levelOfA), b_.nodeAt(next.b, next.levelOfB));
    }
    found_.bound = found_.distance;
    return found_;
  }

 private:
  /// Measures two leaves that seem to be close, so that much can be left out from the start.
  void measureFirst(Node a, Node b) {
    while (a.level > 0 || b.level > 0) {
      const bool isFirst = opensFirst(a, b);
      const Node &opened = isFirst ? a : b, &other = isFirst ? b : a;
      Node best = opened;
      double least = INFINITY;
      (isFirst ? a_ : b_).forEachChild(opened, [&](const Node& child) {
        const double between = glm::distance(child.disc.centre, other.disc.centre);
        if (between < least) least = between, best = child;
      });
      (isFirst ? a : b) = best;
    }
    measure(a, b);
  }
  static bool opensFirst(const Node& a, const Node& b) {
    return b.level == 0 || (a.level > 0 && a.disc.radius >= b.disc.radius);
  }

  /// Returns whether two nodes may be closer than what was found, and a lower bound on their distance. They
  /// are at least as far apart as along the way between the closest points so far.
  bool mayBeCloser(const Node& a, const Node& b, double& bound) const {
    const double most = found_.distance + slack_;
    bound = glm::dot(way_, b.disc.centre - a.disc.centre) - a.disc.reach(way_) - b.disc.reach(way_);
    if (bound > most) return false;
    bound = std::max({bound, a.disc.beyond(b.disc), b.disc.beyond(a.disc), 0.0});
    return bound <= most;
  }

  /// Two nodes that wait for their turn.
  struct Open {
    double bound;
    uint32_t levelOfA, levelOfB, a, b;
  };
  /// Orders pairs by their lower bounds. Among equal ones, the lower nodes come first: they soon show a
  /// distance.
  static bool isLater(const Open& one, const Open& two) {
    return std::tuple(one.bound, one.levelOfA + one.levelOfB, one.a, one.b) >
           std::tuple(two.bound, two.levelOfA + two.levelOfB, two.a, two.b);
  }
  void open(const Node& a, const Node& b) {
    double bound;
    if (!mayBeCloser(a, b, bound)) return;
    open_.push_back({bound, a.level, b.level, a.number, b.number});
    std::ranges::push_heap(open_, isLater);
  }

  /// Opens the larger one of two nodes, or measures two leaves.
  void visit(const Node& a, const Node& b) {
    if (double bound; !mayBeCloser(a, b, bound)) return;  // As more was found since.
    if (a.level == 0 && b.level == 0) return measure(a, b);
    if (opensFirst(a, b))
      a_.forEachChild(a, [&](const Node& child) { open(child, b); });
    else
      b_.forEachChild(b, [&](const Node& child) { open(a, child); });
  }

  void measure(const Node& nodeOfA, const Node& nodeOfB) {
    if (++measured_ % 1024 == 0) progress_.poll();
    const Side::Leaf a = a_.leaf(nodeOfA), b = b_.leaf(nodeOfB);
    std::array<double, kPacket> endsOfA, startsOfB;  // Along the way between the closest points so far.
    for (size_t lane = 0; lane < kPacket; ++lane) {
      const auto along = [&](const glm::dvec3& p) { return glm::dot(way_, p); };
      const auto& [p, q, r] = a.corners[lane];
      const auto& [s, t, u] = b.corners[lane];
      endsOfA[lane] = std::max({along(p), along(q), along(r)});
      startsOfB[lane] = std::min({along(s), along(t), along(u)});
    }
    for (size_t i = 0; i < kPacket; ++i)
      for (size_t j = 0; j < kPacket; ++j) {
        const double gap2 = squaredGap(a.boxes[i], b.boxes[j]), onWay = startsOfB[j] - endsOfA[i];
        if (gap2 >= squared_ || onWay - slack_ > found_.distance) continue;
        const TrianglePair pair = closestPoints(a.corners[i], b.corners[j], gap2 == 0.0);
        if (pair.squared < squared_) take(pair, a.ids[i], b.ids[j]);
      }
    if (squared_ > 0.0 && squared_ < INFINITY && found_.triangle != kNoTriangle)
      way_ = (found_.otherPoint - found_.point) / found_.distance;
  }

  void take(const TrianglePair& pair, uint32_t a, uint32_t b) {
    squared_ = pair.squared;
    found_ = {std::sqrt(squared_), 0.0, pair.a, pair.b, a, b};
  }

  const Side &a_, &b_;
  double slack_, squared_;
  SurfacePair found_;
  std::vector<Open> open_;  // A heap.
  glm::dvec3 way_{0.0};     // Unit vector from the one of the closest points to the other, or 0.
  size_t measured_ = 0;
  Progress& progress_;
};

}  // namespace

SurfacePair closestPair(const PreparedSurface& a, const PreparedSurface& b, const glm::dmat4& pose,
                        double most, Progress& progress) {
  const glm::dvec3 origin = a.mesh.origin;
  SurfacePair found =
      PairSearch(Side(a, glm::dmat4(1.0), origin), Side(b, pose, origin), most, progress).search();
  found.point += origin;
  found.otherPoint += origin;
  return found;
}

}  // namespace raymap::cpu
