// Krayer & Müller 2019, §3.1, Fig. 2: pairs of a cell and a triangle that touches it. All invocations of a subgroup call
// these functions together.

#include "vulkan/stages/cell_runs.glsl"

// Consecutive cells along x that a triangle touches; possibly none.
struct CellRun {
  uint triangle;
  uint firstCell;
  uint size;
};

const CellRun kNoRun = CellRun(0, 0, 0);
const uint kShortRun = 4;  // Cells of a run that one invocation lists, at most.

CellRun runOf(Row row, ivec2 run) {
  const uint first = indexOf(uvec3(row.local.base + ivec3(run.x, row.j, row.k)), push.lattice.dims);
  return CellRun(row.triangle, first, uint(max(run.y - run.x + 1, 0)));
}

// Adds to a 64-bit total. Returns the lower half of the sum before this invocation's value.
uint addToTotal(uint at, uint value) {
  const uint before = subgroupExclusiveAdd(value), sum = subgroupAdd(value);
  uint first = 0;
  if (sum > 0 && subgroupElect()) {
    first = atomicAdd(push.totals.at[at], sum);
    if (first + sum < first) atomicAdd(push.totals.at[at + 1], 1);
  }
  return subgroupBroadcastFirst(first) + before;
}

// Numbers a pair among those of its cell, in no particular order.
uint takePlaces(uint cell, uint count) {
  return atomicAdd(push.begins.at[cell], count) + 1;  // Cells begin at kNoCell.
}

void writePair(uint pair, uint triangle, uint cell, uint place) {
  if (pair >= push.mostPairs) return;
  push.cells.at[pair] = cell;
  push.touching.at[pair] = triangle;
  if (uint64_t(push.begins) != 0) push.places.at[pair] = place;
}

void listPair(uint pair, uint triangle, uint cell) {
  writePair(pair, triangle, cell, uint64_t(push.begins) == 0 ? 0 : takePlaces(cell, 1));
}

// Lists the first pair of each run, of which some are not empty. A crowded cell's runs tend to be adjacent, so all that
// begin in the same cell as the first one need one atomic operation.
void listFirstPair(CellRun run, uvec4 some, uint pair) {
  uint place = 0;
  if (uint64_t(push.begins) != 0) {
    const uint cell = subgroupBroadcast(run.firstCell, subgroupBallotFindLSB(some));
    const bool isSame = run.size > 0 && run.firstCell == cell;
    const uvec4 same = subgroupBallot(isSame);
    uint first = 0;
    if (isSame ? subgroupBallotExclusiveBitCount(same) == 0 : run.size > 0)
      first = takePlaces(run.firstCell, isSame ? subgroupBallotBitCount(same) : 1);
    const uint ofSame = subgroupBroadcast(first, subgroupBallotFindLSB(some));
    place = isSame ? ofSame + subgroupBallotExclusiveBitCount(same) : first;
  }
  if (run.size > 0) writePair(pair, run.triangle, run.firstCell, place);
}

// Lists the pairs of a run of each invocation: of short ones one by one, of long ones together.
void listRuns(CellRun run) {
  const uvec4 some = subgroupBallot(run.size > 0);
  if (some == uvec4(0)) return;
  const uint first = addToTotal(kPairsWord, run.size);
  listFirstPair(run, some, first);
  const bool isLong = run.size > kShortRun;
  for (uint i = 1; i < (isLong ? 0 : run.size); ++i) listPair(first + i, run.triangle, run.firstCell + i);
  uvec4 left = subgroupBallot(isLong);
  while (left != uvec4(0)) {
    const uint lane = subgroupBallotFindLSB(left);
    const CellRun lanes = CellRun(subgroupBroadcast(run.triangle, lane), subgroupBroadcast(run.firstCell, lane),
                                  subgroupBroadcast(run.size, lane));
    const uint pair = subgroupBroadcast(first, lane);
    for (uint i = 1 + gl_SubgroupInvocationID; i < lanes.size; i += gl_SubgroupSize)
      listPair(pair + i, lanes.triangle, lanes.firstCell + i);
    left[lane / 32] &= ~(1u << lane % 32);
  }
}

uint64_t rowWord(uint triangle, uint number) {
  return uint64_t(triangle) << 32 | number;
}
