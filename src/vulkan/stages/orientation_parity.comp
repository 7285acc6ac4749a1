// Computes the share of each sample's six rays that cross an odd number of faces.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/orientation.glsl"
#include "vulkan/stages/sixth.glsl"

void main() {
  const uint index = invocationIndex();
  if (index >= countOf(push.dims)) return;
  push.field.at[index] = sixth(countOddRays(ivec3(placeOf(index, push.dims))));
}
