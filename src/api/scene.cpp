#include <raymap/sample.h>
#include <raymap/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

#include "api/check_band.h"
#include "api/scene_band.h"
#include "base/memory.h"
#include "base/morton.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/require.h"
#include "base/sort_keys.h"
#include "base/text.h"
#include "cpu/points/point_cells.h"
#include "field/field_sampler.h"
#include "method/points_view.h"
#include "method/pose.h"

namespace raymap {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Most points that are answered together, and points that a thread takes at a time.
constexpr size_t kPointsAtOnce = size_t{1} << 19, kPointsPerTask = 4096;

/// Most points of a cell, cells that a thread takes at a time, and parts that cells are divided into.
constexpr size_t kPointsPerCell = 8, kCellsPerTask = 64, kParts = 4;

/// With so few bodies, or points in a configuration, asking of all bounds takes no longer than a choice.
constexpr size_t kFewBodies = 8, kFewPoints = 511;

/// Bounds are lowered by this share of the body's diagonal and of the distance. Distances of a surface are
/// within a fourth of that, and those of a field within a tenth.
constexpr double kInexact = 4e-6;

/// Lengths in a body's coordinates may be longer by this factor than the scale says, as poses are rigid
/// within 1e-5, and positions may be wrong by this share.
constexpr double kStretch = 1.0001, kRounding = 1e-14;

/// Nothing is known of distances whose squares overflow.
constexpr double kFarthestBound = 1e150;

/// Returns how far a point lies beyond a box along each axis; negative between its sides.
glm::dvec3 beyond(const Box& box, const glm::dvec3& p) {
  return glm::max(box.min - p, p - box.max);
}

double largest(const glm::dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

double slackOf(const Box& box) {
  return kInexact * glm::length(box.size());
}

/// Lowers a bound by what distances may be wrong by.
double lowered(double bound, double slack) {
  return bound < kFarthestBound ? bound - kInexact * std::abs(bound) - slack : -INFINITY;
}

// Bodies, each with a lower bound on its signed distance within a radius about a point of its coordinates.

struct SurfaceShape {
  SurfaceShape(std::shared_ptr<const Surface> given, double reach)
      : surface(std::move(given)),
        bounds(raymap::bounds(surface->mesh())),
        slack(slackOf(bounds)),
        insideReach(reach) {}

  /// Faces without boundary edges lie between each point inside and all sides of the bounds.
  double lowerBound(const glm::dvec3& p, double radius) const {
    const glm::dvec3 past = beyond(bounds, p);
    const double toBounds = glm::length(glm::max(past, 0.0)) + std::min(largest(past), 0.0) - radius;
    return insideReach > 0.0 && toBounds <= insideReach ? -INFINITY : lowered(toBounds, slack);
  }

  std::shared_ptr<const Surface> surface;
  Box bounds;
  double slack;        ///< Bound on the errors of distances near the surface.
  double insideReach;  ///< See `Surface::insideReach`.
};

struct FieldShape {
  explicit FieldShape(std::shared_ptr<const Field> given)
      : field(std::move(given)),
        samples{field->grid.origin, field->grid.position(field->grid.dims - 1)},
        bounds(field->surfaceBounds.isEmpty() ? samples : field->surfaceBounds),
        slack(slackOf(samples)),
        isBounded(!field->surfaceBounds.isEmpty() &&
                  std::ranges::none_of(field->distance, [](float d) { return std::isnan(d); })) {}

  /// Beyond its samples, a field is at least as far as the bounds of its surface.
  double lowerBound(const glm::dvec3& p, double radius) const {
    if (!isBounded || !(largest(beyond(samples, p)) - radius > slack)) return -INFINITY;
    const double toBounds = glm::length(glm::max(beyond(field->surfaceBounds, p), 0.0)) - radius;
    return toBounds > slack ? lowered(toBounds, slack) : -INFINITY;
  }

  std::shared_ptr<const Field> field;
  Box samples;     ///< Box of the samples.
  Box bounds;      ///< Bounds of the surface; those of the samples if they are not known.
  double slack;    ///< Bound on the rounding of positions and distances.
  bool isBounded;  ///< Whether the bounds of the surface are known, and no distance is NaN.
};

using Shape = std::variant<SurfaceShape, FieldShape>;

struct Body {
  std::string name;
  Shape shape;

  /// Returns a lower bound in the world within a radius about a point of the world.
  double lowerBound(const glm::dmat4& pose, const glm::dvec3& world, double radius = 0.0) const {
    const glm::dvec3 p = movedBack(pose, world);
    const double scale = scaleOf(pose);
    return scale * std::visit([&](const auto& of) { return of.lowerBound(p, radius / scale); }, shape);
  }
};

/// Answers of a body at some points, in its coordinates.
struct BodyAnswers {
  QueryResult surface;
  Samples field;
};

/// Asks about points up to a largest distance, both in the coordinates of the body.
void ask(const SurfaceShape& shape, const Buffer<glm::dvec3>& points, double most,
         const SceneOptions& options, BodyAnswers& answers) {
  const QueryOptions asked{.closest = options.closest,
                           .triangle = options.triangle,
                           .direction = options.gradient,
                           .maxDistance = most};
  shape.surface->query(points, asked, answers.surface);
}

void ask(const FieldShape& shape, const Buffer<glm::dvec3>& points, double, const SceneOptions& options,
         BodyAnswers& answers) {
  sample(*shape.field, points, {.gradients = options.closest || options.gradient}, answers.field);
}

/// Answer of a body at a point, in the world.
struct Answer {
  double distance;
  glm::dvec3 closest{0.0}, gradient{0.0};  ///< If they are asked for.
  uint32_t triangle = kNoTriangle;
};

/// Returns the answer at a point that is too far from the surface.
Answer farAnswer(double distance, const SceneOptions& options) {
  return {.distance = std::copysign(options.maxDistance, distance),
          .closest = glm::dvec3(kNaN),
          .gradient = glm::dvec3(kNaN)};
}

Answer answerAt(const SurfaceShape&, const BodyAnswers& answers, size_t i, const glm::dmat4& pose,
                const glm::dvec3&, const SceneOptions& options) {
  const QueryResult& found = answers.surface;
  const double scale = scaleOf(pose);
  Answer answer{.distance = scale * found.distance[i]};
  const double apart = std::abs(answer.distance);
  if (apart > options.maxDistance || (scale != 1.0 && apart == options.maxDistance))
    return farAnswer(answer.distance, options);
  if (options.triangle) answer.triangle = found.triangle[i];
  if (options.closest) answer.closest = moved(pose, found.closest[i]);
  // Subtracting from 0 makes no negative zeros.
  if (options.gradient)
    answer.gradient =
        turned(pose, answer.distance < 0.0 ? found.direction[i] : glm::dvec3(0.0) - found.direction[i]);
  return answer;
}

Answer answerAt(const FieldShape&, const BodyAnswers& answers, size_t i, const glm::dmat4& pose,
                const glm::dvec3& point, const SceneOptions& options) {
  const Samples& found = answers.field;
  Answer answer{.distance = scaleOf(pose) * found.distance[i]};
  if (std::abs(answer.distance) > options.maxDistance) return farAnswer(answer.distance, options);
  if (found.gradient.empty()) return answer;
  answer.gradient = turned(pose, glm::dvec3(found.gradient[i]));
  answer.closest = point - answer.distance * (answer.gradient / glm::length(answer.gradient));
  return answer;
}

/// Points of one configuration that are asked about together.
struct Cell {
  uint32_t begin, end;
  const glm::dmat4* poses;            ///< Poses of all bodies.
  Box box = {};                       ///< Box of its points, but for those that are not finite.
  double most = INFINITY;             ///< Largest distance that was found at its points so far.
  std::vector<uint32_t> bodies = {};  ///< Those that may be nearer at one of them, if there is a choice.
};

/// Returns the place of a point on a curve through a box, of 45 bits.
uint64_t placeOf(const Box& box, const glm::dvec3& p) {
  constexpr double kPlaces = 1 << 15;
  const glm::dvec3 place = (p - box.min) * (kPlaces / largest(box.size()));
  // A place that is NaN becomes 0.
  const glm::uvec3 of(glm::min(glm::max(glm::dvec3(0.0), place), kPlaces - 1.0));
  return mortonCode(of.x, of.y, of.z);
}

/// A query of many points in one or more configurations. The points of one after the other are numbered
/// through.
class SceneQuery {
 public:
  SceneQuery(const std::vector<Body>& bodies, const PointsView& points, const Configurations& configurations,
             const SceneOptions& options, SceneResult& result)
      : bodies_(bodies),
        points_(points),
        configurations_(configurations),
        options_(options),
        result_(result),
        perConfiguration_(configurations.hasOwnPoints
                              ? points.count / std::max(configurations.count, size_t{1})
                              : points.count),
        total_(perConfiguration_ * configurations.count) {
    for (uint32_t b = 0; b < bodies.size(); ++b)
      if (std::ranges::find(options.without, b) == options.without.end()) asked_.push_back(b);
    isChosen_ = !options.distances && asked_.size() > kFewBodies && perConfiguration_ > kFewPoints;
    result.distance.resizeUninitialized(options.distance ? total_ : 0);
    result.body.resizeUninitialized(options.body ? total_ : 0);
    result.closest.resizeUninitialized(options.closest ? total_ : 0);
    result.gradient.resizeUninitialized(options.gradient ? total_ : 0);
    result.distances.resizeUninitialized(options.distances ? total_ * bodies.size() : 0);
    result.triangle.resizeUninitialized(options.triangle ? total_ : 0);
  }

  void answer(Progress& progress) {
    for (begin_ = 0; begin_ < total_; begin_ += kPointsAtOnce) {
      const size_t end = std::min(begin_ + kPointsAtOnce, total_);
      progress.part(double(begin_) / double(total_), double(end) / double(total_));
      load(end - begin_);
      answerLoaded(progress);
    }
  }

 private:
  size_t configuration(size_t k) const { return (begin_ + number_[k]) / perConfiguration_; }
  const glm::dmat4* poses(size_t configuration) const {
    return &configurations_.poses[configuration * bodies_.size()];
  }

  void load(size_t count) {
    world_.resizeUninitialized(count);
    number_.resizeUninitialized(count);
    least_.resizeUninitialized(count);
    nearest_.resizeUninitialized(count);
    if (isChosen_) sort(count);
    parallelFor(count, kPointsPerTask, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        number_[k] = isChosen_ ? uint32_t(keys_[k].low) : uint32_t(k);
        const size_t i = begin_ + number_[k];
        world_[k] = point(i);
        least_[k] = cpu::isFinite(world_[k]) ? options_.maxDistance : kNaN;
        nearest_[k] = kNoBody;
        if (options_.triangle) result_.triangle[i] = kNoTriangle;
        if (options_.closest) result_.closest[i] = glm::dvec3(kNaN);
        if (options_.gradient) result_.gradient[i] = glm::dvec3(kNaN);
        for (size_t b = 0; options_.distances && b < bodies_.size(); ++b)
          result_.distances[i * bodies_.size() + b] = kNaN;
      }
    });
    if (!bodies_.empty()) makeCells(count);
  }

