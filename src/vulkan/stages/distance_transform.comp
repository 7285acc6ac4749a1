// Krayer & Müller 2019, §3.3, Algorithms 1 and 2, along y or z.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "method/cell_lattice_shared.h"
#include "vulkan/stages/distance_transform_push.h"

layout(constant_id = 1) const uint kAxis = 1;
layout(constant_id = 2) const uint kCells = 1;     // Maximum number of cells in a group's lines.
layout(constant_id = 3) const uint kSegments = 1;  // Maximum number of segments in a group's lines.
layout(push_constant, scalar) uniform Push { DistanceTransformPush push; };

const uint kCellsAtOnce = 4;  // Cells that an invocation loads or stores at once.

// Each segment stores its sites in its first places: the site's value, its place q in the line, and the first
// p from which on it is the lowest so far. In the end, the value's place holds the site of each p.
shared uint values[kCells];
shared uint sites[kCells];        // q | first p << 16.
shared uint segments[kSegments];  // Sites left: begin | end << 16. In the end: the last site.

// The group's lines in memory.
struct Tile {
  uint base;    // First cell of the first line.
  uint stride;  // From a cell to the next one of its line.
  uint lines;   // Number of lines, adjacent in x.
};

uint lineLength() {
  return kAxis == 1 ? push.ny : push.nz;
}

uint groupCount() {
  return ceilDiv(push.nx, push.lines) * (kAxis == 1 ? push.nz : push.ny);
}

Tile tileOf(uint group) {
  const uint tilesInRow = ceilDiv(push.nx, push.lines);
  const uint x = group % tilesInRow * push.lines, outer = group / tilesInRow;
  const uint plane = push.nx * push.ny;
  return Tile(outer * (kAxis == 1 ? plane : push.nx) + x, kAxis == 1 ? push.nx : plane,
              min(push.lines, push.nx - x));
}

// Returns the place in shared memory.
uint placeOf(uint line, uint p) {
  return p * push.lines + line;
}

float valueAt(uint line, uint slot) {
  return uintBitsToFloat(values[placeOf(line, slot)]);
}
uint siteAt(uint line, uint slot) {
  return sites[placeOf(line, slot)] & 0xffff;
}
int firstAt(uint line, uint slot) {
  return int(sites[placeOf(line, slot)] >> 16);
}
void writeSlot(uint line, uint slot, float value, uint q, int first) {
  values[placeOf(line, slot)] = floatBitsToUint(value);
  sites[placeOf(line, slot)] = q | uint(first) << 16;
}

// Returns, in exact arithmetic, whether the parabola of site a is at most as high as that of b > a at p.
bool isNoHigher(int a, float valueA, int b, float valueB, int p) {
  const int64_t asked = int64_t(b - a) * int64_t(2 * p - a - b);
  const float wholeA = floor(valueA), wholeB = floor(valueB);
  const int64_t left = int64_t(wholeB) - int64_t(wholeA) - asked;
  if (left != 0) return left > 0;
  precise const float partA = valueA - wholeA, partB = valueB - wholeB;  // Both exact.
  return partB >= partA;
}

// Returns the last p, at least -1, at which the parabola of site a is at most as high as that of b > a.
int lastOf(uint siteA, float valueA, uint siteB, float valueB) {
  const float kBorderMargin = 1.0 / 64.0;  // More than rounding moves a border.
  const int a = int(siteA), b = int(siteB), n = int(lineLength());
  const float border = 0.5 * ((valueB - valueA) / float(b - a) + float(a + b));
  const float clamped = clamp(border, -0.5, float(n)) + kBorderMargin;
  const int p = int(clamped + 1.0) - 1;
  return clamped - float(p) > 2.0 * kBorderMargin || isNoHigher(a, valueA, b, valueB, p) ? p : p - 1;
}

// Algorithm 2, lines 28-44, within one segment of a line.
void buildEnvelope(uint line, uint segment) {
  const uint begin = segment * kSegmentCells, end = min(begin + kSegmentCells, lineLength());
  uint top = begin;  // After the last site kept.
  for (uint q = begin; q < end; ++q) {
    const float value = valueAt(line, q);
    if (value >= push.empty) continue;
    int first = 0;
    while (top > begin) {
      first = lastOf(siteAt(line, top - 1), valueAt(line, top - 1), q, value) + 1;
      if (first > firstAt(line, top - 1)) break;
      --top;
      first = 0;
    }
    if (first < int(lineLength())) writeSlot(line, top++, value, q, first);
  }
  segments[line * push.segments + segment] = begin | top << 16;
}

