// Samples of a block, and the closest triangle of each so far.

// Bits of nonnegative floats, which keep the floats' order.
shared uint sampleSquared[kMaxSubgroups * kBlockSamples];
shared uint sampleTriangle[kMaxSubgroups * kBlockSamples];

Closest readSample(uint s) {
  const uint at = gl_SubgroupID * kBlockSamples + s;
  return Closest(uintBitsToFloat(sampleSquared[at]), sampleTriangle[at]);
}

void keepSample(uint s, Closest closest) {
  const uint at = gl_SubgroupID * kBlockSamples + s;
  sampleSquared[at] = floatBitsToUint(closest.squared);
  sampleTriangle[at] = closest.triangle;
}

// Keeps the closest of the triangles that several lanes found for a sample; among equals, the lowest index. One of
// these lanes is the first.
void takeClosestOfLanes(uint s, bool isFirst, Closest before, Closest closest) {
  const uint at = gl_SubgroupID * kBlockSamples + s, squared = floatBitsToUint(closest.squared);
  atomicMin(sampleSquared[at], squared);
  shareWithSubgroup();
  const uint least = sampleSquared[at];
  const bool isNew = least < floatBitsToUint(before.squared);
  if (isNew && isFirst) sampleTriangle[at] = kNoneClosest;
  shareWithSubgroup();
  if (isNew && squared == least) atomicMin(sampleTriangle[at], closest.triangle);
  shareWithSubgroup();
}

uvec3 samplePlace(Block block, uint s) {
  return block.low + (uvec3(s, s >> 2, s >> 4) & 3);
}

void writeSample(uvec3 place, Closest closest) {
  const float distance = sqrt(closest.squared);
  const bool isBeyond = closest.triangle == kNoneClosest || push.band > 0 && distance > push.band;
  const uint index = indexOf(place, push.dims);
  const bool isAddition = push.isAddition != 0;
  if (isAddition && (isBeyond || distance >= push.distance.at[index])) return;
  push.distance.at[index] = isBeyond ? push.band : distance;
  if (uint64_t(push.triangle) != 0)
    push.triangle.at[index] =
        isBeyond || isAddition ? kNoneClosest : readTriangleId(push.frames, closest.triangle);
}
