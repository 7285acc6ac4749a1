#pragma once

#include <raymap/callbacks.h>
#include <raymap/field.h>
#include <raymap/mesh.h>

#include <memory>
#include <string>
#include <vector>

namespace raymap {

/// Where the unsigned distance comes from (paper §3.3).
enum class DistanceMode {
  Exact,       ///< The true closest triangle of every sample.
  Neighbours,  ///< Triangles of the nearest occupied cell and of its 26 neighbours.
  Cell,        ///< Triangles of the nearest occupied cell: the paper's choice.
  Raster       ///< Distances in touched cells, then the distance transform alone.
};

/// Where the winding number comes from (paper §3.5).
enum class SignMode {
  Harmonic,   ///< Least-squares fit to all crossings; exact on closed meshes.
  Paths,      ///< Six axis orders to each offset point, averaged (the paper's simple variant).
  Evolution,  ///< Equations 10 and 11.
  Rays,       ///< The six rays.
  None        ///< No sign: an unsigned field.
};

/// Whether faces may be turned that point the wrong way.
enum class Orientation {
  Auto,   ///< Where the rays disagree, and only if they then agree clearly better (with `Harmonic`).
  Keep,   ///< Never.
  Repair  ///< Always, if they then agree no worse.
};

/// One of these per generated field; the defaults suit most meshes.
struct Options {
  DistanceMode distance = DistanceMode::Exact;
  SignMode sign = SignMode::Harmonic;
  Orientation orientation = Orientation::Auto;
  int passes = 5;  ///< Passes P of `Paths` (one offset point each), steps of `Evolution` (four).
  std::vector<glm::ivec3> offsets;  ///< Offset points, in samples, taken in turn; empty = the built-in set.
  double threshold = 0.5;           ///< Inside means |winding number| > threshold.
  double band = 0.0;                ///< Clamp distances to this many samples; 0 = everywhere exact.
  bool invert = false;              ///< Positive inside instead.
  bool closeHoles = false;          ///< Take distances to the surface missing in holes too.
  int threads = 0;                  ///< Of the CPU; 0 = all.
  bool triangleIds = false;         ///< Also give the closest triangle of each sample (not with `Raster`),
  bool winding = false;             ///< the winding number,
  bool confidence = false;          ///< and how sure the sign is.
  size_t memoryLimit = 0;           ///< Bytes the generator may hold; 0 = what the machine has left.

  /// Above 0: the solid of all within half of this of the surface, in the mesh's units, whatever `sign` says.
  /// For sheets that bound nothing; `winding`, `confidence` and `closeHoles` need a sign and must be off.
  double thickness = 0.0;

  /// What computes: "cpu"; "vulkan:K", the Kth Vulkan device, or "vulkan", the best of them, be it a driver
  /// in software; "auto": a real GPU if one is usable, else the CPU. The same fields but for rounding.
  std::string device = "auto";
  WarningCallback warn;       ///< Called with the reason when `auto` falls back to the CPU.
  ProgressCallback progress;  ///< Called every few milliseconds; a cancelled call leaves the field empty.
};

/// What a run cost.
struct Stats {
  std::string device;  ///< "cpu" or "vulkan:K".
  struct Stage {
    std::string name;
    double milliseconds = 0.0;
  };
  std::vector<Stage> stages;
  double totalMilliseconds = 0.0;     ///< From triangles in memory to the finished field.
  size_t bytes = 0;                   ///< Held by the generator and the field together at the peak.
  double doubtfulShare = 0.0;         ///< Share of samples whose six rays disagree; 0 on a consistent mesh.
  std::vector<uint32_t> turnedFaces;  ///< Which faces were taken the other way round, ascending.
  /// How badly the crossings of the mesh agree, as it was given and with these faces turned: from 0, where
  /// all do, to 1. Both 0 where nothing was to be turned.
  double misfitGiven = 0.0, misfit = 0.0;
  size_t patchTriangles = 0;  ///< Of the surface that closes holes.
  double patchArea = 0.0;     ///< In the mesh's units.
};

/// Makes fields, keeping its buffers between calls: for meshes that change every frame. Not thread-safe.
class Generator {
 public:
  Generator();
  ~Generator();
  Generator(Generator&&) noexcept;
  Generator& operator=(Generator&&) noexcept;

  /// Fills `field`, reusing its memory. Same input, same output, bit for bit, for any number of threads.
  /// Throws `Error`: Input (see `validate`), Usage, Memory, Cancelled; the field is then empty.
  Stats generate(const Mesh& mesh, const Grid& grid, const Options& options, Field& field);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A field and what it cost.
struct Generated {
  Field field;
  Stats stats;
};

/// One field, with a generator of its own.
Generated generate(const Mesh& mesh, const Grid& grid, const Options& options = {});

}  // namespace raymap
