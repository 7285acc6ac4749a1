// GPU twin of picture/drawn_field.h for narrow bands. The shader that includes it has `push.shape`, the numbers of samples,
// `push.scale`, and `push.picture`, which holds the address of the index.

#include "picture/drawn_field_shared.h"

struct LeafSlot {
  int content;
  int bits;  // The slot's cube has 2^bits samples along its side.
};

// Samples from `low` to `high` that have one value.
struct Plateau {
  bool isThere;
  float value;
  ivec3 low, high;
};

int placeOf(ivec3 at, int bits) {
  const ivec3 slot = (at >> bits) & ((1 << kLeafBits) - 1);
  return (((slot.z << kLeafBits) + slot.y) << kLeafBits) + slot.x;
}

LeafSlot slotOf(Uints index, ivec3 at) {
  int content = 0;
  for (int bits = min(int(index.at[kIndexRootBits]), kMostRootBits);; bits -= kLeafBits) {
    content = int(index.at[kLeafIndexHeader + (content << 3 * kLeafBits) + placeOf(at, bits)]);
    if (content < 0 || bits <= kLeafBits) return LeafSlot(content, bits);
  }
}

float distanceElsewhere(Uints index, int content) {
  return uintBitsToFloat(index.at[content == kAllInside ? kIndexInside : kIndexOutside]);
}

// Interpolates the leaves' numbers as `between` does those of a dense field. `isKnown`: whether all samples around the point
// lie in leaves; others have the distance outside or inside.
float betweenLeaves(Floats leaves, vec3 q, out bool isKnown) {
  Uints index = push.picture.at[0].leafIndex;
  const ivec3 dims = ivec3(push.shape.nx, push.shape.ny, push.shape.nz);
  const ivec3 cell = min(ivec3(q), max(dims - 2, 0)), next = min(cell + 1, dims - 1);
  const vec3 share = q - vec3(cell);
  const LeafSlot first = slotOf(index, cell);
  const bool isOneSlot = cell >> first.bits == next >> first.bits;
  isKnown = first.content >= 0;
  if (isOneSlot && !isKnown) return distanceElsewhere(index, first.content);
  float corners[8];
  [[unroll]] for (int corner = 0; corner < 8; ++corner) {
    const ivec3 at = ivec3((corner & 1) != 0 ? next.x : cell.x, (corner & 2) != 0 ? next.y : cell.y,
                           (corner & 4) != 0 ? next.z : cell.z);
    const int leaf = isOneSlot ? first.content : slotOf(index, at).content;
    isKnown = isKnown && leaf >= 0;
    corners[corner] = leaf < 0 ? distanceElsewhere(index, leaf) : leaves.at[(leaf << 3 * kLeafBits) + placeOf(at, 0)];
  }
  float rows[4], sheets[2];
  [[unroll]] for (int i = 0; i < 4; ++i) rows[i] = corners[2 * i] + share.x * (corners[2 * i + 1] - corners[2 * i]);
  [[unroll]] for (int i = 0; i < 2; ++i) sheets[i] = rows[2 * i] + share.y * (rows[2 * i + 1] - rows[2 * i]);
  return sheets[0] + share.z * (sheets[1] - sheets[0]);
}

// Returns the samples around one on the lattice that lie in no leaf, of those that the index knows.
Plateau plateauAround(Uints index, ivec3 at) {
  const int cubeBits = int(index.at[kIndexCubeBits]);
  const ivec3 cube = at >> cubeBits;
  const int number = (cube.z * int(index.at[kIndexCubeDims + 1]) + cube.y) * int(index.at[kIndexCubeDims]) + cube.x;
  const int away = int(index.at[int(index.at[kIndexCubes]) + (number >> 2)] >> 8 * (number & 3)) & 0xff;
  if (away > 0)
    return Plateau(true, distanceElsewhere(index, kAllOutside), (cube + 1 - away) << cubeBits, ((cube + away) << cubeBits) - 1);
  const LeafSlot slot = slotOf(index, at);
  const ivec3 low = (at >> slot.bits) << slot.bits;
  return Plateau(slot.content < 0, distanceElsewhere(index, slot.content), low, low + ((1 << slot.bits) - 1));
}

// Returns how far a ray goes on from a point in samples of one value, or 0. Beyond the last of them, others are used too.
float emptyLength(vec3 p, vec3 direction, out float value) {
  const vec3 last = vec3(push.shape.nx, push.shape.ny, push.shape.nz) - 1;
  value = 0;
  if (any(lessThan(p, vec3(0))) || any(greaterThan(p, last))) return 0;
  const Plateau plateau = plateauAround(push.picture.at[0].leafIndex, ivec3(p));
  const vec3 low = vec3(plateau.low), high = vec3(plateau.high);
  if (!plateau.isThere || any(greaterThan(p, high))) return 0;
  value = push.scale * plateau.value;
  float length = kFarthestRay;
  [[unroll]] for (int axis = 0; axis < 3; ++axis) {
    const float way = direction[axis];
    if (way != 0) length = min(length, ((way > 0 ? high[axis] : low[axis]) - p[axis]) / way);
  }
  return length;
}
