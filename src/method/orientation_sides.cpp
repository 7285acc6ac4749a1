// Ours: decides which way faces point, where Krayer & Müller 2019, §3.5, take them as given.
//
// All faces of a patch are reversed together. A patch starts in the direction of most of its faces. If there
// is no clear majority, it starts as the parity of the crossings says. Then patches along whose normals the
// field rises are reversed. The misfit of the least-squares fit rates every state (docs/signs.md).

#include "method/orientation_sides.h"

#include <algorithm>
#include <cmath>

#include "mesh/patches.h"

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

/// Reversed faces, and the misfit of the field with them.
struct State {
  Turns turns;
  double misfit = INFINITY;
};

/// Returns twice the area of each face.
std::vector<float> areasOf(const PackedMesh& mesh) {
  std::vector<float> areas;
  areas.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 a = mesh.vertices[t.x];
    areas.push_back(glm::length(glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a)));
  }
  return areas;
}

/// Number of a patch's faces that are given like its first one, and number of all its faces.
struct Votes {
  int64_t alike = 0, all = 0;

  /// Returns whether the faces agree, or differ from tossed coins by more than three standard deviations.
  bool areClear() const {
    return alike == all || std::abs(double(2 * alike - all)) > 3.0 * std::sqrt(double(all));
  }
};

class SideChooser {
 public:
  SideChooser(const PackedMesh& mesh, double misfitGiven, const FaceField& field, Progress& progress)
      : patches_(findPatches(mesh)),
        areas_(areasOf(mesh)),
        field_(field),
        progress_(progress),
        given_{Turns(mesh.triangles.size(), 0), misfitGiven},
        solved_(given_) {}

  FaceSides choose(bool isForced) {
    solve(startFromGiven());
    State best = solved_;
    const bool isBetter = isForced ? best.misfit <= given_.misfit : best.misfit < kAligned * given_.misfit;
    if (!isBetter) best = given_;
    // Reversing all faces of a single patch only turns the mesh inside out, which changes no sign.
    if (patches_.count > 1) {
      const State start = best;
      takeIfBetter(improve(solved_.turns), start, best);
      if (best.misfit > 0.0) takeIfBetter(improve(startFromParity()), start, best);
    }
    solve(best.turns);
    return {.turns = std::move(best.turns), .misfitGiven = given_.misfit, .misfit = best.misfit};
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
    std::vector<Votes> votes(patches_.count);
    for (size_t f = 0; f < patches_.ids.size(); ++f) {
      ++votes[patches_.ids[f]].all;
      votes[patches_.ids[f]].alike += patches_.isReversed[f] ? 0 : 1;
    }
    const bool areClear =
        std::all_of(votes.begin(), votes.end(), [](const Votes& v) { return v.areClear(); });
    Turns turns = areClear ? patches_.isReversed : startFromParity();
    for (size_t f = 0; f < turns.size(); ++f)
      if (const Votes& v = votes[patches_.ids[f]]; v.areClear())
        turns[f] = uint8_t(patches_.isReversed[f] ^ uint8_t(2 * v.alike < v.all));
    return turns;
  }

  Turns startFromParity() {
    Turns turns = patches_.isReversed;
    turnRising(field_.parityRises(), 0.0, turns);
    solved_.turns.clear();
    return turns;
  }

  /// Reverses the patches along whose normals a field rises by more than `least` in the mean. Returns their
  /// share of the surface.
  double turnRising(std::span<const float> rises, double least, Turns& turns) const {
    std::vector<double> sums(patches_.count, 0.0);
    for (size_t f = 0; f < turns.size(); ++f)
      sums[patches_.ids[f]] += areas_[f] * ((turns[f] ? -rises[f] : rises[f]) - least);
    double turned = 0.0, all = 0.0;
    for (size_t f = 0; f < turns.size(); ++f) {
      const bool isRising = sums[patches_.ids[f]] > 0.0;
      turns[f] ^= uint8_t(isRising);
      turned += isRising ? areas_[f] : 0.0;
      all += areas_[f];
    }
    return all > 0.0 ? turned / all : 0.0;
  }

  /// Reverses patches as the field says for as long as the misfit falls. Returns the best state.
  State improve(Turns turns) {
    State best;
    for (int round = 0; round < kMostRounds; ++round) {
      solve(turns);
      if (!(solved_.misfit < best.misfit)) break;
      best = solved_;
      if (best.misfit == 0.0) break;
      risingShare_ = std::max(risingShare_, turnRising(field_.rises(), kLeastRise, turns));
      if (turns == best.turns) break;
    }
    return best;
  }

  void solve(const Turns& turns) {
    if (turns == solved_.turns) return;
    constexpr double kMostSolves = 2 * kMostRounds + 1;
    progress_.part(solves_ / kMostSolves, (solves_ + 1) / kMostSolves);
    ++solves_;
    solved_.misfit = field_.solve(turns);
    solved_.turns = turns;
  }

  Patches patches_;
  std::vector<float> areas_;
  const FaceField& field_;
  Progress& progress_;
  State given_, solved_;
  int solves_ = 0;
  double risingShare_ = 0.0;  ///< Largest share of the surface that the field contradicted in one round.
};

}  // namespace

std::vector<uint32_t> FaceSides::turnedFaces() const {
  std::vector<uint32_t> faces;
  for (uint32_t f = 0; f < turns.size(); ++f)
    if (turns[f]) faces.push_back(f);
  return faces;
}

bool mayTurnFaces(const Options& options) {
  if (options.orientation == Orientation::Repair) return options.sign != SignMode::None;
  return options.orientation == Orientation::Auto && options.sign == SignMode::Harmonic;
}

bool shouldExamineFaces(const Options& options, double misfit, bool contradictsParity) {
  return options.orientation == Orientation::Repair || contradictsParity || misfit > kFall;
}

FaceSides chooseSides(const PackedMesh& mesh, double misfitGiven, Orientation orientation,
                      const FaceField& field, Progress& progress) {
  return SideChooser(mesh, misfitGiven, field, progress).choose(orientation == Orientation::Repair);
}

}  // namespace raymap
