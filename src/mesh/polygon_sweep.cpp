// Triangulation by a sweep in x, and y where x is equal: Hertel and Mehlhorn, "Fast triangulation of simple
// polygons", 1983. It takes O(n log n) and decides by exact signs.
//
// There: simple polygons. Here: corners at one place are one site, edges that cover each other are added up,
// and an edge with a site on it is split there, because faces with holes come as one loop with bridges.

#include "mesh/polygon_sweep.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>

#include "mesh/edge_flips.h"
#include "predicates/turn.h"

namespace raymap {

namespace {

/// An edge between two sites, the first to the left of the second.
struct SweepEdge {
  uint32_t from, to;
  int winding;  ///< Change of the winding number from below to above: 1 if the polygon goes right, -1 left.
};

/// The space above an edge, up to the next. If it is inside the polygon, a chain of links bounds it on the
/// left: from the edge below to the edge above, and each link points into it. What lies left is cut.
struct SweepSpace {
  int winding = 0;
  uint32_t low = 0, high = 0;  ///< Ends of the chain.
  uint32_t last = 0;           ///< Rightmost link.
};

class PolygonSweep {
 public:
  PolygonSweep(std::span<const glm::dvec2> corners, double tolerance, std::vector<glm::uvec3>& triangles)
      : tolerance_(tolerance), triangles_(triangles), begin_(triangles.size()) {
    makeSites(corners);
  }

  bool run() {
    for (uint32_t site = 0; site < sites_.size(); ++site)
      if (!pass(site)) return false;
    return status_.empty();
  }

 private:
  struct Link {
    uint32_t site, below, above;
  };

  /// Order of edges that do not cross, upwards.
  struct Below {
    using is_transparent = void;
    const PolygonSweep* sweep;
    bool operator()(const SweepEdge& edge, uint32_t site) const { return sweep->side(edge, site) > 0; }
    bool operator()(const SweepEdge& a, const SweepEdge& b) const {
      if (a.from == b.from) return sweep->side(a, b.to) > 0;
      return a.from < b.from ? sweep->side(a, b.from) > 0 : sweep->side(b, a.from) < 0;
    }
  };
  using Status = std::multimap<SweepEdge, SweepSpace, Below>;

