#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace raymap {

/// Sources of the unsigned distance (Krayer & Müller 2019, §3.3).
enum class DistanceMode {
  Exact,       ///< The closest of all triangles.
  Neighbours,  ///< The closest triangle of the nearest occupied cell and its 26 neighbours.
  Cell,        ///< The closest triangle of the nearest occupied cell: the paper's choice.
  Raster       ///< Distances in touched cells, extended by the distance transform (§3.3, end).
};

/// Sources of the winding number (Krayer & Müller 2019, §3.5).
enum class SignMode {
  Harmonic,  ///< Least-squares fit to all crossings (Eq. 5); exact on closed meshes.
  Exact,  ///< Exact winding number of every sample, with the faces reversed as by `Harmonic`: for reference.
  Paths,  ///< Mean over paths through six axis orders to each offset point: the paper's simple variant.
  Evolution,  ///< Iteration of Eq. 10 and 11.
  Rays,       ///< Mean of the six axis-parallel rays (Eq. 9).
  Ray,        ///< The ray along +x alone (Fig. 5, left).
  None        ///< No sign: the field is unsigned.
};

/// How `Paths` and `Evolution` sample curves (Krayer & Müller 2019, §3.5). An offset point lies inside or
/// outside the grid.
enum class Sampling {
  /// Points spread over a box around the sample, with sides of 3/16 of the grid's. `Paths` has one a pass,
  /// `Evolution` four a step. The winding number outside the grid is 0.
  Spread,
  /// The eight diagonal neighbours, twice as far in each further pass or step: the paper's example. Outside
  /// the grid it is the mean of the point's six rays (Eq. 7).
  Paper
};

/// Whether faces that point the wrong way may be reversed.
enum class Orientation {
  Auto,   ///< If rays disagree and reversing makes them agree clearly better. Only with `Harmonic` and
          ///< `Exact`.
  Keep,   ///< Never.
  Repair  ///< Whenever the rays then agree no worse.
};

/// Definition of the field. The defaults suit most meshes; raymap/machine.h says where it is made.
struct FieldOptions {
  /// Distance to the closest triangle: `exact`, or the faster approximations `neighbours`, `cell` and
  /// `raster`.
  DistanceMode distance = DistanceMode::Exact;
  /// Method that decides inside and outside: `harmonic`, by one ray and the edges of holes, or by the
  /// smoothest field that fits all rays; `exact`, `paths`, `evolution`, `rays`, `ray`, or `none` for
  /// distances without a sign.
  SignMode sign = SignMode::Harmonic;
  /// Whether faces that point the wrong way are reversed: `auto`, if the field then fits clearly better;
  /// `keep`, never; `repair`, whenever it fits no worse.
  Orientation orientation = Orientation::Auto;
  int passes = 5;  ///< Number of passes of the sign `paths`, or of steps of `evolution`.
  /// Offset points of the signs `paths` and `evolution`: `spread` over a box around the sample, or `paper`
  /// for those of the paper.
  Sampling sampling = Sampling::Spread;
  /// Offset points of `paths` and `evolution` in samples, used in turn, in place of those of `sampling`.
  std::vector<glm::ivec3> offsets = {};
  double threshold = 0.5;  ///< A point is inside if |winding number| exceeds this.
  double band = 0.0;       ///< Distances are clamped to this many samples; 0 = not clamped.
  bool invert = false;     ///< Whether to make inside positive and outside negative.
  /// Whether to measure distances to the surface that is missing in holes, too. Without it, holes are closed
  /// in steps as large as samples.
  bool closeHoles = false;
  bool triangle = false;    ///< Whether to compute closest triangles; not with the distance `raster`.
  bool winding = false;     ///< Whether to compute winding numbers. Needs a sign.
  bool confidence = false;  ///< Whether to compute the confidence in the sign. Needs a sign.

  /// Thickness of a wall around the surface, in the mesh's units; 0 = none. The solid is everything within
  /// half of it from the surface, whatever `sign` says: for sheets that enclose nothing. Excludes `winding`,
  /// `confidence` and `closeHoles`, which need a sign. The grid grows by half of it.
  double thickness = 0.0;

  /// Whether to accept a mesh without triangles. All samples are then outside and as far as numbers go: at
  /// the `band`, or at the largest float without one. They have no triangle, winding number 0 and
  /// confidence 1.
  bool allowEmpty = false;

  bool operator==(const FieldOptions&) const = default;
};

/// Costs of a run, and its findings about the mesh.
struct Stats {
  /// A stage of the work.
  struct Stage {
    std::string name = {};      ///< Name of the stage.
    double milliseconds = 0.0;  ///< Time that it took; on a GPU, by its own clock.
  };
  std::string device = {};         ///< Device that computed: "cpu" or "vulkan:K"; empty if none did.
  std::vector<Stage> stages = {};  ///< Stages in the order in which they ran.
  double milliseconds = 0.0;       ///< Time from triangles in memory to the finished field.
  size_t bytes = 0;                ///< Most bytes that the generator and the field held together.
  double doubtfulShare = 0.0;      ///< Share of samples whose six rays disagree; 0 on a consistent mesh.
  std::vector<uint32_t> turnedFaces = {};  ///< Indices of the faces that were reversed, ascending.
  /// Indices of the faces that the sign left out, ascending. Each has the corners of another one. It repeats
  /// that one in the same winding order, or is the other side of a double-sided face that bounds a solid.
  std::vector<uint32_t> leftOutFaces = {};
  /// Lowest face of each part that was reversed because it is inside out and crosses others, ascending.
  std::vector<uint32_t> invertedParts = {};
  /// Misfit of the given mesh, 0 to 1: how badly the crossings of rays contradict each other. 0 if one field
  /// explains them all, or if it was not examined.
  double misfitGiven = 0.0;
  double misfit = 0.0;  ///< The same with `turnedFaces` reversed and without `leftOutFaces`.
  bool orientationFits =
      true;  ///< False if the faces were examined, but no choice has a misfit of at most 0.5.
  size_t patchTriangles = 0;  ///< Number of triangles of the surface that closes holes.
  double patchArea = 0.0;     ///< Its area, in the mesh's units squared.
};

}  // namespace raymap
