#include "report.h"

#include <raymap/atomic_file.h>
#include <raymap/json.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <ostream>
#include <utility>

#include "terminal.h"

namespace raymap {

std::string sizeText(size_t bytes) {
  const std::array<const char*, 4> units{"kB", "MB", "GB", "TB"};
  double size = double(bytes) / 1000.0;
  size_t unit = 0;
  for (; size >= 1000.0 && unit + 1 < units.size(); ++unit) size /= 1000.0;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g %s", size, units[unit]);
  return text.data();
}

std::string describeTimes(const std::vector<Stats::Stage>& steps, double elapsedMilliseconds) {
  std::string text;
  const auto addLine = [&](const std::string& name, double milliseconds) {
    std::array<char, 32> time{};
    std::snprintf(time.data(), time.size(), "%10.1f ms\n", milliseconds);
    text += "  " + name + std::string(std::max<ptrdiff_t>(21 - ptrdiff_t(name.size()), 1), ' ') + time.data();
  };
  double sum = 0.0;
  for (const Stats::Stage& step : steps) {
    addLine(step.name, step.milliseconds);
    sum += step.milliseconds;
  }
  addLine("other", std::max(elapsedMilliseconds - sum, 0.0));
  addLine("elapsed", elapsedMilliseconds);
  return text;
}

Stats::Stage slowestStep(const std::vector<Stats::Stage>& steps) {
  std::map<std::string, double> sums;
  for (const Stats::Stage& step : steps) sums[step.name] += step.milliseconds;
  const auto slowest = std::ranges::max_element(sums, {}, [](const auto& sum) { return sum.second; });
  return {slowest->first, slowest->second};
}

std::string whyItTakesLong(const RepairGrid& grid) {
  constexpr double kMost = 2.0 * kRepairResolution * kRepairResolution;  // Of a plate, by default.
  if (!grid.thinnest || !grid.keepsThinnest() || grid.surfaceCubes <= kMost) return {};
  const double shrink = double(kRepairResolution) / double(std::max({grid.dims.x, grid.dims.y, grid.dims.z}));
  if (shrink >= 1.0) return {};
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "this takes a while: about %.2g cubes of samples at the surface, because the thinnest part is "
      "%.3g thick; --resolution %d takes %.2g %% of them, but is too coarse for that part",
      grid.surfaceCubes, *grid.thinnest, kRepairResolution, 100.0 * shrink * shrink);
  return text.data();
}

void printOrientation(const Stats& stats) {
  const size_t turned = stats.turnedFaces.size(), leftOut = stats.leftOutFaces.size();
  if (leftOut > 0)
    std::printf("orientation: left out %s with the corners of another\n", counted(leftOut, "face").c_str());
  if (turned > 0)
    std::printf("orientation: reversed %s that pointed the wrong way\n", counted(turned, "face").c_str());
  if (turned > 0 && isVerbose())
    std::printf("  misfit of the crossings: %.3g as given, %.3g now\n", stats.misfitGiven, stats.misfit);
}

Json figuresOf(const Grid& grid) {
  return {{"dims", toJson(grid.dims)},
          {"origin", toJson(grid.origin)},
          {"spacing", grid.spacing},
          {"samples", grid.sampleCount()}};
}

void writeJson(const std::filesystem::path& path, const Json& json) {
  writeAtomically(path, [&](std::ostream& out) { out << textOf(json); });
}

void printWritten(const std::filesystem::path& path) {
  const bool hasSize = std::filesystem::is_regular_file(path) && !path.string().starts_with("/dev/");
  const std::string size = hasSize ? ", " + sizeText(std::filesystem::file_size(path)) : "";
  std::printf("wrote %s%s\n", displayName(path).c_str(), size.c_str());
}

size_t peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return size_t(usage.ru_maxrss) * 1024;  // Linux counts in kilobytes.
}

}  // namespace raymap
