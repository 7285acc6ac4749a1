// Ours: faces turned by the device's fields. The host decides, as for the CPU, from what it reads back: two
// numbers of each group of samples, and one of each face.

#include "backend.h"

namespace raymap::vulkan {

class Backend::FaceTurner : public FaceField {
 public:
  explicit FaceTurner(Backend& backend) : backend_(backend), turns_(backend.extent().triangles, 0) {}

  double solve(const Turns& turns) override {
    turns_ = turns;
    backend_.upload_.turn(*backend_.inputMesh_, turns);
    backend_.run("orientation", [&] {
      backend_.recordMesh(backend_.upload_.source());
      backend_.recordSolve();
      backend_.recordMisfit();
    });
    return backend_.orientationOf().misfit();
  }

  double misfit() {
    backend_.run("orientation", [&] { backend_.recordMisfit(); });
    return backend_.orientationOf().misfit();
  }

  std::span<const float> rises() override {
    backend_.run("orientation", [&] { backend_.recordRises(); });
    return ofGivenFaces();
  }

  std::span<const float> parityRises() override {
    backend_.run("orientation", [&] { backend_.recordParityRises(); });
    return ofGivenFaces();
  }

 private:
  /// The device has the faces turned.
  std::span<const float> ofGivenFaces() {
    const std::span<const float> rises = backend_.orientationOf().rises();
    rises_.assign(rises.begin(), rises.end());
    for (size_t f = 0; f < rises_.size(); ++f) rises_[f] = turns_[f] ? -rises_[f] : rises_[f];
    return rises_;
  }

  Backend& backend_;
  Turns turns_;
  std::vector<float> rises_;
};

/// Whether the rays disagree anywhere the host has to know before it goes on.
void Backend::orientation() {
  if (!mayTurnFaces(options(), 1.0)) return;
  doubtfulGiven_ = readDoubtfulShare("orientation");
  if (!mayTurnFaces(options(), *doubtfulGiven_)) return;
  FaceTurner turner(*this);
  const bool isHarmonic = options().sign == SignMode::Harmonic;
  const double misfit = isHarmonic ? turner.misfit() : turner.solve(Turns(extent().triangles, 0));
  if (!shouldLookAtFaces(options(), misfit, orientationOf().contradictsParity())) {
    faceSides_ = {.turns = {}, .misfitGiven = misfit, .misfit = misfit};
    return;
  }
  faceSides_ = chooseSides(*inputMesh_, misfit, options().orientation, turner, *progress_);
  if (!isHarmonic) winding();
}

}  // namespace raymap::vulkan