uint beginOf(uint line, uint segment) {
  return segments[line * push.segments + segment] & 0xffff;
}
uint endOf(uint line, uint segment) {
  return segments[line * push.segments + segment] >> 16;
}

// Returns the last slot of the segments [first, end), or -1.
int lastSlot(uint line, uint first, uint end) {
  while (end > first) {
    --end;
    if (beginOf(line, end) < endOf(line, end)) return int(endOf(line, end)) - 1;
  }
  return -1;
}
int firstSlot(uint line, uint first, uint end) {
  for (; first < end; ++first)
    if (beginOf(line, first) < endOf(line, first)) return int(beginOf(line, first));
  return -1;
}
int nextSlot(uint line, uint slot, uint end) {
  const uint segment = slot / kSegmentCells;
  return slot + 1 < endOf(line, segment) ? int(slot) + 1 : firstSlot(line, segment + 1, end);
}

void dropLast(uint line, uint slot) {
  const uint segment = slot / kSegmentCells;
  segments[line * push.segments + segment] = beginOf(line, segment) | slot << 16;
}
void dropFirst(uint line, uint slot) {
  const uint segment = slot / kSegmentCells;
  segments[line * push.segments + segment] = (slot + 1) | endOf(line, segment) << 16;
}

// Merges the envelopes of the segments [first, middle) and [middle, end). All sites of the first envelope lie
// before those of the second, so its beginning stays, and the end of the second.
void mergeEnvelopes(uint line, uint first, uint middle, uint end) {
  int i = lastSlot(line, first, middle), j = firstSlot(line, middle, end);
  int from = 0;
  while (i >= 0 && j >= 0) {
    from = lastOf(siteAt(line, i), valueAt(line, i), siteAt(line, j), valueAt(line, j)) + 1;
    if (from <= firstAt(line, i)) {
      dropLast(line, i);
      i = lastSlot(line, first, i / kSegmentCells + 1);
      from = 0;
      continue;
    }
    const int next = nextSlot(line, j, end);
    if (from < (next < 0 ? int(lineLength()) : firstAt(line, next))) break;
    dropFirst(line, j);
    j = next;
  }
  if (j >= 0) sites[placeOf(line, j)] = siteAt(line, j) | uint(from) << 16;
}

// Returns the value of a cell before this pass: its own value plus the squared distances along the finished
// axes. Reads memory even if the cell has no value, so that the reads of several cells can overlap.
float valueBefore(uint cell, uint x, uint y, uint p) {
  const uint nearest = push.from.at[cell];
  const uint nearestX = nearest == kNoCell ? x : nearest & 0xffff;
  const float dx = float(int(x) - int(nearestX));
  float value;
  if (kAxis == 1) {
    value = dx * dx + push.values.at[cell - x + nearestX];
  } else {
    const uint nearestY = nearest == kNoCell ? y : nearest >> 16;
    const float dy = float(int(y) - int(nearestY));
    value = dy * dy + (dx * dx + push.values.at[(p * push.ny + nearestY) * push.nx + nearestX]);
  }
  return nearest == kNoCell ? push.empty : value;
}

// Returns the word to write for the nearest cell at q, which the pass before found in `cell`.
uint resultOf(uint cell, uint q) {
  const uint nearest = push.from.at[cell];
  if (kAxis == 1) return nearest | q << 16;
  return (q * push.ny + (nearest >> 16)) * push.nx + (nearest & 0xffff);
}

uint cellOf(Tile tile, uint line, uint p) {
  return tile.base + p * tile.stride + line;
}

// Returns line and p of a place in shared memory.
uvec2 lineAt(uint place) {
  return uvec2(place & (push.lines - 1), place >> findLSB(push.lines));
}

uint placeCount() {
  return lineLength() * push.lines;
}

// Returns the n-th place that an invocation loads and stores, from `first` on.
uint placeAfter(uint first, uint n) {
  return first + n * gl_WorkGroupSize.x;
}

