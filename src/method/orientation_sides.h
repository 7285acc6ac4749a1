#pragma once

// Ours: the field decides which way faces point (docs/signs.md).

#include <raymap/field.h>
#include <raymap/options.h>

#include <functional>
#include <span>

#include "mesh/double_sided.h"
#include "mesh/inverted_parts.h"
#include "method/backend_concepts.h"
#include "method/orientation_sheets.h"

namespace raymap {

/// Distance from a large face at which its field is read, in square roots of twice its area. It is at least
/// one cell: closer to such a face the field falls whichever way the face points.
inline constexpr float kFarSides = 0.7f;

/// Measure of a field beside a face: its rise from behind the face to the front, or how whole it is on both
/// sides (`NearSides::wholeness`).
enum class SideMeasure { Rise, Wholeness };

/// Turns of the faces, and the misfits before and after. A misfit is the sum of squares by
/// which the field misses the jumps along the lattice edges, divided by the sum of the jumps' magnitudes.
struct FaceSides {
  Turns turns;  ///< Empty if the sign takes all faces as given.
  double misfitGiven = 0.0, misfit = 0.0;
  double doubtfulShare = 0.0;  ///< Share of samples whose six rays disagree, with the faces as given.
  std::vector<uint32_t> invertedParts = {};  ///< Lowest face of each part that was inside out.
  bool fits = true;  ///< False if no orientation was found whose misfit is small enough.

  /// Returns the indices of the reversed faces, ascending.
  std::vector<uint32_t> turnedFaces() const { return facesWith(kReversed); }
  /// Returns the indices of the faces that the sign leaves out, ascending.
  std::vector<uint32_t> leftOutFaces() const { return facesWith(kLeftOut); }

