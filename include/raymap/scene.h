#pragma once

#include <raymap/buffer.h>
#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/query.h>
#include <raymap/surface.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// Number of the body where there is none.
inline constexpr uint32_t kNoBody = UINT32_MAX;

/// Options of a scene's query: arrays to fill. Arrays that are not asked for take no memory.
struct SceneOptions {
  bool distance = true;    ///< Whether to fill `SceneResult::distance`.
  bool body = false;       ///< Whether to fill `SceneResult::body`.
  bool closest = false;    ///< Whether to fill `SceneResult::closest`.
  bool gradient = false;   ///< Whether to fill `SceneResult::gradient`.
  bool distances = false;  ///< Whether to fill `SceneResult::distances`. All bodies are then queried.
  bool triangle = false;   ///< Whether to fill `SceneResult::triangle`.
  /// Points as far or farther get this distance, with their sign, and NaN and `kNoTriangle` for what depends
  /// on the closest point; outside, `kNoBody` as well. Smaller is faster.
  double maxDistance = std::numeric_limits<double>::infinity();
  /// Numbers of bodies that are left out, as that whose own points are queried. Their `distances` are NaN.
  std::span<const uint32_t> without = {};
};

/// Poses of all bodies in many configurations, such as those of a robot along a trajectory.
struct Configurations {
  /// Poses of the bodies, in their order, one configuration after the other: `count` times as many as bodies.
  std::span<const glm::dmat4> poses = {};
  size_t count = 0;
  /// Whether each configuration has points of its own. The points are then those of one configuration after
  /// the other, as many in each. Otherwise all configurations get the same points.
  bool hasOwnPoints = false;
};

/// One value per point, in the order of the points, of one configuration after the other. Arrays that were
/// not asked for are empty.
///
/// A point that is not finite gets NaN and `kNoBody`. So does a point at which a field has NaN. Without a
/// body, distances are infinite, and the rest is as for a point that is not finite.
struct SceneResult {
  Buffer<double> distance = {};  ///< Signed distance of the union: the least of the distances to the bodies.
  Buffer<uint32_t> body = {};    ///< Number of the body that has it; the lowest if several are equally near.
  Buffer<glm::dvec3> closest = {};   ///< Closest point of that body, in the world.
  Buffer<glm::dvec3> gradient = {};  ///< Gradient of the distance, in the world: unit vector that leads away
                                     ///< from the solid; 0 on the surface.
  Buffer<double> distances = {};   ///< Distances to all bodies, in their order: as many per point as bodies.
  Buffer<uint32_t> triangle = {};  ///< Triangle of that body that holds the closest point; `kNoTriangle` if
                                   ///< it is a field.
};

/// Bodies with poses, and the signed distance of points of the world to their union.
///
/// A body is a surface or a sampled field, which the scene shares with its owner and never changes. Its pose
/// takes the body's coordinates to those of the world. Bodies are numbered in the order in which they were
/// added; removing one moves those after it down by one.
///
/// A pose is a rotation, a scale and a translation: a scaled rigid motion. Its axes are equally long,
/// perpendicular and right-handed, within 1e-5: their inner products, divided by the square of the scale, may
/// differ by that from those of a rotation. It is used as it is, so that distances may be wrong by the same
/// share. Distances are those in the world. A scale within 5e-6 of 1 counts as 1.
///
/// Distances to a surface are, with a scale of 1, those of `Surface::query` at the point in the body's
/// coordinates, which are computed in double precision, bit for bit. A surface without a sign has no inside:
/// its distances are not negative, and its gradient leads away from it on both sides. Distances to a field
/// are those of `sample`, so that they are approximate, and lower bounds outside its box. The closest point
/// of a field lies at this distance along the gradient, and is approximate too; NaN where the gradient is 0.
///
/// Several threads may query a scene at the same time. The results of a point depend neither on the other
/// points and configurations of the call, nor on the number of threads.
class RAYMAP_API Scene {
 public:
  Scene();
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  /// Adds a body after all others. Throws `Error(Usage)` if the name is empty or taken, there is no surface
  /// or field, the field has no distances, or the pose is no scaled rigid motion.
  void add(std::string name, std::shared_ptr<const Surface> surface,
           const glm::dmat4& pose = glm::dmat4(1.0));
  void add(std::string name, std::shared_ptr<const Field> field, const glm::dmat4& pose = glm::dmat4(1.0));
  /// Removes a body. Throws `Error(Usage)` if there is none of this name.
  void remove(std::string_view name);

