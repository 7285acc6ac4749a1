#pragma once

#include <raymap/generate.h>

#include <span>

#include "progress.h"

namespace raymap {

/// Which faces are turned: 1 for those taken the other way round than given.
using Turns = std::vector<uint8_t>;

/// How far from a face its field is read, in roots of twice its area, but no less than a cell: close to a
/// large face it falls whatever way the face points.
inline constexpr float kFarSides = 0.7f;

/// What choosing the sides of the faces needs of a backend.
class FaceField {
 public:
  virtual ~FaceField() = default;
  /// Makes the harmonic field of the mesh with these turns; returns its misfit, see `FaceSides`.
  virtual double solve(const Turns& turns) = 0;
  /// For each face as given, how much the field of the last `solve` rises along its normal.
  virtual std::span<const float> rises() = 0;
  /// The same of another field, which does not depend on turns and replaces that one: the share of the six
  /// rays that cross an odd number of faces.
  virtual std::span<const float> parityRises() = 0;
};

/// Which faces to turn, and how badly the crossings agree before and after: the squares of what the field
/// misses of the jumps at the crossed lattice edges, over the sum of these jumps.
struct FaceSides {
  Turns turns;  ///< Empty where none was looked at.
  double misfitGiven = 0.0, misfit = 0.0;

  void report(Stats& stats) const;
};

/// Whether faces are to be looked at, where the six rays disagree at a share of the samples.
bool mayTurnFaces(const Options& options, double doubtfulShare);

/// Whether to look at faces, where the field has this misfit. Not if that is small and no sign contradicts
/// the parity of all six rays: turning faces could then hardly change one.
bool shouldLookAtFaces(const Options& options, double misfit, bool contradictsParity);

/// Turns the faces whose field says that they point the wrong way, if the crossings then agree as much better
/// as `orientation` asks. `field` is solved for the mesh as given, whose misfit is told, and ends solved for
/// the turns chosen.
FaceSides chooseSides(const Mesh& mesh, double misfitGiven, Orientation orientation, FaceField& field,
                      Progress& progress);

}  // namespace raymap
