// Ours: which way faces point, where Krayer & Müller 2019, §3.5, take them as they are.
//
// Faces of one patch turn together. A patch starts the way in which most of its faces are given, or, if that
// says nothing, as the parity of the crossings has it. Then the field turns patches along whose normals it
// rises. The misfit of the least-squares fit judges every state (docs/signs.md).

#include "method/orientation_sides.h"

#include <algorithm>
#include <cmath>

#include "mesh/patches.h"

namespace raymap {

namespace {

constexpr int kMostRounds = 6;
/// In the mean over a patch. 0 to 0.33 did equally well on faces flipped at random; with 0 inner walls of
/// cars are turned, which part nothing.
constexpr double kLeastRise = 0.2;
/// Neighbours are to point alike if that lowers the misfit to this share.
constexpr double kAligned = 0.97;
/// What the field or the parity turned has to lower the misfit to this share; where the field contradicts
/// many faces, that share of the surface, the second one will do, if it falls by so much from what was given.
constexpr double kByFar = 0.33, kClearly = 0.9, kFall = 0.05, kManyFaces = 0.02;
/// Where neighbours pointed so little alike that to align them lowers the misfit to this share, nothing
/// speaks for what was given: whatever then lowers it to the second share will do.
constexpr double kScattered = 0.4, kLower = 0.99;

/// A state and how badly the crossings agree in it.
struct State {
  Turns turns;
  double misfit = INFINITY;
};

/// Twice the area of each face.
std::vector<float> areasOf(const Mesh& mesh) {
  std::vector<float> areas;
  areas.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 a = mesh.vertices[t.x];
    areas.push_back(glm::length(glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a)));
  }
  return areas;
}

/// How many of a patch's faces are given the way its first one is.
struct Votes {
  int64_t alike = 0, all = 0;

  /// More than three standard deviations from what tossing coins would give.
  bool areClear() const {
    return alike == all || std::abs(double(2 * alike - all)) > 3.0 * std::sqrt(double(all));
  }
};

class SideChooser {
 public:
  SideChooser(const Mesh& mesh, double misfitGiven, const FaceField& field, Progress& progress)
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
    // All faces of a single patch turned is the same mesh inside out, which changes no sign.
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

  /// All patches as their faces vote, and as the parity says where that is not clear.
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

  /// Turns the patches along whose normals a field rises by so much in the mean; returns their share of the
  /// surface.
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

  /// Lets the field turn patches for as long as that helps.
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
  double risingShare_ = 0.0;  ///< Of the surface, the most that the field wanted to turn at once.
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

FaceSides chooseSides(const Mesh& mesh, double misfitGiven, Orientation orientation, const FaceField& field,
                      Progress& progress) {
  return SideChooser(mesh, misfitGiven, field, progress).choose(orientation == Orientation::Repair);
}

}  // namespace raymap
