// Declarations shared by the kernels of the orientation.

#include "vulkan/stages/orientation_push.h"
#include "vulkan/stages/ray_map.glsl"

layout(push_constant, scalar) uniform Push {
  OrientationPush push;
};

ivec3 gridDims() {
  return ivec3(push.dims);
}

// Returns how many of the two rays along an axis cross an odd number of faces. A sum of +1 and -1 has the same parity
// as the number of terms.
int countOddRays(Ints rays, uint axis, ivec3 s) {
  ivec3 beforeAll = s;
  beforeAll[axis] = -1;
  const int ray = rayFrom(rays, axis, gridDims(), s);
  return (ray & 1) + ((ray - rayFrom(rays, axis, gridDims(), beforeAll)) & 1);
}

// Returns how many of a sample's six rays cross an odd number of faces.
int countOddRays(ivec3 s) {
  return countOddRays(push.rays[0], 0, s) + countOddRays(push.rays[1], 1, s) + countOddRays(push.rays[2], 2, s);
}