  glm::dvec3 point(size_t i) const {
    return pointAt(points_, configurations_.hasOwnPoints ? i : i % perConfiguration_);
  }

  /// Sorts the points of each configuration along a curve.
  void sort(size_t count) {
    Box box;
    for (size_t i = begin_; i < begin_ + count; ++i) include(box, point(i));
    sortKeys(
        count,
        [&](size_t begin, size_t end, SortKey* to) {
          for (size_t k = begin; k < end; ++k) {
            const size_t i = begin_ + k, ofBlock = i / perConfiguration_ - begin_ / perConfiguration_;
            *to++ = {.low = k, .high = ofBlock << 45 | placeOf(box, point(i))};
          }
        },
        keys_);
  }

  static void include(Box& box, const glm::dvec3& p) {
    if (!cpu::isFinite(p)) return;
    box.min = glm::min(box.min, p);
    box.max = glm::max(box.max, p);
  }

  void makeCells(size_t count) {
    cells_.clear();
    for (size_t begin = 0, end; begin < count; begin = end) {
      const size_t c = configuration(begin), last = std::min((c + 1) * perConfiguration_ - begin_, count);
      end = std::min(begin + kPointsPerCell, last);
      cells_.push_back({.begin = uint32_t(begin), .end = uint32_t(end), .poses = poses(c)});
    }
    allCells_.resize(cells_.size());
    std::iota(allCells_.begin(), allCells_.end(), 0u);
  }

