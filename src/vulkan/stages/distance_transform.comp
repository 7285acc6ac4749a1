// Krayer & Müller 2019, §3.3, Algorithms 1 and 2, along y or z, by divide and conquer.
#include "vulkan/device/kernel.glsl"
#include "method/cell_lattice_shared.h"
#include "vulkan/stages/distance_transform_push.h"

layout(constant_id = 1) const uint kAxis = 1;
layout(constant_id = 2) const uint kCells = 1;  // Maximum number of cells in a group's lines.
layout(constant_id = 3) const uint kMarks = 1;  // Maximum number of runs in a group's lines.
layout(push_constant, scalar) uniform Push { DistanceTransformPush push; };

const uint kCellsAtOnce = 4;       // Cells that an invocation loads at once.
const uint kNoValue = 0x7fffffff;  // Whole part of a cell without a value, more than any other.

// Value f(q) of a cell: its fraction's bits, then its whole part plus q^2. Lines are interleaved, as are marks.
shared uvec2 values[kCells];
// Best site of the sample before each run. Until one is known, candidates lie from its place on.
shared uint marks[kMarks];

// The line of an invocation.
struct Line {
  uint number;  // In the group.
  uint first;   // First cell in memory.
  uint stride;  // From a cell to the next one.
};

uint lineLength() {
  return kAxis == 1 ? push.dims.y : push.dims.z;
}
uint cellAt(Line line, uint p) {
  return line.first + p * line.stride;
}
// Returns the place in shared memory of a cell or run.
uint placeOf(Line line, uint p) {
  return p * push.lines + line.number;
}

uint fractionOf(float value) {
  precise const float fraction = value - floor(value);  // Exact.
  return floatBitsToUint(fraction);
}

// Returns the value of a cell before this pass: its own value plus the squared distances along the finished
// axes. Reads memory even if the cell has no value, so that the reads of several cells can overlap.
uvec2 valueBefore(uint cell, uint x, uint y, uint p) {
  const uint nearest = push.from.at[cell];
  const uint nearestX = nearest == kNoCell ? x : nearest & 0xffff;
  const float dx = float(int(x) - int(nearestX));
  float value;
  if (kAxis == 1) {
    value = dx * dx + push.values.at[cell - x + nearestX];
  } else {
    const uint nearestY = nearest == kNoCell ? y : nearest >> 16;
    const float dy = float(int(y) - int(nearestY));
    value = dy * dy + (dx * dx + push.values.at[(p * push.dims.y + nearestY) * push.dims.x + nearestX]);
  }
  return uvec2(fractionOf(value), p * p + (nearest == kNoCell ? kNoValue : uint(value)));
}

// Loads the cells row, row + rows, ...
void load(Line line, uint x, uint y, uint row, uint rows) {
  const uint length = lineLength();
  for (uint first = row; first < length; first += kCellsAtOnce * rows) {
    uvec2 loaded[kCellsAtOnce];
    [[unroll]] for (uint n = 0; n < kCellsAtOnce; ++n) {
      const uint p = min(first + n * rows, length - 1);
      loaded[n] = valueBefore(cellAt(line, p), x, y, p);
    }
    [[unroll]] for (uint n = 0; n < kCellsAtOnce; ++n) {
      const uint p = first + n * rows;
      if (p < length) values[placeOf(line, p)] = loaded[n];
    }
  }
}

// Returns (p - q)^2 + f(q) of the site q at a place, to compare with others: the whole part, then the fraction.
// `rise` is (p - q)^2 - q^2, modulo 2^32.
uint64_t heightAt(uint place, uint rise) {
  const uvec2 value = values[place];
  return packUint2x32(uvec2(value.x, value.y + rise));
}

// Returns the best of the sites from `first` to `last` for a sample p: that of the lowest parabola, and the first
// of equal ones.
uint bestOf(Line line, uint p, uint first, uint last) {
  if (first == last) return first;
  uint best = first, place = placeOf(line, first), rise = p * (p - 2 * first);
  const uint fall = 2 * p;
  uint64_t least = heightAt(place, rise);
  for (uint q = first + 1; q <= last; ++q) {
    place += push.lines;
    rise -= fall;
    const uint64_t height = heightAt(place, rise);
    if (height < least) {
      least = height;
      best = q;
    }
  }
  return best;
}

