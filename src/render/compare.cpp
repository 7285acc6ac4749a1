// Comparison of two fields. The picture follows Krayer & Müller 2019, Fig. 11.

#include <raymap/error.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "field/field_sampler.h"
#include "render/slice_view.h"

namespace raymap {

namespace {

std::string text(const glm::dvec3& v) {
  return std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z);
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
    refuseGrids("spacing " + std::to_string(a.spacing) + " against " + std::to_string(b.spacing));
  // Some formats keep single precision only.
  const double rounding = std::max(1e-3 * a.spacing, 1e-6 * glm::length(a.origin));
  if (glm::length(a.origin - b.origin) > rounding)
    refuseGrids("origin " + text(a.origin) + " against " + text(b.origin));
}

/// Two fields on one grid, sample by sample.
class FieldPair {
 public:
  FieldPair(const Field& a, const Field& b) : a_(a), b_(b) {
    validateField(a);
    validateField(b);
    requireSameGrid(a.grid, b.grid);
    for (const double band : {a.band, b.band})
      if (band > 0.0) band_ = std::min(band_, band);
  }
  bool isFinite(size_t n) const { return std::isfinite(a_.distance[n]) && std::isfinite(b_.distance[n]); }
  /// Returns the difference of the distances, in samples.
  double error(size_t n) const {
    return std::abs(clamped(a_.distance[n]) - clamped(b_.distance[n])) / a_.grid.spacing;
  }
  bool differsInSign(size_t n) const { return (a_.distance[n] < 0.0f) != (b_.distance[n] < 0.0f); }

 private:
  double clamped(float value) const { return std::clamp(double(value), -band_, band_); }

  const Field& a_;
  const Field& b_;
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

/// Returns the slice with the most samples that differ in sign, as {axis, index}.
glm::ivec2 mostDifferentSlice(const FieldPair& pair, const Grid& grid) {
  std::array<std::vector<size_t>, 3> counts;
  for (int a = 0; a < 3; ++a) counts[a].resize(size_t(grid.dims[a]));
  for (int k = 0; k < grid.dims.z; ++k)
    for (int j = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i) {
        const size_t n = grid.index({i, j, k});
        if (!pair.differsInSign(n) || !pair.isFinite(n)) continue;
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

}  // namespace

Comparison compareFields(const Field& a, const Field& b) {
  const FieldPair pair(a, b);
  std::vector<Tally> sheets(size_t(a.grid.dims.z));
  parallelFor(sheets.size(), 1, [&](size_t k, size_t) { sheets[k] = tallySheet(pair, a.grid, int(k)); });
  return joinSheets(sheets);
}

Picture renderComparison(const Field& a, const Field& b, int width) {
  const Comparison comparison = compareFields(a, b);
  makePicture(width, 1);  // Throws for an invalid width, by which `pixelSize` divides.
  const FieldPair pair(a, b);
  const bool showsSigns = comparison.signDifferences > 0;
  const glm::ivec2 slice =
      showsSigns ? mostDifferentSlice(pair, a.grid) : glm::ivec2(2, comparison.worstSample.z);
  const SliceView view(a.grid, slice[0], slice[1]);
  const double pixel = view.pixelSize(width);
  const double scale = comparison.maxError > 0.0 ? 1.0 / comparison.maxError : 0.0;

  const auto drawSurface = [&](const Colour& ground, const Field& field, glm::dvec2 at, const Colour& line) {
    const double value = view.value(field.distance, at);
    const double slope = view.slope(field.distance, at, pixel);
    return slope > 0.0 && std::isfinite(value / slope) ? drawContour(ground, value, slope, line) : ground;
  };
  return view.paint(width, [&](glm::dvec2 at) {
    const size_t n = view.nearest(at);
    if (!pair.isFinite(n)) return kNotFinite;
    const Colour ground = showsSigns ? signColour(a.distance[n] < 0.0f, b.distance[n] < 0.0f)
                                     : errorColour(scale * pair.error(n));
    return drawSurface(drawSurface(ground, b, at, srgb(40, 90, 200)), a, at, kContour);
  });
}

}  // namespace raymap
