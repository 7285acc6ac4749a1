#pragma once

#include <raymap/narrow_band.h>
#include <raymap/region.h>

#include <array>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"
#include "cpu/points/block_sides.h"

namespace raymap::cpu {

/// Returns a corner of the unit cube, numbered along a Morton curve, x lowest.
inline glm::ivec3 cornerOf(int number) {
  return {number & 1, number >> 1 & 1, number >> 2};
}

/// A cube of 8 x 8 x 8 samples of a lattice, some of which are asked for.
struct AskedCube {
  glm::ivec3 low;  ///< Its first sample, a multiple of 8.
  /// Bit p: whether part p is asked for, of the 4 x 4 x 4 samples from 4 `cornerOf(p)` on.
  uint8_t parts = 0xff;
};

/// Answers for samples of a lattice what `queryPoints` answers at their positions, to the same bits, in less
/// time: they need no sorting, and those near each other share their sign.
class LatticeQuery {
 public:
  static constexpr int kSide = NarrowBand::kLeafSide;  ///< Samples along a cube.
  static constexpr int kPartSide = kSide / 2;
  static constexpr int kDistanceSide = 32;  ///< Side of the cubes whose samples are measured together.
  static constexpr size_t kSamplesOfBlock = size_t(kDistanceSide) * kDistanceSide * kDistanceSide;
  static constexpr size_t kBytesPerSample = 256;  ///< Memory that a call takes.

  /// Samples outside of the region are not asked for. Of the options, what `BandOptions` names counts and the
  /// largest distance.
  LatticeQuery(const PreparedSurface& surface, const Grid& lattice, const Region& region,
               const QueryOptions& options)
      : surface_(surface),
        lattice_(lattice),
        low_(region.low),
        high_(region.low + region.size),
        options_(options) {}

  /// Asks for samples. The cubes are ordered along a Morton curve within cubes of 32 samples.
  void ask(std::span<const AskedCube> cubes);

  /// Calls `visit(sample, point)` for each sample of the k-th cube that was asked for: `answers` has its
  /// results in place `point`.
  template <class Visit>
  void visit(size_t k, Visit&& visit) const {
    size_t point = begins_[k];
    forEachSample(cubes_[k], [&](const glm::ivec3& sample) { visit(sample, point++); });
  }
  const QueryResult& answers() const { return found_; }

  /// Calls `visit(sample)` for the samples of a part of a cube, along a Morton curve.
  template <class Visit>
  static void forEachOfPart(const glm::ivec3& low, int part, Visit&& visit) {
    const glm::ivec3 first = low + kPartSide * cornerOf(part);
    for (int pair = 0; pair < 8; ++pair)
      for (int one = 0; one < 8; ++one) visit(first + 2 * cornerOf(pair) + cornerOf(one));
  }

 private:
  /// Larger cubes of samples, and which points lie in each.
  struct Groups {
    std::vector<glm::ivec3> lows;
    std::vector<size_t> begins;  ///< First point of each, and at last the number of points.
  };

  template <class Visit>
  void forEachSample(const AskedCube& cube, Visit&& visit) const {
    const auto isIn = [&](const glm::ivec3& sample) {
      return glm::all(glm::greaterThanEqual(sample, low_)) && glm::all(glm::lessThan(sample, high_));
    };
    const bool isWhole = isIn(cube.low) && isIn(cube.low + (kSide - 1));
    for (int part = 0; part < 8; ++part)
      if (cube.parts >> part & 1)
        forEachOfPart(cube.low, part, [&](const glm::ivec3& sample) {
          if (isWhole || isIn(sample)) visit(sample);
        });
  }

  /// The share of one coordinate in what is listed of a sample. The shares of x, y and z add up to it.
  struct OnAxis {
    double position;  ///< The point's coordinate.
    int place, code;  ///< Summands of `places_` and `codes_`.
  };

  size_t countOf(const AskedCube& cube) const;
  void list();
  std::array<std::array<OnAxis, kSide>, 3> axesOf(const glm::ivec3& low) const;
  Groups groupsOf(int side) const;
  void measure();
  void sign();

  const PreparedSurface& surface_;
  const Grid& lattice_;
  glm::ivec3 low_, high_;  ///< The region's first sample, and that after its last one.
  QueryOptions options_;
  std::vector<AskedCube> cubes_;
  std::vector<size_t> begins_;  ///< First point of each cube, and at last their number.
  Buffer<glm::dvec3> points_;
  Buffer<uint16_t> places_;  ///< In the cube whose samples share signs, x fastest.
  Buffer<uint16_t> codes_;   ///< In the cube whose samples are measured together, along a Morton curve.
  Buffer<Side> sides_;
  QueryResult found_;
  Progress quiet_;  ///< Reports nothing: a call takes some milliseconds.
};

/// Calls `work(query, block)` for each block of samples, side by side, each on one thread that has a query of
/// its own, and counts the blocks.
template <class Work>
void askInBlocks(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                 const QueryOptions& options, size_t blocks, WorkMeter& meter, Work&& work) {
  parallelWorkers(blocks, [&](const auto& next) {
    withThreads(1, [&] {
      LatticeQuery query(surface, lattice, region, options);
      for (size_t block = next(); block < blocks; block = next()) {
        work(query, block);
        meter.add(1);
      }
    });
  });
}

}  // namespace raymap::cpu
