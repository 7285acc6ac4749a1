// Comparison of two fields. The picture follows Krayer & Müller 2019, Fig. 11.

#include <raymap/error.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <tuple>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "base/text.h"
#include "render/array_reader.h"
#include "render/slice_view.h"

namespace raymap {

namespace {

std::string text(const glm::dvec3& v) {
  return numberText(v.x) + ", " + numberText(v.y) + ", " + numberText(v.z);
}

std::string text(glm::ivec3 dims) {
  return std::to_string(dims.x) + " x " + std::to_string(dims.y) + " x " + std::to_string(dims.z);
}

[[noreturn]] void refuseGrids(const std::string& what) {
  throw Error(ErrorCode::Usage, "the fields cannot be compared, their grids differ: " + what +
                                    "; make both with the same bounds and resolution");
}

void requireSameGrid(const Grid& a, const Grid& b) {
  if (a.dims != b.dims) refuseGrids(text(a.dims) + " samples against " + text(b.dims));
  const int longest = std::max({a.dims.x, a.dims.y, a.dims.z});
  if (std::abs(a.spacing - b.spacing) * longest > 1e-3 * a.spacing)
    refuseGrids("spacing " + numberText(a.spacing) + " against " + numberText(b.spacing));
  // Some formats keep single precision only.
  const double rounding = std::max(1e-3 * a.spacing, 1e-6 * glm::length(a.origin));
  if (glm::length(a.origin - b.origin) > rounding)
    refuseGrids("origin " + text(a.origin) + " against " + text(b.origin));
}

/// The values of two fields at a sample.
struct TwoValues {
  float a, b;
  bool differ;

  bool areFinite() const { return std::isfinite(a) && std::isfinite(b); }
};

/// An array of two fields on one grid, sample by sample.
template <class Array>
class FieldPair {
 public:
  FieldPair(const Array& a, const Array& b) : a_(a), b_(b) {
    requireSameGrid(a.grid(), b.grid());
    if (a.kind() != FieldArray::Distance) return;
    unit_ = a.grid().spacing;
    for (const double band : {a.clampDistance(), b.clampDistance()})
      if (band > 0.0) band_ = std::min(band_, band);
  }
  const Grid& grid() const { return a_.grid(); }
  /// Reads a sample of both. Of triangles, only whether they differ matters.
  TwoValues at(const glm::ivec3& s) const {
    if (a_.kind() == FieldArray::Triangle) return {0.0f, 0.0f, a_.triangle(s) != b_.triangle(s)};
    const float a = a_(s), b = b_(s);
    return {a, b, a != b};
  }
  /// Returns the difference of the numbers; of distances in samples.
  double error(const TwoValues& two) const { return std::abs(clamped(two.a) - clamped(two.b)) / unit_; }
  bool differInSign(const TwoValues& two) const {
    return a_.kind() == FieldArray::Distance && (two.a < 0.0f) != (two.b < 0.0f);
  }

 private:
  double clamped(float value) const { return std::clamp(double(value), -band_, band_); }

  const Array& a_;
  const Array& b_;
  double unit_ = 1.0;
  double band_ = INFINITY;
};

/// A box of samples. In a uniform one, each field has the same value everywhere.
struct ComparedBox {
  glm::ivec3 low, high;
  bool isUniform = false;

  size_t samples() const {
    const glm::ivec3 size = high - low;
    return size_t(size.x) * size_t(size.y) * size_t(size.z);
  }
  /// Calls `visit(sample, count)` for each sample, or once for all those of a uniform one.
  template <class Visit>
  void forEach(Visit&& visit) const {
    if (isUniform) return visit(low, samples());
    for (int k = low.z; k < high.z; ++k)
      for (int j = low.y; j < high.y; ++j)
        for (int i = low.x; i < high.x; ++i) visit(glm::ivec3(i, j, k), size_t{1});
  }
};

/// Boxes that hold all samples once, and how many of them are one task.
struct ComparedBoxes {
  std::vector<ComparedBox> list;
  size_t perTask = 1;
};

/// Returns the sheets of the grid.
ComparedBoxes boxesOf(const DenseArray& a, const DenseArray&) {
  const glm::ivec3 dims = a.grid().dims;
  ComparedBoxes boxes;
  for (int k = 0; k < dims.z; ++k) boxes.list.push_back({{0, 0, k}, {dims.x, dims.y, k + 1}});
  return boxes;
}

/// Adds the boxes of a cube of samples: the largest cubes without leaves in either band, and those of 8 x 8 x
/// 8 samples.
void addBoxes(const BandArray& a, const BandArray& b, const glm::ivec3& low, int side,
              std::vector<ComparedBox>& boxes) {
  const glm::ivec3 dims = a.grid().dims;
  if (glm::any(glm::greaterThanEqual(low, dims))) return;
  const bool isUniform = std::min(a.emptySide(low), b.emptySide(low)) >= side;
  if (isUniform || side == NarrowBand::kLeafSide) {
    boxes.push_back({low, glm::min(low + side, dims), isUniform});
    return;
  }
  for (int child = 0; child < 8; ++child)
    addBoxes(a, b, low + side / 2 * glm::ivec3(child & 1, child >> 1 & 1, child >> 2), side / 2, boxes);
}

ComparedBoxes boxesOf(const BandArray& a, const BandArray& b) {
  const glm::ivec3 dims = a.grid().dims;
  ComparedBoxes boxes{.list = {}, .perTask = 1024};
  const auto longest = uint32_t(std::max({dims.x, dims.y, dims.z, NarrowBand::kLeafSide}));
  addBoxes(a, b, glm::ivec3(0), int(std::bit_ceil(longest)), boxes.list);
  return boxes;
}

/// Result of some boxes, with the sums for the means.
struct Tally {
  Comparison result;
  double sum = 0.0;
  double squares = 0.0;

