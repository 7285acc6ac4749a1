// Krayer & Müller 2019, §3.5: from the ray map to the winding number.

#include "vulkan/stages/winding.h"

namespace raymap::vulkan {

WindingStage::WindingStage(Device& device, ScratchMemory* scratch)
    : rays_(device), paths_(device, scratch), harmonic_(device, scratch) {}

void WindingStage::reserve(const glm::ivec3& dims, SignMode mode, bool isSolvedToo) {
  if (mode == SignMode::Paths || mode == SignMode::Evolution) paths_.reserve(dims);
  if (mode == SignMode::Harmonic || isSolvedToo) harmonic_.reserve(dims);
}

void WindingStage::recordRays(Commands& commands, const LatticeLines& rays, SignMode mode,
                              VkDeviceAddress winding) {
  rays_.record(commands, rays, mode, winding);
}

void WindingStage::record(Commands& commands, const LatticeLines& rays, SignMode mode,
                          const FieldOptions& options, VkDeviceAddress winding) {
  const WindingFields fields{.rays = rays.axes, .winding = winding, .doubtful = doubtful().address()};
  if (mode == SignMode::Harmonic) harmonic_.record(commands, fields);
  if (mode == SignMode::Paths) paths_.recordAverage(commands, fields, options);
  if (mode == SignMode::Evolution) paths_.recordEvolution(commands, fields, options);
}

}  // namespace raymap::vulkan
