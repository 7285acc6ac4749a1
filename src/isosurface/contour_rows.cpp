#include "isosurface/contour_rows.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "field/sparse_reader.h"

namespace raymap {

namespace {

constexpr size_t kRowsPerTask = 64;

ContourCube cubeOf(int x, unsigned corners) {
  return {x, static_cast<uint8_t>(corners), 0, 0, {}, 0, 0};
}

/// Finds the cubes of a dense field, row by row.
class DenseCubes {
 public:
  DenseCubes(const Field& field, double iso, Progress& progress)
      : field_(field), iso_(iso), progress_(progress), dims_(field.grid.dims + 1) {}

  ContourRows find() const {
    std::vector<size_t> counts(size_t(dims_.y) * size_t(dims_.z));
    parallelFor(counts.size(), kRowsPerTask, [&](size_t begin, size_t end) {
      progress_.report(0.5 * double(begin) / double(counts.size()));
      for (size_t row = begin; row < end; ++row) scanRow(rowAt(row), [&](int, unsigned) { ++counts[row]; });
    });
    ContourRows found;
    for (size_t row = 0; row < counts.size(); ++row) {
      if (counts[row] == 0) continue;
      found.rows.push_back(rowAt(row));
      found.begin.push_back(found.begin.back() + counts[row]);
    }
    found.cubes.resize(found.begin.back());
    parallelFor(found.rows.size(), kRowsPerTask, [&](size_t begin, size_t end) {
      progress_.report(0.5 + 0.5 * double(begin) / double(found.rows.size()));
      for (size_t row = begin; row < end; ++row) {
        ContourCube* cube = found.cubes.data() + found.begin[row];
        scanRow(found.rows[row], [&](int x, unsigned corners) { *cube++ = cubeOf(x, corners); });
      }
    });
    return found;
  }

 private:
  ContourRows::Row rowAt(size_t row) const {
    return {int(row / size_t(dims_.y)), int(row % size_t(dims_.y))};
  }

  /// Calls `visit(x, corners)` for each cube of a row that has corners inside and outside.
  template <class Visit>
  void scanRow(const ContourRows::Row& row, Visit&& visit) const {
    const glm::ivec3 last = field_.grid.dims - 1;
    std::array<const float*, 4> samples{};
    for (int r = 0; r < 4; ++r) {
      const int j = row.y - 1 + (r & 1), k = row.z - 1 + (r >> 1);
      if (j >= 0 && j <= last.y && k >= 0 && k <= last.z)
        samples[r] = field_.distance.data() + field_.grid.index({0, j, k});
    }
    unsigned low = 0;
    for (int x = 0; x < dims_.x; ++x) {
      unsigned high = 0;
      if (x <= last.x)
        for (int r = 0; r < 4; ++r)
          if (samples[r] && samples[r][x] < iso_) high |= 1u << 2 * r;
      const unsigned corners = low | high << 1;
      if (corners != 0 && corners != 255) visit(x, corners);
      low = high;
    }
  }

  const Field& field_;
  double iso_;
  Progress& progress_;
  glm::ivec3 dims_;  // Number of cubes per axis, one more than samples.
};

/// Finds the cubes of a narrow band. A block holds 8 x 8 x 8 cubes, whose highest corners are the samples of
/// one leaf. So its cubes have samples of eight leaves.
class SparseCubes {
 public:
  SparseCubes(const Field& band, double iso, Progress& progress)
      : band_(band), iso_(iso), progress_(progress) {}

  ContourRows find() {
    listBlocks();
    std::vector<size_t> places((runs_.size() - 1) * kRowsOfBlock);
    forEachRun([&](size_t run) {
      scanRun(run, [&](size_t row, int, unsigned) { ++places[run * kRowsOfBlock + row]; });
    });
    ContourRows found = makeRows(places);
    forEachRun([&](size_t run) {
      scanRun(run, [&](size_t row, int x, unsigned corners) {
        found.cubes[places[run * kRowsOfBlock + row]++] = cubeOf(x, corners);
      });
    });
    return found;
  }

 private:
  static constexpr int kSide = NarrowBand::kLeafSide;
  static constexpr size_t kRowsOfBlock = size_t(kSide) * kSide;
  /// Whether samples are inside: bits along x, in rows along y and z, from the block's lowest corner.
  using InsideBits = std::array<std::array<unsigned, kSide + 1>, kSide + 1>;

  // Blocks.

  /// Lists the blocks that may have cubes in rows along x, and where these begin.
  void listBlocks() {
    const glm::ivec3 ceil = (band_.grid.dims + kSide - 1) / kSide * kSide;
    checkSurfaceMemory(8 * sizeof(glm::ivec3) * (band_.narrow->leaves.size() + countTileBlocks(ceil)));
    for (const glm::ivec3& leaf : band_.narrow->leaves) addBlocks(leaf);
    for (const NarrowBand::Tile& tile : band_.narrow->tiles)
      forEachOnSides(glm::min(tile.low + tile.side, ceil) - tile.low,
                     [&](const glm::ivec3& within) { addBlocks(tile.low + within); });
    parallelSort(blocks_.begin(), blocks_.end(), [](const glm::ivec3& a, const glm::ivec3& b) {
      return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
    });
    blocks_.erase(std::unique(blocks_.begin(), blocks_.end()), blocks_.end());
    for (size_t b = 0; b < blocks_.size(); ++b)
      if (b == 0 || blocks_[b].z != blocks_[b - 1].z || blocks_[b].y != blocks_[b - 1].y) runs_.push_back(b);
    runs_.push_back(blocks_.size());
  }

