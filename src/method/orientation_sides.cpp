// Ours: decides which way faces point, where Krayer & Müller 2019, §3.5, take them as given.
//
// All faces of a patch are reversed together. A patch starts in the direction of most of its faces. If there
// is no clear majority, it starts as the parity of the crossings says. Then patches along whose normals the
// field rises are reversed. The misfit of the least-squares fit rates every state. Double-sided faces are
// tried first as one face each whose direction is unknown (docs/signs.md).

#include "method/orientation_sides.h"

#include <raymap/error.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/memory.h"
#include "mesh/parts.h"
#include "method/orientation_sheets.h"
#include "method/orientation_surface.h"
#include "method/winding_rims_lattices.h"

namespace raymap {

namespace {

constexpr int kMostRounds = 6;
/// Mean rise over a patch from which on it is reversed. Values from 0 to 0.33 did equally well on faces
/// flipped at random. With 0, inner walls of cars are reversed although they separate nothing.
constexpr double kLeastRise = 0.2;
/// Aligned neighbours are kept if they lower the misfit to less than this share.
constexpr double kAligned = 0.97;
/// Reversals by the field or the parity are kept if they lower the misfit to less than the share `kByFar`.
/// `kClearly` is enough if the field contradicts more than `kManyFaces` of the surface and the misfit falls
/// by more than `kFall` from the start.
constexpr double kByFar = 0.33, kClearly = 0.9, kFall = 0.05, kManyFaces = 0.02;
/// If alignment lowers the misfit to less than the share `kScattered`, the given directions say nothing. Then
/// any further reversals are kept that lower the misfit to less than the share `kLower`.
constexpr double kScattered = 0.4, kLower = 0.99;
/// Misfit above which no orientation fits.
constexpr double kMostMisfit = 0.5;
/// Standard deviations of tossed coins from which on a majority of a part's area is no accident.
constexpr double kNoAccident = 1.0;
/// Share of a flipped part's area by which the misfit may rise.
constexpr double kAsGood = 0.1;

/// A choice of turns, and the misfit of the field with them.
struct State {
  Turns turns;
  double misfit = INFINITY;
};

/// Number of a patch's faces that are given like its first one, and number of all its faces. Only faces
/// whose given direction counts are counted.
struct Votes {
  int64_t alike = 0, all = 0;

  /// Returns whether the faces agree, or differ from tossed coins by more than three standard deviations.
  bool areClear() const {
    return all > 0 && (alike == all || std::abs(double(2 * alike - all)) > 3.0 * std::sqrt(double(all)));
  }
};

/// Solves the field for turns and remembers the last ones.
class FieldSolver {
 public:
  FieldSolver(const FaceField& field, Progress& progress, State solved)
      : field_(field), progress_(progress), solved_(std::move(solved)) {}

  const State& solve(const Turns& turns) {
    if (turns == solved_.turns) return solved_;
    constexpr double kMostSolves = 2 * kMostRounds + 1;  // More are rare; progress waits for them.
    progress_.part(std::min(solves_ / kMostSolves, 1.0), std::min((solves_ + 1) / kMostSolves, 1.0));
    ++solves_;
    solved_.misfit = field_.solve(turns);
    solved_.turns = turns;
    return solved_;
  }
  /// Returns whether all rays agree with these turns. The field is then solved for them.
  bool raysAgree(const Turns& turns) {
    solved_.turns.clear();
    if (!field_.raysAgree(turns)) return false;
    solved_ = {turns, 0.0};
    return true;
  }
  std::span<const float> parityRises(const Turns& turns) {
    solved_.turns.clear();
    return field_.parityRises(turns);
  }
  const FaceField& field() const { return field_; }

 private:
  const FaceField& field_;
  Progress& progress_;
  State solved_;
  int solves_ = 0;
};

class SideChooser {
 public:
  SideChooser(const ExaminedMesh& examined, const OrientationSurface& surface, FieldSolver& solver,
              State given)
      : examined_(examined), surface_(surface), solver_(solver), given_(std::move(given)) {}

  /// Returns the best state that was found, or the given one where none is better enough.
  State choose(bool isForced) {
    const State first = solver_.solve(startFromGiven());
    State best = first;
    const bool isBetter = isForced ? best.misfit <= given_.misfit : best.misfit < kAligned * given_.misfit;
    if (!isBetter) best = given_;
    // Reversing all faces of a single patch only turns the mesh inside out, which changes no sign.
    if (surface_.patchCount() > 1) {
      const State start = best;
      takeIfBetter(improve(first.turns), start, best);
      if (best.misfit > 0.0 && !isFromParity_)
        if (const Turns& parity = startFromParity(); parity != first.turns)
          takeIfBetter(improve(parity), start, best);
      keepGivenParts(best);
    }
    return best;
  }

  /// Returns the part of each patch.
  const std::vector<uint32_t>& parts() {
    if (parts_.empty())
      parts_ = findParts(examined_.mesh, surface_.taken, surface_.patches, 0.5 * examined_.spacing);
    return parts_;
  }

