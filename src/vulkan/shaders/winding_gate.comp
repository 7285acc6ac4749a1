// Where all rays agree nothing is solved: dispatches get no groups.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "shared/winding_harmonic.h"

layout(push_constant, scalar) uniform Push { WindingGatePush push; };

void main() {
  const uint i = invocationIndex();
  if (i < push.count) push.actual.at[i] = push.doubtful.at[0] == 0 ? 0 : push.planned.at[i];
}