  void makeSites(std::span<const glm::dvec2> corners) {
    std::vector<uint32_t> order(corners.size()), siteOf(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto place = [&](uint32_t c) { return std::pair(corners[c].x, corners[c].y); };
    std::ranges::sort(
        order, [&](uint32_t a, uint32_t b) { return std::pair(place(a), a) < std::pair(place(b), b); });
    for (const uint32_t corner : order) {
      if (sites_.empty() || sites_.back() != corners[corner]) {
        sites_.push_back(corners[corner]);
        cornerOf_.push_back(corner);
      }
      siteOf[corner] = static_cast<uint32_t>(sites_.size() - 1);
    }
    starting_.resize(sites_.size());
    endings_.resize(sites_.size());
    mostSplits_ = 16 + 4 * corners.size();
    for (size_t c = 0; c < corners.size(); ++c) {
      const uint32_t a = siteOf[c], b = siteOf[c + 1 < corners.size() ? c + 1 : 0];
      if (a != b) starting_[std::min(a, b)].push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }

  /// Returns 1 if a site lies above an edge, -1 if below, 0 if on it.
  int side(const SweepEdge& edge, uint32_t site) const {
    const glm::dvec2 &a = sites_[edge.from], &b = sites_[edge.to], &p = sites_[site];
    const bool isNear = tolerance_ > 0.0 && std::abs(doubleArea(a, b, p)) <= tolerance_ * glm::length(b - a);
    return isNear ? 0 : turn(a, b, p);
  }

  void addTriangle(uint32_t a, uint32_t b, uint32_t c) {
    triangles_.emplace_back(cornerOf_[a], cornerOf_[b], cornerOf_[c]);
  }

  /// Splits an edge at a site on it: the rest begins there.
  void split(const SweepEdge& edge, uint32_t site) {
    ++splits_;
    starting_[site].push_back({site, edge.to, edge.winding});
    if (edge.winding > 0)
      addTriangle(edge.from, edge.to, site);
    else
      addTriangle(edge.to, edge.from, site);
  }

  /// Sorts the edges that begin at a site upwards. Those that cover each other become one, up to the nearest
  /// end of them, or none.
  void sortStarting(uint32_t site) {
    const auto turnOf = [&](const SweepEdge& a, const SweepEdge& b) {
      return turn(sites_[site], sites_[a.to], sites_[b.to]);
    };
    std::vector<SweepEdge> edges;
    std::swap(edges, starting_[site]);
    std::ranges::sort(edges, [&](const SweepEdge& a, const SweepEdge& b) {
      const int sign = turnOf(a, b);
      return sign != 0 ? sign > 0 : a.to < b.to;
    });
    right_.clear();
    for (size_t i = 0, next = 0; i < edges.size(); i = next) {
      SweepEdge sum = edges[i];
      for (next = i + 1; next < edges.size() && turnOf(edges[i], edges[next]) == 0; ++next) {
        if (edges[next].to != sum.to) split({site, edges[next].to, edges[next].winding}, sum.to);
        sum.winding += edges[next].winding;
      }
      if (sum.winding != 0) right_.push_back(sum);
    }
  }

  uint32_t addLink(uint32_t site, uint32_t below, uint32_t above) {
    links_.push_back({site, below, above});
    return static_cast<uint32_t>(links_.size() - 1);
  }

  /// Cuts off the triangles that a site sees, from the upper end of a chain, and makes it the end.
  void endChain(SweepSpace& space, uint32_t site) {
    while (space.high != space.low) {
      const uint32_t before = links_[space.high].below;
      if (!cutsOff(before, site, space.high)) break;
      space.high = before;
    }
    const uint32_t link = addLink(site, space.high, 0);
    links_[space.high].above = link;
    space.high = space.last = link;
  }

  void beginChain(SweepSpace& space, uint32_t site) {
    while (space.low != space.high) {
      const uint32_t after = links_[space.low].above;
      if (!cutsOff(space.low, site, after)) break;
      space.low = after;
    }
    const uint32_t link = addLink(site, 0, space.low);
    links_[space.low].below = link;
    space.low = space.last = link;
  }

  bool cutsOff(uint32_t lower, uint32_t site, uint32_t upper) {
    const uint32_t a = links_[lower].site, b = links_[upper].site;
    if (turn(sites_[a], sites_[site], sites_[b]) <= 0) return false;
    addTriangle(a, site, b);
    return true;
  }

  /// Cuts a space that ends at a site.
  void closeChain(SweepSpace space, uint32_t site) {
    for (; space.low != space.high; space.low = links_[space.low].above)
      addTriangle(links_[space.low].site, site, links_[links_[space.low].above].site);
  }

  /// Divides a space at its last link. Returns the upper part.
  SweepSpace divide(SweepSpace& space) {
    SweepSpace upper = space;
    const Link& last = links_[space.last];
    upper.low = upper.last = addLink(last.site, 0, last.above);
    if (space.last != space.high)
      links_[links_[upper.low].above].below = upper.low;
    else
      upper.high = upper.low;
    space.high = space.last;
    return upper;
  }

  /// Joins a space whose chain begins at the site where the chain of `lower` ends.
  void join(SweepSpace& lower, const SweepSpace& upper) {
    if (upper.low == upper.high) return;
    const uint32_t first = links_[upper.low].above;
    links_[lower.high].above = first;
    links_[first].below = lower.high;
    lower.high = upper.high;
  }

  /// Moves the sweep past a site. Returns false where edges cross.
  bool pass(uint32_t site) {
    const auto begin = status_.lower_bound(site);
    auto end = begin;
    for (; end != status_.end() && side(end->first, site) == 0; ++end) {
      --endings_[end->first.to];
      if (end->first.to != site) split(end->first, site);
    }
    sortStarting(site);
    if (endings_[site] != 0 || splits_ > mostSplits_) return false;
    if (begin == end && right_.empty()) return true;

    SweepSpace outside;
    SweepSpace& below = begin == status_.begin() ? outside : std::prev(begin)->second;
    SweepSpace above;
    if (begin != end)
      above = std::prev(end)->second;
    else if (below.winding != 0)
      above = divide(below);
    for (auto it = begin; it != end && std::next(it) != end; ++it)
      if (it->second.winding != 0) closeChain(it->second, site);
    status_.erase(begin, end);
    if (below.winding != 0) endChain(below, site);
    if (above.winding != 0) beginChain(above, site);
    return insertRight(site, below, above, end);
  }

  /// Inserts the edges that begin at a site between two spaces. Returns false where edges cross.
  bool insertRight(uint32_t site, SweepSpace& below, const SweepSpace& above, Status::iterator end) {
    int winding = below.winding;
    for (const SweepEdge& edge : right_) {
      winding += edge.winding;
      if (winding != 0 && winding != 1) return false;
      SweepSpace space{winding};
      if (&edge == &right_.back())
        space = above;
      else if (winding != 0)
        space.low = space.high = space.last = addLink(site, 0, 0);
      ++endings_[edge.to];
      const auto it = status_.emplace_hint(end, edge, space);
      if (it != status_.begin() && crosses(std::prev(it)->first, edge)) return false;
    }
    if (winding != above.winding) return false;
    if (right_.empty() && winding != 0) join(below, above);
    return end == status_.end() || end == status_.begin() || !crosses(std::prev(end)->first, end->first);
  }

  /// Returns whether an edge does not stay below the next one.
  bool crosses(const SweepEdge& lower, const SweepEdge& upper) const {
    return lower.to < upper.to ? side(upper, lower.to) > 0 : side(lower, upper.to) < 0;
  }

  double tolerance_;
  std::vector<glm::uvec3>& triangles_;
  size_t begin_;
  std::vector<glm::dvec2> sites_;                 // Ascending in x, then y.
  std::vector<uint32_t> cornerOf_;                // First corner at each site.
  std::vector<std::vector<SweepEdge>> starting_;  // Edges that begin at each site.
  std::vector<uint32_t> endings_;                 // Number of edges in the status that end at each site.
  std::vector<Link> links_;
  std::vector<SweepEdge> right_;
  Status status_{Below{this}};
  size_t splits_ = 0, mostSplits_ = 0;
};

/// Returns twice the area of triangles, each counted as positive.
double coveredArea(std::span<const glm::dvec2> corners, std::span<const glm::uvec3> triangles) {
  double sum = 0.0;
  for (const glm::uvec3& t : triangles) sum += std::abs(doubleArea(corners[t.x], corners[t.y], corners[t.z]));
  return sum;
}

double polygonArea(std::span<const glm::dvec2> corners) {
  double sum = 0.0;
  for (size_t c = 2; c < corners.size(); ++c) sum += doubleArea(corners[0], corners[c - 1], corners[c]);
  return sum;
}

}  // namespace

bool sweepPolygon(std::span<const glm::dvec2> corners, double tolerance, std::vector<glm::uvec3>& triangles) {
  constexpr double kRounding = 1e-5;
  std::vector<glm::uvec3> cut;
  if (!PolygonSweep(corners, tolerance, cut).run()) return false;
  // With a tolerance, signs may contradict each other. Triangles that overlap then cover too much.
  if (coveredArea(corners, cut) > (1.0 + kRounding) * polygonArea(corners)) return false;
  flipThinTriangles(corners, cut);
  triangles.insert(triangles.end(), cut.begin(), cut.end());
  return true;
}

}  // namespace raymap
