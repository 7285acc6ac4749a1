// The samples of a small block, and the closest triangle of each so far.

const uint kSamples = kSmallSide * kSmallSide * kSmallSide;

shared float sampleSquared[kMaxSubgroups * kSamples];
shared uint sampleTriangle[kMaxSubgroups * kSamples];

uint ofSample(uint sampleIndex) {
  return gl_SubgroupID * kSamples + sampleIndex;
}

uvec3 samplePlace(Block block, uint sampleIndex) {
  return block.low + placeOf(sampleIndex, uvec3(kSmallSide));
}

uint gridIndex(uvec3 place) {
  return (place.z * push.dimY + place.y) * push.dimX + place.x;
}

void writeSample(uvec3 place, float distance, uint triangle) {
  const bool isBeyond = triangle == kNoTriangle || push.band > 0 && distance > push.band;
  const uint index = gridIndex(place);
  push.distance.at[index] = !isBeyond ? distance : push.band > 0 ? push.band : kInfinity;
  if (uint64_t(push.triangle) != 0)
    push.triangle.at[index] = isBeyond ? kNoTriangle : readTriangleId(push.frames, triangle);
}