 private:
  void takeIfBetter(State state, const State& start, State& best) const {
    const bool isClear = risingShare_ > kManyFaces && state.misfit < kClearly * best.misfit &&
                         state.misfit < start.misfit - kFall;
    const double enough = start.misfit < kScattered * given_.misfit ? kLower : kByFar;
    if (isClear || state.misfit < enough * best.misfit) best = std::move(state);
  }

  /// Returns the turns with which each patch points as most of its faces do, or as the parity says if the
  /// vote is not clear.
  Turns startFromGiven() {
    const Patches& patches = surface_.patches;
    std::vector<Votes> votes(patches.count);
    for (const uint32_t f : surface_.taken) {
      votes[patches.ids[f]].all += surface_.isDirected[f];
      votes[patches.ids[f]].alike += surface_.isDirected[f] && !patches.isReversed[f] ? 1 : 0;
    }
    bool areClear = true;
    isFromParity_ = true;
    for (size_t p = 0; p < patches.count; ++p) {
      const bool isClear = votes[p].areClear();
      areClear = areClear && (surface_.patchAreas[p] == 0.0 || isClear);
      isFromParity_ = isFromParity_ && !isClear;
    }
    Turns turns = areClear ? surface_.aligned() : startFromParity();
    for (const uint32_t f : surface_.taken)
      if (const Votes& v = votes[patches.ids[f]]; v.areClear())
        turns[f] = uint8_t(patches.isReversed[f] ^ uint8_t(2 * v.alike < v.all));
    return turns;
  }

  /// Returns the turns that the parity says. They do not depend on those of the solved field.
  const Turns& startFromParity() {
    if (parity_.empty()) {
      parity_ = surface_.aligned();
      turnRising(solver_.parityRises(parity_), 0.0, parity_);
    }
    return parity_;
  }

  /// Reverses the patches along whose normals a field rises by more than `least` in the mean. Returns their
  /// share of the surface.
  double turnRising(std::span<const float> rises, double least, Turns& turns) const {
    const std::vector<uint32_t>& ids = surface_.patches.ids;
    std::vector<double> sums(surface_.patches.count, 0.0);
    for (const uint32_t f : surface_.taken)
      sums[ids[f]] += surface_.areas[f] * ((turns[f] == kReversed ? -rises[f] : rises[f]) - least);
    double risingArea = 0.0;
    for (const uint32_t f : surface_.taken) {
      if (!(sums[ids[f]] > 0.0)) continue;
      turns[f] ^= kReversed;
      risingArea += surface_.areas[f];
    }
    return surface_.area > 0.0 ? risingArea / surface_.area : 0.0;
  }

  /// Reverses patches as the field says for as long as the misfit falls. Returns the best state.
  State improve(Turns turns) {
    State best;
    for (int round = 0; round < kMostRounds; ++round) {
      const State& solved = solver_.solve(turns);
      if (!(solved.misfit < best.misfit)) break;
      best = solved;
      if (best.misfit == 0.0) break;
      risingShare_ = std::max(risingShare_, turnRising(solver_.field().rises(), kLeastRise, turns));
      if (turns == best.turns) break;
    }
    return best;
  }

  /// A part's area whose chosen direction is the given one, minus the rest, and the deviation to expect if
  /// coins were tossed for its faces.
  struct PartVotes {
    uint32_t part;
    double agreement = 0.0, squares = 0.0, area = 0.0;
    bool areAgainst() const { return agreement < -kNoAccident * std::sqrt(squares); }
  };

  /// Reverses parts of the surface that touch no other part where most of their area is given the other way
  /// and the field fits as well: the inner one of two nested closed surfaces bounds a cavity or a solid.
  void keepGivenParts(State& best) {
    if (best.turns == surface_.asGiven) return;
    std::vector<PartVotes> against = votesAgainst(best.turns);
    if (against.empty() || flipIfAsGood(against, best)) return;
    std::sort(against.begin(), against.end(), [](const PartVotes& a, const PartVotes& b) {
      return a.area != b.area ? a.area > b.area : a.part < b.part;
    });
    for (size_t p = 0; p < std::min(against.size(), size_t(kMostRounds)) && against.size() > 1; ++p)
      flipIfAsGood({&against[p], 1}, best);
  }

  std::vector<PartVotes> votesAgainst(const Turns& turns) {
    std::vector<PartVotes> votes(parts().size());
    for (uint32_t p = 0; p < parts_.size(); ++p) votes[p].part = p;
    for (const uint32_t f : surface_.taken) {
      PartVotes& v = votes[parts_[surface_.patches.ids[f]]];
      const double area = surface_.areas[f];
      v.area += area;
      if (!surface_.isDirected[f]) continue;
      v.agreement += turns[f] == kAsGiven ? area : -area;
      v.squares += area * area;
    }
    std::erase_if(votes, [](const PartVotes& v) { return !v.areAgainst(); });
    return votes;
  }