  void answerLoaded(Progress& progress) {
    if (options_.distances) {
      for (const uint32_t b : asked_) {
        visit(b, [&](const Cell&, size_t k) { return cpu::isFinite(world_[k]); });
        progress.report(double(b + 1) / double(bodies_.size()));
      }
    } else if (!asked_.empty()) {
      visitPromising(progress);
    }
    parallelFor(world_.size(), kPointsPerTask, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        if (options_.distance) result_.distance[begin_ + number_[k]] = least_[k];
        if (options_.body) result_.body[begin_ + number_[k]] = nearest_[k];
      }
    });
  }

  /// Asks of each point the body of the least lower bound, and then the others whose bounds are not above
  /// what was found.
  void visitPromising(Progress& progress) {
    for (const bool isFirst : {true, false}) {
      if (isChosen_) chooseBodies(isFirst);
      if (isFirst) findFirst();
      for (const uint32_t b : asked_) {
        visit(b, [&](const Cell& cell, size_t k) {
          return (first_[k] == b) == isFirst && lowerBound(cell, k, b) <= least_[k];
        });
        progress.report((double(b + 1) / double(bodies_.size()) + (isFirst ? 0.0 : 1.0)) / 2.0);
      }
    }
  }

  double lowerBound(const Cell& cell, size_t k, size_t body) const {
    return bodies_[body].lowerBound(cell.poses[body], world_[k]);
  }

  /// Finds the body of the least lower bound for each point.
  void findFirst() {
    first_.resizeUninitialized(world_.size());
    parallelFor(cells_.size(), kCellsPerTask, [&](size_t begin, size_t end) {
      for (size_t c = begin; c < end; ++c)
        for (size_t k = cells_[c].begin; k < cells_[c].end; ++k) {
          first_[k] = kNoBody;
          double least = INFINITY;
          for (const uint32_t b : isChosen_ ? cells_[c].bodies : asked_) {
            const double bound = lowerBound(cells_[c], k, b);
            if (bound < least) least = bound, first_[k] = b;
          }
        }
    });
  }

  /// Chooses the bodies of each cell: those that may have the least lower bound at one of its points, or
  /// else those whose bounds may not be above what was found.
  void chooseBodies(bool isFirst) {
    parallelFor(cells_.size(), kCellsPerTask, [&](size_t begin, size_t end) {
      for (Cell& cell : std::span(cells_).subspan(begin, end - begin)) {
        cell.bodies.clear();
        cell.most = -INFINITY;
        for (size_t k = cell.begin; k < cell.end; ++k) {
          include(cell.box, world_[k]);
          cell.most = std::max(cell.most, least_[k]);  // NaN counts nowhere.
        }
      }
    });
    for (size_t begin = 0, end; begin < cells_.size(); begin = end) {
      for (end = begin + 1; end < cells_.size() && cells_[end].poses == cells_[begin].poses;) ++end;
      choose(begin, end, asked_, isFirst);
    }
    cellsOf_.resize(bodies_.size());
    for (std::vector<uint32_t>& cells : cellsOf_) cells.clear();
    for (const uint32_t c : allCells_)
      for (const uint32_t b : cells_[c].bodies) cellsOf_[b].push_back(c);
  }

  /// Chooses the bodies of some cells among these.
  void choose(size_t begin, size_t end, const std::vector<uint32_t>& among, bool isFirst) {
    std::vector<uint32_t> chosen = nearTo(begin, end, among, isFirst);
    if (end - begin == 1 || chosen.empty()) {
      cells_[begin].bodies = std::move(chosen);
      return;
    }
    const size_t count = end - begin, parts = std::min(count, kParts);
    parallelFor(parts, count > kCellsPerTask ? 1 : parts, [&](size_t part, size_t last) {
      for (; part < last; ++part)
        choose(begin + part * count / parts, begin + (part + 1) * count / parts, chosen, isFirst);
    });
  }

  std::vector<uint32_t> nearTo(size_t begin, size_t end, const std::vector<uint32_t>& among,
                               bool isFirst) const {
    Box box;
    double most = -INFINITY;
    for (size_t c = begin; c < end; ++c) {
      box = {glm::min(box.min, cells_[c].box.min), glm::max(box.max, cells_[c].box.max)};
      most = std::max(most, cells_[c].most);
    }
    if (box.isEmpty()) return {};
    const glm::dvec3 centre = box.centre();
    const double radius = kStretch * glm::length(glm::max(box.max - centre, centre - box.min));
    std::vector<double> bounds;
    bounds.reserve(among.size());
    for (const uint32_t b : among) {
      const glm::dmat4& pose = cells_[begin].poses[b];
      const glm::dvec3 p = movedBack(pose, centre);
      const double reach =
          radius + kRounding * scaleOf(pose) * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
      bounds.push_back(bodies_[b].lowerBound(pose, centre, reach));
      if (isFirst) most = std::min(most, bounds.back() + 2.0 * reach);
    }
    std::vector<uint32_t> chosen;
    for (size_t i = 0; i < among.size(); ++i)
      if (bounds[i] <= most) chosen.push_back(among[i]);
    return chosen;
  }

  /// Returns the points that want a body, of the cells that may.
  template <class Predicate>
  std::vector<uint32_t> select(uint32_t b, Predicate&& isWanted) const {
    const std::vector<uint32_t>& cells = isChosen_ ? cellsOf_[b] : allCells_;
    std::vector<std::vector<uint32_t>> parts((cells.size() + kCellsPerTask - 1) / kCellsPerTask);
    parallelFor(parts.size(), 1, [&](size_t part, size_t) {
      for (size_t i = part * kCellsPerTask; i < std::min((part + 1) * kCellsPerTask, cells.size()); ++i) {
        const Cell& cell = cells_[cells[i]];
        for (uint32_t k = cell.begin; k < cell.end; ++k)
          if (isWanted(cell, k)) parts[part].push_back(k);
      }
    });
    return joined(parts);
  }

  /// Asks a body about the points that want it.
  template <class Predicate>
  void visit(uint32_t b, Predicate&& isWanted) {
    const std::vector<uint32_t> wanted = select(b, isWanted);
    if (wanted.empty()) return;
    const auto poseAt = [&](size_t k) -> const glm::dmat4& { return poses(configuration(k))[b]; };
    inBody_.resizeUninitialized(wanted.size());
    double least = INFINITY;  // Scale. Rounding must not make a point far that is not.
    for (const uint32_t k : wanted) least = std::min(least, scaleOf(poseAt(k)));
    const double most = least == 1.0 ? options_.maxDistance : options_.maxDistance / least * (1.0 + 1e-12);
    parallelFor(wanted.size(), kPointsPerTask, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) inBody_[i] = movedBack(poseAt(wanted[i]), world_[wanted[i]]);
    });
    std::visit(
        [&](const auto& shape) {
          ask(shape, inBody_, most, options_, answers_);
          parallelFor(wanted.size(), kPointsPerTask, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
              const size_t k = wanted[i];
              take(k, b, answerAt(shape, answers_, i, poseAt(k), world_[k], options_));
            }
          });
        },
        bodies_[b].shape);
  }

  /// Takes a body's answer at a point, in whichever order the bodies come. NaN stays.
  void take(size_t k, uint32_t b, const Answer& answer) {
    const size_t i = begin_ + number_[k];
    if (options_.distances) result_.distances[i * bodies_.size() + b] = answer.distance;
    const bool isKnown = !std::isnan(answer.distance),
               isNearer = answer.distance < least_[k] || (answer.distance == least_[k] && b < nearest_[k]),
               isFar = std::isfinite(answer.distance) && answer.distance == options_.maxDistance;
    if (std::isnan(least_[k]) || (isKnown && (!isNearer || isFar))) return;
    least_[k] = answer.distance;
    nearest_[k] = isKnown ? b : kNoBody;
    if (options_.triangle) result_.triangle[i] = isKnown ? answer.triangle : kNoTriangle;
    if (options_.closest) result_.closest[i] = isKnown ? answer.closest : glm::dvec3(kNaN);
    if (options_.gradient) result_.gradient[i] = isKnown ? answer.gradient : glm::dvec3(kNaN);
  }

  const std::vector<Body>& bodies_;
  const PointsView& points_;
  const Configurations& configurations_;
  const SceneOptions& options_;
  SceneResult& result_;
  size_t perConfiguration_, total_;
  std::vector<uint32_t> asked_;  // Bodies that are not left out.
  bool isChosen_;                // Whether each cell chooses among them.

  // State of the points that are answered together. The first of them has number `begin_`.
  size_t begin_ = 0;
  Buffer<SortKey> keys_;     // place on the curve and number of a point, if there is a choice
  Buffer<uint32_t> number_;  // of a point, from `begin_` on
  Buffer<glm::dvec3> world_;
  Buffer<double> least_;      // distance found so far
  Buffer<uint32_t> nearest_;  // body that has it
  Buffer<uint32_t> first_;    // body of the least lower bound
  Buffer<glm::dvec3> inBody_;
  BodyAnswers answers_;
  std::vector<Cell> cells_;
  std::vector<uint32_t> allCells_;
  std::vector<std::vector<uint32_t>> cellsOf_;  // those that chose a body
};

