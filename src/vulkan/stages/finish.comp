// Clamps the distances to the band and converts them to the mesh's units.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/finish_push.h"

layout(push_constant, scalar) uniform Push { FinishPush push; };

void main() {
  const uint i = invocationIndex();
  if (i >= push.count) return;
  push.distance.at[i] = clamp(push.distance.at[i], -push.band, push.band) * push.scale;
}