 private:
  std::vector<uint32_t> facesWith(uint8_t turn) const;
};

/// Functions that `chooseSides` needs.
struct FaceField {
  /// Computes the harmonic field of the mesh with these turns. Returns its misfit.
  std::function<double(const Turns& turns)> solve;
  /// Takes the mean of the six rays as the field, for the mesh with these turns. Returns whether all rays
  /// agree. The field is then the harmonic one, and its misfit is 0.
  std::function<bool(const Turns& turns)> raysAgree;
  /// Returns whether a sign of the last solved field contradicts the parity of all six rays.
  std::function<bool()> contradictsParity;
  /// Returns, for each face as given, how much the last solved field rises along its normal.
  std::function<std::span<const float>()> rises;
  /// Returns the same for the share of the six rays that cross an odd number of faces. It does not depend on
  /// which faces are reversed, but on which are left out. It replaces the solved field.
  std::function<std::span<const float>(const Turns& turns)> parityRises;
  /// Returns the last solved field one cell in front of each face and one cell behind it.
  std::function<NearSides()> nearSides;
};

/// The mesh whose faces are examined.
struct ExaminedMesh {
  PackedMesh mesh;
  DoubleSidedFaces doubleSided;
  double spacing;  ///< Sample spacing in the mesh's units.
};

/// Returns whether the options allow faces to be reversed at all.
bool mayTurnFaces(const FieldOptions& options);

/// Returns the mode of the numbers that choose the faces: exact ones wait until all are chosen.
SignMode modeBeforeOrientation(const FieldOptions& options);

/// Returns whether to examine the faces of a mesh whose field has this misfit. Unless `Orientation::Repair`
/// forces it, it returns false if the misfit is small and no sign contradicts the parity of all six rays.
/// Reversing faces could then hardly change a sign.
bool shouldExamineFaces(const FieldOptions& options, double misfit, bool contradictsParity);

/// Returns whether two choices leave out the same faces.
bool leaveOutTheSame(const Turns& a, const Turns& b);

/// Throws `Error(Memory)` if the faces of a mesh are too many to be examined in the memory left.
void requireExamining(const PackedMesh& mesh, size_t bytesLeft);

/// Chooses which faces the sign takes reversed or not at all. On entry `field` must be solved for the mesh as
/// given, with misfit `misfitGiven`. On return it is solved for the result's turns.
///
/// If double-sided faces bound a solid with the rest, one of each group is taken. Then the faces are
/// reversed that the field contradicts, if that lowers the misfit as much as `orientation` demands;
/// `mayReverse` is false if they need not be examined.
FaceSides chooseSides(const ExaminedMesh& examined, double misfitGiven, Orientation orientation,
                      bool mayReverse, const FaceField& field, Progress& progress);

/// Runs the stages up to the ray map again, with these turns.
template <HostBackend B>
void countAgain(B& backend, const Turns& turns) {
  backend.turnFaces(turns);
  backend.crossings();
  backend.rayMap();
}

/// Leaves repeated faces out of the winding number, if there are any.
template <HostBackend B>
void leaveOutRepeated(B& backend, const DoubleSidedFaces& faces) {
  if (faces.repeated.empty()) return;
  backend.doubtfulShare();  // The device must have read the faces as given.
  FaceSides& sides = backend.faceSides();
  sides.turns = withoutRepeated(faces, backend.mesh().triangles.size());
  countAgain(backend, sides.turns);
  backend.winding(modeBeforeOrientation(backend.options()));
}

/// Reverses the faces that the field contradicts, and takes double-sided ones once.
template <HostBackend B>
void reverseFaces(B& backend, const ExaminedMesh& examined) {
  const FieldOptions& options = backend.options();
  FaceSides& sides = backend.faceSides();
  const bool isForced = options.orientation == Orientation::Repair;
  sides.doubtfulShare = backend.doubtfulShare();
  const bool hasDouble = !examined.doubleSided.empty();
  if (sides.doubtfulShare == 0.0 && !isForced && !hasDouble) return;

  Turns counted = withoutRepeated(examined.doubleSided, backend.mesh().triangles.size());
  const auto count = [&](const Turns& turns) {
    counted = turns;
    countAgain(backend, turns);
  };
  const auto solve = [&](const Turns& turns) {
    count(turns);
    backend.winding(SignMode::Harmonic);
    return backend.misfit();
  };
  const auto raysAgree = [&](const Turns& turns) {
    count(turns);
    backend.winding(SignMode::Rays);
    return backend.doubtfulShare() == 0.0 && backend.misfit() == 0.0;
  };
  const auto parityRises = [&](const Turns& turns) {
    if (!leaveOutTheSame(turns, counted)) count(turns);
    return backend.parityRises();
  };
  const double misfit =
      modeBeforeOrientation(options) == SignMode::Harmonic ? backend.misfit() : solve(counted);
  const bool mayReverse = shouldExamineFaces(options, misfit, backend.contradictsParity());
  if (!mayReverse && !hasDouble) {
    sides.misfitGiven = sides.misfit = misfit;
  } else {
    requireExamining(backend.mesh(), backend.bytesLeft());
    const double doubtfulShare = sides.doubtfulShare;
    sides = chooseSides(examined, misfit, options.orientation, mayReverse,
                        {.solve = solve,
                         .raysAgree = raysAgree,
                         .contradictsParity = [&] { return backend.contradictsParity(); },
                         .rises = [&] { return backend.rises(); },
                         .parityRises = parityRises,
                         .nearSides = [&] { return backend.nearSides(); }},
                        backend.progress());
    sides.doubtfulShare = doubtfulShare;
  }
  if (options.sign != SignMode::Harmonic) backend.winding(options.sign);
}

/// Reverses parts that are inside out and cross others.
template <HostBackend B>
void turnInvertedParts(B& backend) {
  FaceSides& sides = backend.faceSides();
  if (sides.turns.empty() && !backend.mesh().mayHaveInvertedParts()) return;
  const PackedMesh& mesh = backend.mesh();
  const Buffer<glm::uvec3> faces = turnedTriangles(mesh.triangles, sides.turns);
  const PackedMesh taken{mesh.vertices, faces, mesh.origin};
  if (!mayHaveInvertedParts(taken)) return;
  requireExamining(mesh, backend.bytesLeft());
  const InvertedParts found = findInvertedParts(taken);
  if (found.faces.empty()) return;
  sides.turns.resize(faces.size(), kAsGiven);
  for (const uint32_t face : found.faces) sides.turns[face] ^= kReversed;
  sides.invertedParts = found.firsts;
  countAgain(backend, sides.turns);
  backend.winding(backend.options().sign);
}

/// Runs the stage `orientation`, after `winding`. Leaves the winding number of the mesh with reversed faces
/// and without repeated ones.
template <HostBackend B>
void orientFaces(B& backend) {
  // Before the host waits for the device's findings, so that it searches meanwhile.
  const ExaminedMesh examined{
      .mesh = backend.mesh(), .doubleSided = backend.doubleSidedFaces(), .spacing = backend.spacing()};
  leaveOutRepeated(backend, examined.doubleSided);
  if (!mayTurnFaces(backend.options())) return;
  reverseFaces(backend, examined);
  turnInvertedParts(backend);
}

}  // namespace raymap