std::string poseName(const std::string& body) {
  return "the pose of body '" + body + "'";
}

}  // namespace

struct Scene::Impl {
  std::vector<Body> bodies;
  std::vector<glm::dmat4> poses;  // One per body.

  size_t find(std::string_view name) const {
    const auto at = std::ranges::find(bodies, name, &Body::name);
    if (at == bodies.end()) throw Error(ErrorCode::Usage, missing(name));
    return size_t(at - bodies.begin());
  }
  void add(std::string name, Shape shape, const glm::dmat4& pose);
  /// Returns the surface of a body.
  const Surface& surfaceOf(uint32_t body) const;
  /// Throws unless there are this many poses of each body, all of them rigid.
  void check(const Configurations& configurations) const;

 private:
  std::string missing(std::string_view name) const {
    std::string text = "the scene has no body '" + std::string(name) + "'; it has ";
    if (bodies.empty()) return text + "none";
    for (const Body& body : bodies) text += (&body == bodies.data() ? "'" : ", '") + body.name + "'";
    return text;
  }
};

void Scene::Impl::add(std::string name, Shape shape, const glm::dmat4& pose) {
  require(!name.empty(), "a body needs a name");
  require(std::ranges::find(bodies, name, &Body::name) == bodies.end(),
          "the scene has a body '" + name + "'; remove that first, or use another name");
  require(bodies.size() < kNoBody, "a scene has fewer than 4294967295 bodies");
  checkPose(pose, [&] { return poseName(name); });
  poses.reserve(bodies.size() + 1);
  bodies.push_back({std::move(name), std::move(shape)});
  poses.push_back(pose);
}

