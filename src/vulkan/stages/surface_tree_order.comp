// Reorders each run of the curve so that every aligned power of two of triangles, down to leaves, is compact:
// halves the run across its longest side, then the halves, and so on.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/stages/surface_tree_places.glsl"

layout(constant_id = 1) const uint kRun = 2;  // Two triangles for each invocation of a group.

shared uint triangles[kRun];  // In the order of the curve.
shared uvec3 places[kRun];
shared uint keys[kRun];  // Place along one axis, then the index in the run.
shared uint lows[3 * kRun / kTreeArity / 2];
shared uint highs[3 * kRun / kTreeArity / 2];

const uint kPad = 0xffffffffu;  // Beyond the last triangle: sorts after all others.

// Compares each pair in a step of a bitonic sort, in parts of `part` keys.
void sortStep(uint part, uint size, uint stride) {
  const uint l = gl_LocalInvocationID.x, first = (l & ~(stride - 1)) << 1 | l & (stride - 1), second = first | stride;
  const uint a = keys[first], b = keys[second];
  const bool isUp = (first & size & (part - 1)) == 0;
  keys[first] = isUp ? min(a, b) : max(a, b);
  keys[second] = isUp ? max(a, b) : min(a, b);
  barrier();
}

// Returns the axis along which a part extends farthest.
uint longestAxis(uint part) {
  const uvec3 extent = uvec3(highs[3 * part], highs[3 * part + 1], highs[3 * part + 2]) -
                       uvec3(lows[3 * part], lows[3 * part + 1], lows[3 * part + 2]);
  return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

void measureParts(uint part) {
  for (uint i = gl_LocalInvocationID.x; i < 3 * kRun / part; i += gl_WorkGroupSize.x) {
    lows[i] = kPad;
    highs[i] = 0;
  }
  barrier();
  for (uint i = gl_LocalInvocationID.x; i < kRun; i += gl_WorkGroupSize.x) {
    if (keys[i] == kPad) continue;
    const uvec3 place = places[keys[i] % kRun];
    [[unroll]] for (uint axis = 0; axis < 3; ++axis) {
      atomicMin(lows[i / part * 3 + axis], place[axis]);
      atomicMax(highs[i / part * 3 + axis], place[axis]);
    }
  }
  barrier();
}

void main() {
  const uint start = groupIndex() * kRun, count = push.triangleCount - min(start, push.triangleCount);
  for (uint i = gl_LocalInvocationID.x; i < kRun; i += gl_WorkGroupSize.x) {
    keys[i] = i < count ? i : kPad;
    if (i >= count) continue;
    triangles[i] = push.order.at[start + i];
    places[i] = placeOf(triangles[i]);
  }
  for (uint part = kRun; part > kTreeArity; part /= 2) {
    barrier();
    measureParts(part);
    for (uint i = gl_LocalInvocationID.x; i < kRun; i += gl_WorkGroupSize.x)
      if (keys[i] != kPad) keys[i] = places[keys[i] % kRun][longestAxis(i / part)] << kPlaceBits | keys[i] % kRun;
    barrier();
    for (uint size = 2; size <= part; size *= 2)
      for (uint stride = size / 2; stride > 0; stride /= 2) sortStep(part, size, stride);
  }
  for (uint i = gl_LocalInvocationID.x; i < min(count, kRun); i += gl_WorkGroupSize.x)
    push.order.at[start + i] = triangles[keys[i] % kRun];
}