  size_t countTileBlocks(const glm::ivec3& ceil) const {
    size_t count = 0;
    for (const NarrowBand::Tile& tile : band_.narrow->tiles) {
      const glm::ivec3 size = (glm::min(tile.low + tile.side, ceil) - tile.low) / kSide;
      for (int axis = 0; axis < 3; ++axis) count += 2 * size_t(size[axis]) * size_t(size[(axis + 1) % 3]);
    }
    return count;
  }

  /// Adds the blocks of cubes that have samples of a leaf.
  void addBlocks(const glm::ivec3& leaf) {
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 block = leaf + kSide * glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
      if (glm::all(glm::lessThanEqual(block, band_.grid.dims))) blocks_.push_back(block);
    }
  }

  /// Calls `visit` with the first sample of each leaf at the sides of a cuboid of this size.
  template <class Visit>
  static void forEachOnSides(const glm::ivec3& size, Visit&& visit) {
    const glm::ivec3 last = size - kSide;
    for (int z = 0; z <= last.z; z += kSide)
      for (int y = 0; y <= last.y; y += kSide) {
        const bool isSide = z == 0 || z == last.z || y == 0 || y == last.y;
        for (int x = 0; x <= last.x; x += isSide ? kSide : std::max(last.x, kSide))
          visit(glm::ivec3(x, y, z));
      }
  }

  // Cubes.

  template <class Work>
  void forEachRun(Work&& work) const {
    parallelFor(runs_.size() - 1, 1, [&](size_t run, size_t) {
      progress_.report(double(run) / double(runs_.size()));
      work(run);
    });
  }

  /// Turns the numbers of cubes in the rows of each run into rows, and the numbers into places of their first
  /// cubes.
  ContourRows makeRows(std::vector<size_t>& places) const {
    struct Counted {
      ContourRows::Row row;
      size_t place;
    };
    std::vector<Counted> rows;
    for (size_t place = 0; place < places.size(); ++place) {
      if (places[place] == 0) continue;
      const glm::ivec3& block = blocks_[runs_[place / kRowsOfBlock]];
      const int within = int(place % kRowsOfBlock);
      rows.push_back({{block.z + within / kSide, block.y + within % kSide}, place});
    }
    std::ranges::sort(rows, {}, &Counted::row);
    ContourRows found;
    for (const Counted& counted : rows) {
      const size_t first = found.begin.back();
      found.rows.push_back(counted.row);
      found.begin.push_back(first + places[counted.place]);
      places[counted.place] = first;
    }
    found.cubes.resize(found.begin.back());
    return found;
  }

  /// Calls `visit(row, x, corners)` for each cube of a run of blocks that has corners inside and outside. The
  /// cubes of each row come in their order.
  template <class Visit>
  void scanRun(size_t run, Visit&& visit) const {
    for (size_t b = runs_[run]; b < runs_[run + 1]; ++b) {
      const InsideBits bits = bitsOf(blocks_[b]);
      for (int z = 0; z < kSide; ++z)
        for (int y = 0; y < kSide; ++y)
          scanRow({bits[z][y], bits[z][y + 1], bits[z + 1][y], bits[z + 1][y + 1]},
                  [&](int x, unsigned corners) {
                    visit(size_t(z) * kSide + size_t(y), blocks_[b].x + x, corners);
                  });
    }
  }

  /// Calls `visit(x, corners)` for each cube between four rows of bits, along y and then z.
  template <class Visit>
  static void scanRow(const std::array<unsigned, 4>& rows, Visit&& visit) {
    const unsigned any = rows[0] | rows[1] | rows[2] | rows[3], all = rows[0] & rows[1] & rows[2] & rows[3];
    const unsigned crossed = (any | any >> 1) & ~(all & all >> 1);
    for (int x = 0; x < kSide; ++x) {
      if ((crossed >> x & 1) == 0) continue;
      unsigned corners = 0;
      for (int r = 0; r < 4; ++r) corners |= (rows[r] >> x & 3) << 2 * r;
      visit(x, corners);
    }
  }

  InsideBits bitsOf(const glm::ivec3& block) const {
    std::array<SparseBlock, 8> leaves;
    for (int corner = 0; corner < 8; ++corner)
      leaves[corner] = blockAt(
          band_, block - kSide * glm::ivec3(1 - (corner & 1), 1 - (corner >> 1 & 1), 1 - (corner >> 2)));
    InsideBits bits{};
    const glm::ivec3 low = block - 1, dims = band_.grid.dims;
    for (int z = std::max(-low.z, 0); z <= std::min(kSide, dims.z - 1 - low.z); ++z)
      for (int y = std::max(-low.y, 0); y <= std::min(kSide, dims.y - 1 - low.y); ++y)
        for (int x = std::max(-low.x, 0); x <= std::min(kSide, dims.x - 1 - low.x); ++x) {
          const SparseBlock& leaf = leaves[(x > 0 ? 1 : 0) + (y > 0 ? 2 : 0) + (z > 0 ? 4 : 0)];
          if (leaf.at(low + glm::ivec3(x, y, z)) < iso_) bits[z][y] |= 1u << x;
        }
    return bits;
  }

  const Field& band_;
  double iso_;
  Progress& progress_;
  std::vector<glm::ivec3> blocks_;
  std::vector<size_t> runs_;  // First block of each row of blocks, and the number of blocks.
};

}  // namespace

ContourRows findCubes(const Field& field, double iso, Progress& progress) {
  return field.narrow ? SparseCubes(field, iso, progress).find() : DenseCubes(field, iso, progress).find();
}

}  // namespace raymap