const Surface& Scene::Impl::surfaceOf(uint32_t body) const {
  require(body < bodies.size(),
          "there is no body " + std::to_string(body) + "; the scene has " + std::to_string(bodies.size()));
  const auto* shape = std::get_if<SurfaceShape>(&bodies[body].shape);
  require(shape != nullptr,
          "body '" + bodies[body].name + "' is a field; distances between bodies are those of surfaces");
  return *shape->surface;
}

void Scene::Impl::check(const Configurations& configurations) const {
  const size_t count = configurations.count, given = configurations.poses.size();
  require(bodies.empty() ? given == 0 : given % bodies.size() == 0 && given / bodies.size() == count,
          "there are " + std::to_string(given) + " poses for " + std::to_string(count) +
              " configurations of " + std::to_string(bodies.size()) + " bodies");
  for (size_t i = 0; i < given; ++i)
    checkPose(configurations.poses[i], [&] {
      return poseName(bodies[i % bodies.size()].name) + " in configuration " +
             std::to_string(i / bodies.size());
    });
}

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

void Scene::add(std::string name, std::shared_ptr<const Surface> surface, const glm::dmat4& pose) {
  require(surface != nullptr, "body '" + name + "' has no surface");
  const double reach = surface->insideReach();
  notMoved(impl_).add(std::move(name), SurfaceShape(std::move(surface), reach), pose);
}