void load(Tile tile) {
  const uint count = placeCount(), x = tile.base % push.nx, y = tile.base / push.nx;
  for (uint first = gl_LocalInvocationID.x; first < count; first += kCellsAtOnce * gl_WorkGroupSize.x) {
    float loaded[kCellsAtOnce];
    [[unroll]] for (uint n = 0; n < kCellsAtOnce; ++n) {
      uvec2 at = lineAt(min(placeAfter(first, n), count - 1));
      at.x = min(at.x, tile.lines - 1);
      loaded[n] = valueBefore(cellOf(tile, at.x, at.y), x + at.x, y, at.y);
    }
    [[unroll]] for (uint n = 0; n < kCellsAtOnce; ++n)
      if (placeAfter(first, n) < count) values[placeAfter(first, n)] = floatBitsToUint(loaded[n]);
  }
}

void store(Tile tile) {
  const uint count = placeCount();
  for (uint first = gl_LocalInvocationID.x; first < count; first += kCellsAtOnce * gl_WorkGroupSize.x) {
    uint results[kCellsAtOnce];
    [[unroll]] for (uint n = 0; n < kCellsAtOnce; ++n) {
      uvec2 at = lineAt(min(placeAfter(first, n), count - 1));
      at.x = min(at.x, tile.lines - 1);
      const uint q = values[placeOf(at.x, at.y)];
      const uint nearest = resultOf(cellOf(tile, at.x, q == kNoCell ? at.y : q), q);
      results[n] = q == kNoCell ? kNoCell : nearest;
    }
    [[unroll]] for (uint n = 0; n < kCellsAtOnce; ++n) {
      const uvec2 at = lineAt(placeAfter(first, n));
      if (placeAfter(first, n) < count && at.x < tile.lines) push.to.at[cellOf(tile, at.x, at.y)] = results[n];
    }
  }
}

// Lines 45-54, step 1: writes each remaining site to the p at which it starts to be the lowest.
void markFirsts(uint line, uint segment) {
  const uint end = endOf(line, segment);
  for (uint slot = beginOf(line, segment); slot < end; ++slot) {
    const int first = firstAt(line, slot), next = nextSlot(line, slot, push.segments);
    if (first < (next < 0 ? int(lineLength()) : firstAt(line, next)))
      values[placeOf(line, first)] = siteAt(line, slot);
  }
}

// Step 2: carries the sites through the segment.
void carryWithin(uint line, uint begin, uint end, uint segment) {
  uint site = kNoCell;
  for (uint p = begin; p < end; ++p) {
    const uint place = placeOf(line, p);
    if (values[place] == kNoCell) values[place] = site;
    site = values[place];
  }
  segments[line * push.segments + segment] = site;
}

// Step 3: carries the last site into the next segment, up to the first site there.
void carryAcross(uint line, uint begin, uint end, uint segment) {
  uint site = kNoCell;
  while (segment > 0 && site == kNoCell) site = segments[line * push.segments + --segment];
  for (uint p = begin; p < end && values[placeOf(line, p)] == kNoCell; ++p) values[placeOf(line, p)] = site;
}

void main() {
  if (groupIndex() >= groupCount()) return;
  const Tile tile = tileOf(groupIndex());
  load(tile);
  const uint index = gl_LocalInvocationID.x;
  const uint line = index % push.lines, segment = index / push.lines;
  const bool works = line < tile.lines && segment < push.segments;
  const uint begin = segment * kSegmentCells, end = min(begin + kSegmentCells, lineLength());
  barrier();
  if (works) buildEnvelope(line, segment);
  for (uint width = 1; width < push.segments; width *= 2) {
    barrier();
    const uint first = 2 * width * segment;
    if (line < tile.lines && first + width < push.segments)
      mergeEnvelopes(line, first, first + width, min(first + 2 * width, push.segments));
  }
  barrier();
  if (works)
    for (uint p = begin; p < end; ++p) values[placeOf(line, p)] = kNoCell;
  barrier();
  if (works) markFirsts(line, segment);
  barrier();
  if (works) carryWithin(line, begin, end, segment);
  barrier();
  if (works) carryAcross(line, begin, end, segment);
  barrier();
  store(tile);
}