  /// Notes a sample if its error is the largest. Of equal errors, that of the first sample is taken.
  void note(double error, const glm::ivec3& sample) {
    const auto place = [](const glm::ivec3& s) { return std::tuple(s.z, s.y, s.x); };
    if (error < result.maxError || error == 0.0) return;
    if (error == result.maxError && place(sample) > place(result.worstSample)) return;
    result.maxError = error;
    result.worstSample = sample;
  }

  template <class Array>
  void add(const FieldPair<Array>& pair, const glm::ivec3& sample, size_t count) {
    result.samples += count;
    const TwoValues two = pair.at(sample);
    if (!two.areFinite()) {
      result.nonFinite += count;
      return;
    }
    const double error = pair.error(two);
    sum += double(count) * error;
    squares += double(count) * error * error;
    result.signDifferences += pair.differInSign(two) ? count : 0;
    result.differences += two.differ ? count : 0;
    note(error, sample);
  }
};

Comparison joinTallies(const std::vector<Tally>& tallies) {
  Tally all;
  for (const Tally& tally : tallies) {
    all.sum += tally.sum;
    all.squares += tally.squares;
    all.result.signDifferences += tally.result.signDifferences;
    all.result.differences += tally.result.differences;
    all.result.nonFinite += tally.result.nonFinite;
    all.result.samples += tally.result.samples;
    all.note(tally.result.maxError, tally.result.worstSample);
  }
  Comparison& result = all.result;
  const double counted = double(std::max<size_t>(result.samples - result.nonFinite, 1));
  result.meanError = all.sum / counted;
  result.rmsError = std::sqrt(all.squares / counted);
  return result;
}

template <class Array>
Comparison comparePair(const FieldPair<Array>& pair, const ComparedBoxes& boxes) {
  std::vector<Tally> tallies((boxes.list.size() + boxes.perTask - 1) / boxes.perTask);
  parallelFor(tallies.size(), 1, [&](size_t t, size_t) {
    const size_t end = std::min((t + 1) * boxes.perTask, boxes.list.size());
    for (size_t box = t * boxes.perTask; box < end; ++box)
      boxes.list[box].forEach(
          [&](const glm::ivec3& sample, size_t count) { tallies[t].add(pair, sample, count); });
  });
  return joinTallies(tallies);
}

/// Returns the slice with the most finite samples whose values `isCounted` counts, as {axis, index}.
template <class Array, class Counted>
glm::ivec2 mostDifferentSlice(const FieldPair<Array>& pair, const ComparedBoxes& boxes, Counted&& isCounted) {
  std::array<std::vector<size_t>, 3> counts;
  for (int a = 0; a < 3; ++a) counts[a].resize(size_t(pair.grid().dims[a]));
  for (const ComparedBox& box : boxes.list)
    box.forEach([&](const glm::ivec3& sample, size_t count) {
      const TwoValues two = pair.at(sample);
      if (!two.areFinite() || !isCounted(two)) return;
      const glm::ivec3 size = box.isUniform ? box.high - box.low : glm::ivec3(1);
      for (int axis = 0; axis < 3; ++axis)
        for (int index = sample[axis]; index < sample[axis] + size[axis]; ++index)
          counts[size_t(axis)][size_t(index)] += count / size_t(size[axis]);
    });
  glm::ivec2 best(2, 0);
  size_t most = 0;
  for (const int axis : {2, 1, 0})
    for (size_t index = 0; index < counts[axis].size(); ++index)
      if (counts[axis][index] > most) {
        most = counts[axis][index];
        best = {axis, int(index)};
      }
  return best;
}

Colour signColour(bool insideA, bool insideB) {
  static const Colour kColours[2][2] = {{srgb(238, 239, 241), srgb(62, 158, 84)},
                                        {srgb(208, 58, 52), srgb(176, 179, 184)}};
  return kColours[insideA ? 1 : 0][insideB ? 1 : 0];
}

Colour errorColour(double share) {
  static const Colour kRamp[] = {srgb(255, 255, 255), srgb(250, 190, 110), srgb(150, 20, 30)};
  return share < 0.5 ? glm::mix(kRamp[0], kRamp[1], 2.0 * share)
                     : glm::mix(kRamp[1], kRamp[2], 2.0 * share - 1.0);
}

/// Draws the surface of a field, where it has one, over the colours of a comparison.
class SurfaceLines {
 public:
  SurfaceLines(const SliceView& view, double pixel) : view_(view), pixel_(pixel) {}