void Scene::add(std::string name, std::shared_ptr<const Field> field, const glm::dmat4& pose) {
  require(field != nullptr, "body '" + name + "' has no field");
  validateField(*field);
  notMoved(impl_).add(std::move(name), FieldShape(std::move(field)), pose);
}

void Scene::remove(std::string_view name) {
  const auto at = std::ptrdiff_t(notMoved(impl_).find(name));
  notMoved(impl_).bodies.erase(notMoved(impl_).bodies.begin() + at);
  notMoved(impl_).poses.erase(notMoved(impl_).poses.begin() + at);
}

void Scene::setPose(std::string_view name, const glm::dmat4& pose) {
  const size_t body = notMoved(impl_).find(name);
  checkPose(pose, [&] { return poseName(notMoved(impl_).bodies[body].name); });
  notMoved(impl_).poses[body] = pose;
}

void Scene::setPoses(std::span<const glm::dmat4> poses) {
  require(poses.size() == size(),
          std::to_string(poses.size()) + " poses are given for " + std::to_string(size()) + " bodies");
  for (size_t b = 0; b < poses.size(); ++b)
    checkPose(poses[b], [&] { return poseName(notMoved(impl_).bodies[b].name); });
  notMoved(impl_).poses.assign(poses.begin(), poses.end());
}

