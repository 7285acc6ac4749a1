// The ray map on the device: for each axis the suffix sums along all its lines, x fastest. Along the axis
// there is one more number than samples. Number e counts the crossings from the edge before sample e on,
// towards plus infinity.

// Returns r (Krayer & Müller 2019, §3.5, Eq. 7) of a sample, which may lie outside the grid along `axis`
// only.
int rayFrom(Ints rays, uint axis, ivec3 dims, ivec3 s) {
  const int n = dims[axis];
  if (s[axis] >= n) return 0;
  ivec3 size = dims;
  size[axis] += 1;
  s[axis] = max(s[axis] + 1, 0);
  return rays.at[(s.z * size.y + s.y) * size.x + s.x];
}

// Returns the crossings of the edge from a sample to the next one along an axis, or 0 if that lies beyond the
// grid.
int crossingsOfEdge(Ints rays, uint axis, ivec3 dims, ivec3 s) {
  ivec3 next = s;
  next[axis] += 1;
  return next[axis] < dims[axis] ? rayFrom(rays, axis, dims, s) - rayFrom(rays, axis, dims, next) : 0;
}
