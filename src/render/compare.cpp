// Comparison of two fields. The picture follows Krayer & Müller 2019, Fig. 11.

#include <raymap/error.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "field/field_sampler.h"
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

/// An array of two fields on one grid, sample by sample.
class FieldPair {
 public:
  FieldPair(const Field& a, const Field& b, FieldArray array) : a_(a), b_(b), array_(array) {
    validateArray(a, array);
    validateArray(b, array);
    requireSameGrid(a.grid, b.grid);
    if (array != FieldArray::Distance) return;
    unit_ = a.grid.spacing;
    for (const double band : {a.clampDistance, b.clampDistance})
      if (band > 0.0) band_ = std::min(band_, band);
  }
  bool isFinite(size_t n) const {
    return isTriangle() || (std::isfinite(numbers(a_)[n]) && std::isfinite(numbers(b_)[n]));
  }
  /// Returns the difference of the numbers; of distances in samples.
  double error(size_t n) const {
    return isTriangle() ? 0.0 : std::abs(clamped(numbers(a_)[n]) - clamped(numbers(b_)[n])) / unit_;
  }
  bool differsInSign(size_t n) const {
    return array_ == FieldArray::Distance && (a_.distance[n] < 0.0f) != (b_.distance[n] < 0.0f);
  }
  bool differs(size_t n) const {
    return isTriangle() ? a_.triangle[n] != b_.triangle[n] : numbers(a_)[n] != numbers(b_)[n];
  }

 private:
  bool isTriangle() const { return array_ == FieldArray::Triangle; }
  const Buffer<float>& numbers(const Field& field) const { return numbersOf(field, array_); }
  double clamped(float value) const { return std::clamp(double(value), -band_, band_); }

  const Field& a_;
  const Field& b_;
  FieldArray array_;
  double unit_ = 1.0;
  double band_ = INFINITY;
};

/// Result of one sheet, with the sums for the means.
struct Tally {
  Comparison result;
  double sum = 0.0;
  double squares = 0.0;
};

Tally tallySheet(const FieldPair& pair, const Grid& grid, int k) {
  Tally tally;
  Comparison& c = tally.result;
  c.worstSample.z = k;
  for (int j = 0; j < grid.dims.y; ++j)
    for (int i = 0; i < grid.dims.x; ++i) {
      const size_t n = grid.index({i, j, k});
      ++c.samples;
      if (!pair.isFinite(n)) {
        ++c.nonFinite;
        continue;
      }
      const double error = pair.error(n);
      tally.sum += error;
      tally.squares += error * error;
      c.signDifferences += pair.differsInSign(n) ? 1 : 0;
      c.differences += pair.differs(n) ? 1 : 0;
      if (error > c.maxError) {
        c.maxError = error;
        c.worstSample = {i, j, k};
      }
    }
  return tally;
}

Comparison joinSheets(const std::vector<Tally>& sheets) {
  Comparison all;
  double sum = 0.0, squares = 0.0;
  for (const Tally& sheet : sheets) {
    sum += sheet.sum;
    squares += sheet.squares;
    all.signDifferences += sheet.result.signDifferences;
    all.differences += sheet.result.differences;
    all.nonFinite += sheet.result.nonFinite;
    all.samples += sheet.result.samples;
    if (sheet.result.maxError > all.maxError) {
      all.maxError = sheet.result.maxError;
      all.worstSample = sheet.result.worstSample;
    }
  }
  const double counted = double(std::max<size_t>(all.samples - all.nonFinite, 1));
  all.meanError = sum / counted;
  all.rmsError = std::sqrt(squares / counted);
  return all;
}

/// Returns the slice with the most finite samples for which `isCounted(sample)`, as {axis, index}.
template <class Counted>
glm::ivec2 mostDifferentSlice(const FieldPair& pair, const Grid& grid, Counted&& isCounted) {
  std::array<std::vector<size_t>, 3> counts;
  for (int a = 0; a < 3; ++a) counts[a].resize(size_t(grid.dims[a]));
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i) {
        const size_t n = grid.index({i, j, k});
        if (!isCounted(n) || !pair.isFinite(n)) continue;
        ++counts[0][size_t(i)];
        ++counts[1][size_t(j)];
        ++counts[2][size_t(k)];
      }
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
  SurfaceLines(const SliceView& view, double pixel, FieldArray array)
      : view_(view), pixel_(pixel), array_(array) {}

  Colour draw(const Colour& ground, const Field& field, glm::dvec2 at, const Colour& line) const {
    if (array_ == FieldArray::Confidence) return ground;
    const Buffer<float>& numbers = numbersOf(field, array_);
    const auto read = [&](const glm::ivec3& sample) { return numbers[field.grid.index(sample)]; };
    const double number = view_.value(read, at), slope = view_.slope(read, at, pixel_);
    const double value = array_ == FieldArray::Winding ? std::abs(number) - 0.5 : number;
    return slope > 0.0 && std::isfinite(value / slope) ? drawContour(ground, value, slope, line) : ground;
  }

 private:
  const SliceView& view_;
  double pixel_;
  FieldArray array_;
};

Picture renderTriangles(const FieldPair& pair, const Grid& grid, int width) {
  const glm::ivec2 slice = mostDifferentSlice(pair, grid, [&](size_t n) { return pair.differs(n); });
  const SliceView view(grid, slice[0], slice[1]);
  return view.paint(width, [&](glm::dvec2 at) {
    return pair.differs(grid.index(view.nearest(at))) ? srgb(208, 58, 52) : srgb(238, 239, 241);
  });
}

}  // namespace

Comparison compareFields(const Field& a, const Field& b, FieldArray array) {
  const FieldPair pair(a, b, array);
  std::vector<Tally> sheets(size_t(a.grid.dims.z));
  parallelFor(sheets.size(), 1, [&](size_t k, size_t) { sheets[k] = tallySheet(pair, a.grid, int(k)); });
  return joinSheets(sheets);
}

Picture renderComparison(const Field& a, const Field& b, int width, FieldArray array) {
  const Comparison comparison = compareFields(a, b, array);
  makePicture(width, 1);  // Throws for an invalid width, by which `pixelSize` divides.
  const FieldPair pair(a, b, array);
  if (array == FieldArray::Triangle) return renderTriangles(pair, a.grid, width);
  const bool showsSigns = comparison.signDifferences > 0;
  const glm::ivec2 slice =
      showsSigns ? mostDifferentSlice(pair, a.grid, [&](size_t n) { return pair.differsInSign(n); })
                 : glm::ivec2(2, comparison.worstSample.z);
  const SliceView view(a.grid, slice[0], slice[1]);
  const SurfaceLines lines(view, view.pixelSize(width), array);
  const double scale = comparison.maxError > 0.0 ? 1.0 / comparison.maxError : 0.0;
  return view.paint(width, [&](glm::dvec2 at) {
    const size_t n = a.grid.index(view.nearest(at));
    if (!pair.isFinite(n)) return kNotFinite;
    const Colour ground = showsSigns ? signColour(a.distance[n] < 0.0f, b.distance[n] < 0.0f)
                                     : errorColour(scale * pair.error(n));
    return lines.draw(lines.draw(ground, b, at, srgb(40, 90, 200)), a, at, kContour);
  });
}

}  // namespace raymap