Box Scene::bounds() const {
  Box all;
  for (size_t b = 0; b < size(); ++b) {
    const Box box = std::visit([](const auto& of) { return of.bounds; }, impl_->bodies[b].shape);
    for (int corner = 0; corner < 8 && !box.isEmpty(); ++corner) {
      const glm::bvec3 isHigh(corner & 1, corner & 2, corner & 4);
      const glm::dvec3 p = moved(impl_->poses[b], glm::mix(box.min, box.max, isHigh));
      all = {glm::min(all.min, p), glm::max(all.max, p)};
    }
  }
  return all;
}

size_t Scene::size() const {
  return notMoved(impl_).bodies.size();
}

uint32_t Scene::number(std::string_view name) const {
  return uint32_t(notMoved(impl_).find(name));
}

std::vector<std::string> Scene::names() const {
  std::vector<std::string> names;
  for (const Body& body : notMoved(impl_).bodies) names.push_back(body.name);
  return names;
}

std::vector<glm::dmat4> Scene::poses() const {
  return notMoved(impl_).poses;
}

SceneResult Scene::query(const PointsView& points, const SceneOptions& options,
                         const MachineOptions& machine) const {
  return query(points, {.poses = notMoved(impl_).poses, .count = 1}, options, machine);
}

SceneResult Scene::query(const PointsView& points, const Configurations& configurations,
                         const SceneOptions& options, const MachineOptions& machine) const {
  const size_t count = configurations.count;
  notMoved(impl_).check(configurations);
  require(options.maxDistance > 0.0,
          "the largest distance of a query must be above 0, not " + numberText(options.maxDistance));
  for (const uint32_t body : options.without)
    require(body < size(), "body " + std::to_string(body) + " is to be left out, but the scene has " +
                               std::to_string(size()));
  require(!configurations.hasOwnPoints || (count > 0 ? points.count % count == 0 : points.count == 0),
          std::to_string(points.count) + " points are not as many in each of " + std::to_string(count) +
              " configurations");
  SceneResult result;
  Progress progress(machine.progress);
  withThreads(machine.threads, [&] {
    SceneQuery query(notMoved(impl_).bodies, points, configurations, options, result);
    progress.stage("query", [&] { query.answer(progress); });
  });
  return result;
}

Field Scene::generate(const Grid& grid, double band, const MachineOptions& machine) const {
  validateGrid(grid);
  require(band >= 0.0 && std::isfinite(band), "the band must be finite and not negative");
  const size_t count = grid.sampleCount();
  constexpr size_t kBytesOfPoint = 80;  // Of those that are asked together.
  checkFieldMemory(count * sizeof(float) + std::min(count, kPointsAtOnce) * kBytesOfPoint,
                   mostMemory(machine.memoryLimit));
  Field field{.grid = grid, .clampDistance = band * grid.spacing};
  field.distance.resizeUninitialized(count);
  const SceneOptions options{.maxDistance = band > 0.0 ? field.clampDistance : INFINITY};
  std::vector<glm::dvec3> points;
  Progress progress(machine.progress);
  progress.stage("scene", [&] {
    for (size_t begin = 0; begin < count; begin += points.size()) {
      points.resize(std::min(kPointsAtOnce, count - begin));
      const size_t nx = size_t(grid.dims.x), ny = size_t(grid.dims.y);
      for (size_t i = 0; i < points.size(); ++i) {
        const size_t s = begin + i, row = s / nx, plane = row / ny;
        points[i] = grid.position(glm::dvec3(double(s % nx), double(row % ny), double(plane)));
      }
      const SceneResult found = query(points, options, {.threads = machine.threads});
      for (size_t i = 0; i < points.size(); ++i) field.distance[begin + i] = float(found.distance[i]);
      progress.report(double(begin + points.size()) / double(count));
    }
  });
  return field;
}

