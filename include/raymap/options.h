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
  Raymap,
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
  DistanceMode distance = DistanceMode::Exact;
  SignMode sign = SignMode::Harmonic;
  Orientation orientation = Orientation::Auto;
  int passes = 5;                        ///< Number of passes P of `Paths` or of steps of `Evolution`.
  Sampling sampling = Sampling::Raymap;  ///< Offset points of `Paths` and `Evolution`, and the rays there.
  std::vector<glm::ivec3> offsets =
      {};                   ///< Offset points in samples, used in turn, in place of `sampling`'s.
  double threshold = 0.5;   ///< A sample is inside if |winding number| exceeds this (§3.5).
  double band = 0.0;        ///< Distances are clamped to this many samples; 0 = not clamped.
  bool invert = false;      ///< Whether inside is positive instead of negative.
  bool closeHoles = false;  ///< Whether distances count the surface that is missing in holes.
  bool triangle = false;    ///< Whether to fill `Field::triangle`; not with `Raster`.
  bool winding = false;     ///< Whether to fill `Field::winding`; not without a sign.
  bool confidence = false;  ///< Whether to fill `Field::confidence`; not without a sign.

  /// Thickness of a wall around the surface, in the mesh's units. Above 0, the solid is everything within
  /// half of it from the surface, whatever `sign` says: for sheets that enclose nothing. Excludes `winding`,
  /// `confidence` and `closeHoles`, which need a sign. `GridOptions::thickness` makes place for it in the
  /// grid.
  double thickness = 0.0;

  /// Whether a mesh may have no triangles. All samples are then outside and as far as numbers go: at the
  /// band, or at the largest float without one; they have `kNoTriangle`, winding number 0 and confidence 1.
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
  double misfitGiven = 0.0;  ///< Disagreement of the crossings of the given mesh, 0 to 1; 0 if not examined.
  double misfit = 0.0;       ///< The same with `turnedFaces` reversed and without `leftOutFaces`.
  bool orientationFits =
      true;  ///< False if the faces were examined, but no choice has a misfit of at most 0.5.
  size_t patchTriangles = 0;  ///< Number of triangles of the surface that closes holes.
  double patchArea = 0.0;     ///< Its area, in the mesh's units squared.
};

}  // namespace raymap