  /// Reverses the parts if the field then fits as well. Returns whether it did.
  bool flipIfAsGood(std::span<const PartVotes> flipped, State& best) {
    std::vector<uint8_t> isFlipped(parts().size());
    double area = 0.0;
    for (const PartVotes& votes : flipped) {
      isFlipped[votes.part] = 1;
      area += votes.area;
    }
    Turns turns = best.turns;
    for (const uint32_t f : surface_.taken)
      if (isFlipped[parts_[surface_.patches.ids[f]]]) turns[f] ^= kReversed;
    const State& solved = solver_.solve(turns);
    if (solved.misfit > best.misfit + kAsGood * area / surface_.area) return false;
    best = solved;
    return true;
  }

  const ExaminedMesh& examined_;
  const OrientationSurface& surface_;
  FieldSolver& solver_;
  State given_;
  std::vector<uint32_t> parts_;  ///< See `parts`; empty until then.
  Turns parity_;                 ///< See `startFromParity`; empty until then.
  bool isFromParity_ = false;    ///< Whether the first state is wholly the one that the parity says.
  double risingShare_ = 0.0;     ///< Largest share of the surface that the field contradicted in one round.
};

/// Takes each double-sided group as one face of unknown direction where it bounds a solid with the rest.
/// Returns nothing if none does or nothing fits.
std::optional<State> chooseSingleFaces(const ExaminedMesh& examined, FieldSolver& solver) {
  const DoubleSidedFaces faces =
      withoutSheets(examined.mesh, examined.doubleSided, leastSheetArea(examined.spacing));
  if (faces.empty()) return {};
  if (faces.count() + faces.repeated.size() ==
      examined.mesh.triangles.size()) {  // All in order, perhaps: that needs no patches.
    Turns turns = withoutOthers(faces, examined.mesh.triangles.size());
    if (solver.raysAgree(turns) && !solver.field().contradictsParity()) return State{std::move(turns), 0.0};
  }
  const OrientationSurface surface = takeSingleFaces(examined.mesh, faces);
  SideChooser chooser(examined, surface, solver, {surface.asGiven, INFINITY});
  State best = chooser.choose(true);
  SheetFinder sheets(examined.spacing, faces, surface, chooser.parts());
  do best = solver.solve(best.turns);
  while (sheets.giveBack(solver.field().nearSides(), best.turns));
  if (!sheets.hasSolid() || best.misfit > kMostMisfit) return {};
  return best;
}

}  // namespace

std::vector<uint32_t> FaceSides::facesWith(uint8_t turn) const {
  std::vector<uint32_t> faces;
  for (uint32_t f = 0; f < turns.size(); ++f)
    if (turns[f] == turn) faces.push_back(f);
  return faces;
}

bool mayTurnFaces(const FieldOptions& options) {
  if (options.orientation == Orientation::Repair) return options.sign != SignMode::None;
  return options.orientation == Orientation::Auto && usesRims(options.sign);
}

SignMode modeBeforeOrientation(const FieldOptions& options) {
  return options.sign == SignMode::Exact && mayTurnFaces(options) ? SignMode::Harmonic : options.sign;
}

bool shouldExamineFaces(const FieldOptions& options, double misfit, bool contradictsParity) {
  return options.orientation == Orientation::Repair || contradictsParity || misfit > kFall;
}

bool leaveOutTheSame(const Turns& a, const Turns& b) {
  const auto sameFace = [](uint8_t s, uint8_t t) { return (s == kLeftOut) == (t == kLeftOut); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), sameFace);
}

void requireExamining(const PackedMesh& mesh, size_t bytesLeft) {
  // Bytes while patches and their borders are found. A triangle has three half edges, its patch, its turn,
  // its area and, if it is double-sided, its group; a vertex has a key, its bucket, an id and the index of
  // the first vertex at its position.
  constexpr size_t kOfTriangle = 120, kOfVertex = 26;
  const size_t needed = mesh.triangles.size() * kOfTriangle + mesh.vertices.size() * kOfVertex;
  if (needed > bytesLeft)
    throw Error(ErrorCode::Memory, "finding the reversed faces needs " + neededText(needed) + ", but only " +
                                       limitText(bytesLeft) +
                                       " are left; keep the faces' orientation, or use a higher limit");
}

FaceSides chooseSides(const ExaminedMesh& examined, double misfitGiven, Orientation orientation,
                      bool mayReverse, const FaceField& field, Progress& progress) {
  const bool isForced = orientation == Orientation::Repair;
  const State given{withoutRepeated(examined.doubleSided, examined.mesh.triangles.size()), misfitGiven};
  FieldSolver solver(field, progress, given);
  std::optional<State> best;
  if (!examined.doubleSided.empty()) best = chooseSingleFaces(examined, solver);
  if (!best && mayReverse) {
    const OrientationSurface surface = takeAllFaces(examined.mesh, given.turns);
    best = SideChooser(examined, surface, solver, given).choose(isForced);
  }
  if (!best) best = given;
  const bool fits = best->misfit <= kMostMisfit;
  if (!fits && !isForced) best = given;
  solver.solve(best->turns);
  return {.turns = std::move(best->turns), .misfitGiven = misfitGiven, .misfit = best->misfit, .fits = fits};
}

}  // namespace raymap
