// Computes the moments of a level's nodes from their triangles or from the nodes of the level below.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_dipoles.glsl"

void add(inout Moments sum, vec3 area, vec3 offset) {
  sum.area += area;
  sum.squares += area * offset;
  sum.products += 0.5 * (area * offset.yzx + area.yzx * offset);
}

void main() {
  const uint place = invocationIndex();
  if (place >= push.levelCount) return;
  const uint node = push.levelStart + place;
  const vec3 centre = readDisc(push.discs, node).centre;
  Moments sum = Moments(vec3(0), vec3(0), vec3(0));
  for (uint i = 0; i < kTreeArity; ++i)
    if (push.levelStart == push.firstLeaf) {
      if (place * kTreeArity + i >= push.triangleCount) break;
      const Triangle t = readTriangle(push.frames, place * kTreeArity + i);
      add(sum, 0.5 * t.bx * t.cy * t.z, t.a + (t.bx + t.cx) / 3.0 * t.x + t.cy / 3.0 * t.y - centre);
    } else {
      const uint child = node * kTreeArity + 1 + i;
      const Disc disc = readDisc(push.discs, child);
      if (disc.radius < 0) break;  // Fills up the level.
      const Moments m = readMoments(child);
      add(sum, m.area, disc.centre - centre);
      sum.squares += m.squares;
      sum.products += m.products;
    }
  writeMoments(node, sum);
}
