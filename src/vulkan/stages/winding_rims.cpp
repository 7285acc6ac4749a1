// Martens, Trettner & Bessmeltsev 2026, "The Antipodal Method", where Krayer & Müller 2019, §3.5, average
// curves.

#include "vulkan/stages/winding_rims.h"

#include <algorithm>
#include <span>

#include "method/cell_lattice.h"
#include "shaders/winding_harmonic_prolong_spv.h"
#include "shaders/winding_rims_spv.h"

namespace raymap::vulkan {

namespace {

static_assert(sizeof(RimLine) == 6 * sizeof(float));

uint64_t rimSamples(const glm::ivec3& dims, size_t level) {
  return CellLattice{rimDims(dims, static_cast<uint32_t>(level))}.count();
}

uint32_t groupOf(const Device& device) {
  return std::max(kGroup, device.limits().maxSubgroupSize);
}

}  // namespace

WindingRimsStage::WindingRimsStage(Device& device, ScratchMemory* scratch)
    : device_(&device),
      scratch_(scratch),
      upload_(device, "rims for the device", MemoryUse::Upload),
      lists_(device, "rims and samples near them"),
      prolong_(device, shaders::kWindingHarmonicProlong, kGroup, {0, 1}),
      listed_(device, shaders::kWindingRims, groupOf(device), {1}),
      settle_(device, shaders::kWindingRims, groupOf(device), {0}),
      lanes_(device.limits().maxSubgroupSize) {}

void WindingRimsStage::reserve(const glm::ivec3& dims) {
  dims_ = dims;
  const auto coarser = static_cast<size_t>(coarsestRimLevel(dims));
  while (values_.size() > coarser) values_.pop_back();
  while (values_.size() < coarser) values_.emplace_back(*device_, "winding values between rims", scratch_);
  for (size_t l = 1; l <= coarser; ++l) values_[l - 1].resize<float>(rimSamples(dims, l));
}

void WindingRimsStage::upload(Commands& commands, const RimLattices& lattices) {
  rimCount_ = static_cast<uint32_t>(lattices.rims.size());
  source_ = lattices.source();
  centre_ = lattices.centre;
  uint64_t bytes = rimCount_ * sizeof(RimLine);
  for (const std::vector<uint32_t>& places : lattices.computed) bytes += places.size() * sizeof(uint32_t);
  upload_.resize<std::byte>(bytes);
  lists_.resize<std::byte>(bytes);
  std::byte* to = upload_.mapped<std::byte>().data();
  const auto append = [&](const auto& values) {
    to = std::ranges::copy(std::as_bytes(std::span(values)), to).out;
  };
  append(lattices.rims);
  for (const std::vector<uint32_t>& places : lattices.computed) append(places);
  commands.copy(upload_, lists_, bytes);
}

WindingRimsPush WindingRimsStage::push(const LatticeLines& rays, VkDeviceAddress values) const {
  return {.rays = {rays.axes[0], rays.axes[1], rays.axes[2]},
          .values = values,
          .rims = lists_.address(),
          .dims = glm::uvec3(dims_),
          .rimCount = rimCount_,
          .centre = centre_};
}

void WindingRimsStage::record(Commands& commands, const LatticeLines& rays, const RimLattices& lattices,
                              VkDeviceAddress winding) {
  if (lattices.rims.empty()) return;
  upload(commands, lattices);
  double visited = 0.0, all = 0.0;
  for (size_t l = 0; l < lattices.computed.size(); ++l)
    all += double(lattices.computed[l].size()) + double(rimSamples(dims_, l));
  VkDeviceAddress listEnd = lists_.address() + lists_.bytes();
  const auto valuesOf = [&](size_t l) { return l == 0 ? winding : values_[l - 1].address(); };
  for (size_t l = lattices.computed.size(); l-- > 0;) {
    WindingRimsPush compute = push(rays, valuesOf(l));
    compute.level = static_cast<uint32_t>(l);
    compute.count = static_cast<uint32_t>(lattices.computed[l].size());
    listEnd -= compute.count * sizeof(uint32_t);
    compute.computed = listEnd;
    if (l + 1 < lattices.computed.size()) {
      const WindingHarmonicPush prolong{.rays = {rays.axes[0], rays.axes[1], rays.axes[2]},
                                        .values = valuesOf(l),
                                        .coarse = valuesOf(l + 1),
                                        .dims = compute.dims,
                                        .level = compute.level};
      commands.dispatch(prolong_, prolong, rimSamples(dims_, l));
    }
    commands.dispatch(listed_, compute, uint64_t{compute.count} * lanes_);
    visited += double(compute.count) + double(rimSamples(dims_, l));
    constexpr double kRays = 0.2;  // The rays before it are taken as a fifth of the stage, as on the CPU.
    commands.report(kRays + (1.0 - kRays) * visited / all);
  }
}

void WindingRimsStage::recordSettling(Commands& commands, const LatticeLines& rays, VkDeviceAddress distance,
                                      VkDeviceAddress change, double threshold, VkDeviceAddress winding) {
  WindingRimsPush settle = push(rays, winding);
  settle.count = static_cast<uint32_t>(rimSamples(dims_, 0));
  settle.distance = distance;
  settle.source = source_;
  settle.change = change;
  settle.threshold = static_cast<float>(threshold);
  // A subgroup may have to settle all its samples, each by all rims along six rays.
  constexpr uint32_t kLightRims = 128, kMostWeight = 64;
  commands.dispatch(settle_, settle, settle.count, std::clamp(rimCount_ / kLightRims, 1U, kMostWeight));
}

}  // namespace raymap::vulkan
