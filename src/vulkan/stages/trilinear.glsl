// Numbers between the samples of a grid, each axis of which may have one sample only.

float alongX(Floats samples, uint at, ivec3 dims, vec3 share) {
  const float low = samples.at[at];
  return low + share.x * (samples.at[at + uint(dims.x > 1)] - low);
}

float alongXY(Floats samples, uint at, ivec3 dims, vec3 share) {
  const float low = alongX(samples, at, dims, share);
  return low + share.y * (alongX(samples, at + (dims.y > 1 ? dims.x : 0), dims, share) - low);
}

// `q` lies within the grid.
float between(Floats samples, ivec3 dims, vec3 q) {
  const ivec3 cell = min(ivec3(q), max(dims - 2, 0));
  const vec3 share = q - vec3(cell);
  const uint at = indexOf(uvec3(cell), uvec3(dims));
  const float low = alongXY(samples, at, dims, share);
  return low + share.z * (alongXY(samples, at + (dims.z > 1 ? dims.x * dims.y : 0), dims, share) - low);
}
