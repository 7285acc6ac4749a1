#pragma once

// Ours: the field decides which way faces point (docs/signs.md).

#include <raymap/generate.h>

#include <functional>
#include <span>

#include "method/backend_concepts.h"

namespace raymap {

/// Distance from a large face at which its field is read, in square roots of twice its area. It is at least
/// one cell: closer to such a face the field falls whichever way the face points.
inline constexpr float kFarSides = 0.7f;

/// Faces to reverse, and the misfits before and after. A misfit is the sum of squares by which the field
/// misses the jumps along the lattice edges, divided by the sum of the jumps' magnitudes.
struct FaceSides {
  Turns turns;  ///< Empty if no face was examined.
  double misfitGiven = 0.0, misfit = 0.0;
  double doubtfulShare = 0.0;  ///< Share of samples whose six rays disagree, with the faces as given.

  /// Returns the indices of the reversed faces, ascending.
  std::vector<uint32_t> turnedFaces() const;
};

/// Functions that `chooseSides` needs.
struct FaceField {
  /// Computes the harmonic field of the mesh with these faces reversed. Returns its misfit.
  std::function<double(const Turns& turns)> solve;
  /// Returns, for each face as given, how much the last solved field rises along its normal.
  std::function<std::span<const float>()> rises;
  /// Returns the same for the share of the six rays that cross an odd number of faces. It does not depend on
  /// turns and replaces the solved field.
  std::function<std::span<const float>()> parityRises;
};

/// Returns whether the options allow faces to be reversed at all.
bool mayTurnFaces(const Options& options);

/// Returns whether to examine the faces of a mesh whose field has this misfit. Unless `Orientation::Repair`
/// forces it, it returns false if the misfit is small and no sign contradicts the parity of all six rays.
/// Reversing faces could then hardly change a sign.
bool shouldExamineFaces(const Options& options, double misfit, bool contradictsParity);

/// Chooses the faces to reverse: those that the field contradicts, if that lowers the misfit as much as
/// `orientation` demands. On entry `field` must be solved for the mesh as given, with misfit `misfitGiven`.
/// On return it is solved for the result's turns.
FaceSides chooseSides(const PackedMesh& mesh, double misfitGiven, Orientation orientation,
                      const FaceField& field, Progress& progress);

/// Runs the stage `orientation`, after `winding`. Leaves the winding number of the mesh with reversed faces.
template <HostBackend B>
void orientFaces(B& backend) {
  const Options& options = backend.options();
  if (!mayTurnFaces(options)) return;
  FaceSides& sides = backend.faceSides();
  sides.doubtfulShare = backend.doubtfulShare();
  const bool isForced = options.orientation == Orientation::Repair;
  if (sides.doubtfulShare == 0.0 && !isForced) return;

  const auto solve = [&](const Turns& turns) {  // Runs the stages before this one again.
    backend.turnFaces(turns);
    backend.crossings();
    backend.rayMap();
    backend.winding(SignMode::Harmonic);
    return backend.misfit();
  };
  const bool isHarmonic = options.sign == SignMode::Harmonic;
  const double misfit = isHarmonic ? backend.misfit() : solve(Turns(backend.mesh().triangles.size(), 0));
  if (!shouldExamineFaces(options, misfit, backend.contradictsParity())) {
    sides.misfitGiven = sides.misfit = misfit;
    return;
  }
  const double doubtfulShare = sides.doubtfulShare;
  sides = chooseSides(backend.mesh(), misfit, options.orientation,
                      {solve, [&] { return backend.rises(); }, [&] { return backend.parityRises(); }},
                      backend.progress());
  sides.doubtfulShare = doubtfulShare;
  if (!isHarmonic) backend.winding(options.sign);
}

}  // namespace raymap