Field Scene::generateBand(const Grid& grid, const BandOptions& options, const MachineOptions& machine) const {
  checkBand(grid, options, true);
  require(!options.triangle && !options.winding && !options.confidence,
          "the field of a scene has distances alone");
  const Impl& scene = notMoved(impl_);
  std::vector<uint32_t> unsteady;
  double slack = 0.0;
  for (uint32_t b = 0; b < scene.bodies.size(); ++b)
    if (const auto* shape = std::get_if<SurfaceShape>(&scene.bodies[b].shape);
        !shape || shape->insideReach > 0.0)
      unsteady.push_back(b);
  for (size_t b = 0; b < scene.bodies.size(); ++b)
    std::visit([&](const auto& of) { slack = std::max(slack, scaleOf(scene.poses[b]) * of.slack); },
               scene.bodies[b].shape);
  const auto ask = [&](std::span<const glm::dvec3> points, double most, std::span<const uint32_t> without) {
    return query(points, {.maxDistance = most, .without = without}, {.threads = machine.threads}).distance;
  };
  const SceneBounds bounds{
      .distances = [&](auto points, double most) { return ask(points, most, {}); },
      .steadyDistances = [&](auto points, double most) { return ask(points, most, unsteady); },
      .lowerBound =
          [&](const glm::dvec3& p, double radius) {
            double least = INFINITY;
            for (const uint32_t b : unsteady)
              least = std::min(least, scene.bodies[b].lowerBound(scene.poses[b], p, kStretch * radius));
            return least;
          },
      .slack = slack};
  Progress progress(machine.progress);
  return makeSceneBand(grid, options, bounds, mostMemory(machine.memoryLimit), progress);
}

std::vector<SurfacePair> Scene::distancesBetween(std::span<const glm::uvec2> pairs, double maxDistance,
                                                 const MachineOptions& machine) const {
  return distancesBetween(pairs, {.poses = notMoved(impl_).poses, .count = 1}, maxDistance, machine);
}

std::vector<SurfacePair> Scene::distancesBetween(std::span<const glm::uvec2> pairs,
                                                 const Configurations& configurations, double maxDistance,
                                                 const MachineOptions& machine) const {
  const Impl& scene = notMoved(impl_);
  scene.check(configurations);
  require(maxDistance > 0.0, "the largest distance must be above 0, not " + numberText(maxDistance));
  for (const glm::uvec2& pair : pairs) scene.surfaceOf(pair.x), scene.surfaceOf(pair.y);
  std::vector<SurfacePair> found(pairs.size() * configurations.count);
  Progress progress(machine.progress);
  WorkMeter meter(progress, 0.0, 1.0, double(found.size()));
  const auto measure = [&](size_t i) {
    const glm::uvec2& pair = pairs[i % pairs.size()];
    const glm::dmat4* poses = &configurations.poses[i / pairs.size() * scene.bodies.size()];
    const glm::dmat4 seen = seenFrom(poses[pair.x], poses[pair.y]);
    Progress silent;
    const double scale = scaleOf(poses[pair.x]);
    found[i] =
        scene.surfaceOf(pair.x).closestPair(scene.surfaceOf(pair.y), {seen, maxDistance / scale}, silent);
    const bool isFar = found[i].triangle == kNoTriangle;
    found[i].distance = found[i].bound = isFar ? maxDistance : scale * found[i].distance;
    found[i].point = moved(poses[pair.x], found[i].point);
    found[i].otherPoint = moved(poses[pair.x], found[i].otherPoint);
    meter.add(1);
  };
  withThreads(machine.threads, [&] {
    progress.stage("distance", [&] {
      parallelFor(found.size(), 1, [&](size_t begin, size_t end) {
        for (; begin < end; ++begin) measure(begin);
      });
    });
  });
  return found;
}

}  // namespace raymap