  /// Sets a body's pose, which costs nothing. Throws `Error(Usage)` if there is none of this name, or the
  /// pose is no scaled rigid motion.
  void setPose(std::string_view name, const glm::dmat4& pose);
  /// Sets the poses of all bodies, in their order; none after an error. Throws `Error(Usage)` if there are
  /// more or fewer, or one is no scaled rigid motion.
  void setPoses(std::span<const glm::dmat4> poses);

  size_t size() const;
  /// Returns the number of a body. Throws `Error(Usage)` if there is none of this name.
  uint32_t number(std::string_view name) const;
  std::vector<std::string> names() const;
  std::vector<glm::dmat4> poses() const;
  /// Returns a box of the world that holds the bounds of all bodies; an empty one without bodies.
  Box bounds() const;

  /// Returns what is asked for at points of the world. `machine.threads` and `progress` are used. Throws
  /// `Error`: Usage, if `maxDistance` is not above 0 or there is no body of a number in `without`; Memory,
  /// Cancelled.
  SceneResult query(const PointsView& points, const SceneOptions& options = {},
                    const MachineOptions& machine = {}) const;
  /// Does the same for many configurations at once, in place of the scene's own poses. Throws `Error(Usage)`,
  /// too, for poses that are not as many as said or no scaled rigid motions, and for points that are not as
  /// many in each configuration.
  SceneResult query(const PointsView& points, const Configurations& configurations,
                    const SceneOptions& options = {}, const MachineOptions& machine = {}) const;

  /// Returns the field of the union on a grid: the distances of `query` at its samples, rounded to `float`,
  /// and clamped to `band` samples unless that is 0. The bounds of its surface are not known. Uses
  /// `machine.threads`, `memoryLimit` and `progress`. Throws `Error`: Usage for a grid or band that makes no
  /// sense, Memory, Cancelled.
  Field generate(const Grid& grid, double band = 0.0, const MachineOptions& machine = {}) const;
  /// Returns the field near the surface of the union alone, on a lattice of up to 2^24 samples a side, with
  /// the same distances. Parts near an open mesh or a field that do not know how far their inside reaches are
  /// asked sample by sample. Throws `Error(Usage)`, too, for other arrays than the distance.
  Field generateBand(const Grid& grid, const BandOptions& options = {},
                     const MachineOptions& machine = {}) const;

  /// Returns the least distance of the two bodies of each pair, of one configuration after the other, as
  /// `Surface::distanceTo` does. `point` belongs to the first body and `otherPoint` to the second, both in
  /// the world. Bodies as far as `maxDistance` or farther get this distance. The pairs share the threads.
  /// `machine.threads` and `progress` are used. Throws `Error`: Usage, if a body is a field or does not
  /// exist, for a distance that is not above 0, and for configurations as `query` does; Cancelled.
  std::vector<SurfacePair> distancesBetween(std::span<const glm::uvec2> pairs,
                                            const Configurations& configurations,
                                            double maxDistance = std::numeric_limits<double>::infinity(),
                                            const MachineOptions& machine = {}) const;
  /// Does the same for the scene's own poses.
  std::vector<SurfacePair> distancesBetween(std::span<const glm::uvec2> pairs,
                                            double maxDistance = std::numeric_limits<double>::infinity(),
                                            const MachineOptions& machine = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap
