#pragma once

#include "crossings.h"
#include "face_sides.h"
#include "winding.h"

namespace raymap {

/// How badly a field fits the crossings: the squares of what w(i) - w(i + 1) misses of w_l (Eq. 5), summed
/// over all lattice edges, over the sum of |w_l|. 0 where nothing is crossed.
double measureMisfit(const glm::ivec3& dims, const Crossings& crossings, const Buffer<float>& winding);

/// Whether any sample's sign contradicts the parity of all six of its rays, where the winding number is
/// farther from the threshold than the lattice's error.
bool contradictsParity(const RayMap& map, const Buffer<float>& winding, double threshold);

/// For every face how much a field rises along its normal, from a cell behind it to a cell before it, in the
/// mean over the face. With `farSides` the steps are as long as so many times the root of twice its area.
void measureRises(const CellMesh& mesh, const Buffer<float>& field, float farSides, Progress& progress,
                  Buffer<float>& rises);

/// The share of the six rays of each sample that cross an odd number of faces.
void averageParity(const RayMap& map, Buffer<float>& parity);

/// The stages from the crossings to the winding number, again for every choice of sides.
class FaceTurner final : public FaceField {
 public:
  /// What they work on. `mesh` gets its triangles from `turned`, which must live as long as it.
  struct Stages {
    CellMesh& mesh;
    Buffer<glm::uvec3>& turned;
    Crossings& crossings;
    RayMap& rayMap;
    Winding& winding;
    WindingSummary& summary;
    Buffer<float>& values;
  };

  FaceTurner(const Stages& stages, const Options& options, Progress& progress);

  double solve(const Turns& turns) override;
  std::span<const float> rises() override;
  std::span<const float> parityRises() override;
  /// Of the field that is there.
  double misfit() const;

 private:
  std::span<const float> measure(float farSides);

  Stages stages_;
  Options options_;
  Progress& progress_;
  std::span<const glm::uvec3> given_;
  Buffer<float> rises_;
};

}  // namespace raymap