// Returns the sample before a run.
uint markOf(uint run) {
  return run * kRunCells - 1;
}
// Returns the best site of the sample before a run, or the last site of the line.
uint boundAt(Line line, uint run) {
  return run < push.runs ? marks[placeOf(line, run)] : lineLength() - 1;
}

// Finds the best one in one of `step` parts of the sites between the marks `step` runs before and after.
void searchPart(Line line, uint run, uint step, uint part) {
  const uint first = boundAt(line, run - step), last = boundAt(line, run + step);
  const uint width = (last - first + step) >> findLSB(step);
  const uint begin = min(first + part * width, last);
  marks[placeOf(line, run + part)] = bestOf(line, markOf(run), begin, min(begin + width - 1, last));
}

// Takes the best of the parts' candidates; the first ones have the lower sites.
void mergeParts(Line line, uint run, uint parts) {
  const uint p = markOf(run);
  uint best = marks[placeOf(line, run)];
  uint64_t least = heightAt(placeOf(line, best), p * (p - 2 * best));
  for (uint part = 1; part < parts; ++part) {
    const uint q = marks[placeOf(line, run + part)];
    const uint64_t height = heightAt(placeOf(line, q), p * (p - 2 * q));
    if (height < least) {
      least = height;
      best = q;
    }
  }
  marks[placeOf(line, run)] = best;
}

// Writes the nearest cell of sample p, whose best site is q: the word of the pass before, with q.
void store(Line line, uint p, uint q) {
  const uint nearest = push.from.at[cellAt(line, q)];
  const uint result =
      kAxis == 1 ? nearest | q << 16 : (q * push.dims.y + (nearest >> 16)) * push.dims.x + (nearest & 0xffff);
  if (p < lineLength()) push.to.at[cellAt(line, p)] = nearest == kNoCell ? kNoCell : result;
}

// Finds the best sites of a run's samples, and writes their nearest cells.
void finishRun(Line line, uint run) {
  const uint before = markOf(run);
  uint sites[kRunCells + 1];
  sites[0] = boundAt(line, run);
  sites[kRunCells] = boundAt(line, run + 1);
  if (run + 1 == push.runs)
    sites[kRunCells] = bestOf(line, markOf(run + 1), sites[0], sites[kRunCells]);
  [[unroll]] for (uint step = kRunCells / 2; step > 0; step /= 2)
    [[unroll]] for (uint n = step; n < kRunCells; n += 2 * step)
      sites[n] = bestOf(line, before + n, sites[n - step], sites[n + step]);
  [[unroll]] for (uint n = 1; n <= kRunCells; ++n) store(line, before + n, sites[n]);
}

void main() {
  const uint tilesInRow = ceilDiv(push.dims.x, push.lines), outer = groupIndex() / tilesInRow;
  if (outer >= (kAxis == 1 ? push.dims.z : push.dims.y)) return;
  const uint index = gl_LocalInvocationID.x, shift = findLSB(push.lines), plane = push.dims.x * push.dims.y;
  const uint row = index >> shift, rows = gl_WorkGroupSize.x >> shift, number = index & (push.lines - 1);
  const uint x = (groupIndex() - outer * tilesInRow) * push.lines + number;
  const Line line = Line(number, x + outer * (kAxis == 1 ? plane : push.dims.x), kAxis == 1 ? push.dims.x : plane);
  const bool works = x < push.dims.x;
  if (works) load(line, x, outer, row, rows);
  if (row == 0) marks[number] = 0;
  for (uint step = push.runs == 1 ? 0 : 1u << findMSB(push.runs - 1); step > 0; step /= 2) {
    const uint part = row & (step - 1), run = 2 * (row - part) + step;
    const bool searches = works && run < push.runs;
    barrier();
    if (searches) searchPart(line, run, step, part);
    if (step == 1) break;
    barrier();
    if (searches && part == 0) mergeParts(line, run, step);
  }
  barrier();
  for (uint run = row; works && run < push.runs; run += rows) finishRun(line, run);
}