  template <class Array>
  Colour draw(const Colour& ground, const Array& array, glm::dvec2 at, const Colour& line) const {
    if (array.kind() == FieldArray::Confidence) return ground;
    const double number = view_.value(array, at), slope = view_.slope(array, at, pixel_);
    const double value = array.kind() == FieldArray::Winding ? std::abs(number) - 0.5 : number;
    return slope > 0.0 && std::isfinite(value / slope) ? drawContour(ground, value, slope, line) : ground;
  }

 private:
  const SliceView& view_;
  double pixel_;
};

template <class Array>
Picture renderTriangles(const FieldPair<Array>& pair, const ComparedBoxes& boxes, int width) {
  const glm::ivec2 slice = mostDifferentSlice(pair, boxes, [](const TwoValues& two) { return two.differ; });
  const SliceView view(pair.grid(), slice[0], slice[1]);
  return view.paint(width, [&](glm::dvec2 at) {
    return pair.at(view.nearest(at)).differ ? srgb(208, 58, 52) : srgb(238, 239, 241);
  });
}

template <class Array>
Picture renderArrays(const Array& a, const Array& b, int width) {
  makePicture(width, 1);  // Throws for an invalid width, by which `pixelSize` divides.
  const FieldPair pair(a, b);
  const ComparedBoxes boxes = boxesOf(a, b);
  if (a.kind() == FieldArray::Triangle) return renderTriangles(pair, boxes, width);
  const Comparison comparison = comparePair(pair, boxes);
  const bool showsSigns = comparison.signDifferences > 0;
  const auto inSign = [&](const TwoValues& two) { return pair.differInSign(two); };
  const glm::ivec2 slice =
      showsSigns ? mostDifferentSlice(pair, boxes, inSign) : glm::ivec2(2, comparison.worstSample.z);
  const SliceView view(a.grid(), slice[0], slice[1]);
  const SurfaceLines lines(view, view.pixelSize(width));
  const double scale = comparison.maxError > 0.0 ? 1.0 / comparison.maxError : 0.0;
  return view.paint(width, [&](glm::dvec2 at) {
    const TwoValues two = pair.at(view.nearest(at));
    if (!two.areFinite()) return kNotFinite;
    const Colour ground =
        showsSigns ? signColour(two.a < 0.0f, two.b < 0.0f) : errorColour(scale * pair.error(two));
    return lines.draw(lines.draw(ground, b, at, srgb(40, 90, 200)), a, at, kContour);
  });
}

/// Calls `use` with the arrays of two fields. Throws `Error(Usage)` unless both are narrow bands, or neither.
template <class Use>
auto withArrays(const Field& a, const Field& b, FieldArray array, Use&& use) {
  require(a.narrow.has_value() == b.narrow.has_value(),
          "a narrow band cannot be compared with a dense field; make it dense first");
  return a.narrow ? use(BandArray(a, array), BandArray(b, array))
                  : use(DenseArray(a, array), DenseArray(b, array));
}

}  // namespace

Comparison compareFields(const Field& a, const Field& b, FieldArray array) {
  return withArrays(a, b, array, [](const auto& first, const auto& second) {
    return comparePair(FieldPair(first, second), boxesOf(first, second));
  });
}

Picture renderComparison(const Field& a, const Field& b, int width, FieldArray array) {
  return withArrays(a, b, array, [width](const auto& first, const auto& second) {
    return renderArrays(first, second, width);
  });
}

}  // namespace raymap
