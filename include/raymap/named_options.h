#pragma once

// The one description of all options: forEachOption(options, use) calls use(option, member) for each, with
// its name, its unit and its range. raymap/c.h, Python and the command line set options by these names. The
// type, the default and the sentence are those of the member in its struct.
//
// scripts/options.py makes docs/options.md, src/describe/option_texts.cpp and the arguments of Python of this
// file and of the comments at the members.

#include <raymap/grid.h>
#include <raymap/isosurface.h>
#include <raymap/local_thickness.h>
#include <raymap/machine.h>
#include <raymap/narrow_band.h>
#include <raymap/options.h>
#include <raymap/page.h>
#include <raymap/picture.h>
#include <raymap/query.h>
#include <raymap/region.h>
#include <raymap/repair.h>
#include <raymap/sample_points.h>
#include <raymap/scene.h>
#include <raymap/simplify.h>

#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace raymap {

/// Least value of an option that is a number. It is finite unless `mayBeInfinite`.
struct Range {
  double least = -std::numeric_limits<double>::max();
  bool isAbove = false;  ///< Whether the value must exceed `least`.
  bool mayBeInfinite = false;
};

inline constexpr Range kFromZero{0.0}, kAboveZero{0.0, true}, kFromOne{1.0};
inline constexpr Range kLimit{0.0, true, true};  ///< Above 0, or infinite: the limit of a search.

/// Name of an option, its unit as help shows it, and its range.
struct OptionName {
  const char* name;
  const char* unit = "";
  Range range = {};
};

template <class Given, class Options>
concept OptionsOf = std::same_as<std::remove_const_t<Given>, Options>;

void forEachOption(OptionsOf<FieldOptions> auto& options, auto&& use) {
  use(OptionName{"distance", "MODE"}, options.distance);
  use(OptionName{"sign", "MODE"}, options.sign);
  use(OptionName{"orientation", "MODE"}, options.orientation);
  use(OptionName{"passes", "N", kFromOne}, options.passes);
  use(OptionName{"sampling", "MODE"}, options.sampling);
  use(OptionName{"offsets", "X Y Z ..."}, options.offsets);
  use(OptionName{"threshold", "W", kFromZero}, options.threshold);
  use(OptionName{"band", "SAMPLES", kFromZero}, options.band);
  use(OptionName{"invert"}, options.invert);
  use(OptionName{"close_holes"}, options.closeHoles);
  use(OptionName{"thickness", "LENGTH", kFromZero}, options.thickness);
  use(OptionName{"allow_empty"}, options.allowEmpty);
  use(OptionName{"triangle"}, options.triangle);
  use(OptionName{"winding"}, options.winding);
  use(OptionName{"confidence"}, options.confidence);
}

void forEachOption(OptionsOf<MachineOptions> auto& options, auto&& use) {
  use(OptionName{"device", "DEVICE"}, options.device);
  use(OptionName{"threads", "N", kFromZero}, options.threads);
  use(OptionName{"memory_limit", "BYTES", kFromZero}, options.memoryLimit);
}

void forEachOption(OptionsOf<GridOptions> auto& options, auto&& use) {
  use(OptionName{"resolution", "N", kFromOne}, options.resolution);
  use(OptionName{"voxel_size", "LENGTH", kFromZero}, options.voxelSize);
  use(OptionName{"shape", "NX NY NZ", kFromOne}, options.dims);
  use(OptionName{"bounds", "X0 Y0 Z0 X1 Y1 Z1"}, options.box);
  use(OptionName{"padding", "SHARE", kFromZero}, options.padding);
  use(OptionName{"thickness", "LENGTH", kFromZero}, options.thickness);
  use(OptionName{"align"}, options.align);
}

void forEachOption(OptionsOf<SurfaceOptions> auto& options, auto&& use) {
  use(OptionName{"sign", "MODE"}, options.sign);
  use(OptionName{"orientation", "MODE"}, options.orientation);
  use(OptionName{"threshold", "W", kFromZero}, options.threshold);
  use(OptionName{"compact"}, options.compact);
}

void forEachOption(OptionsOf<QueryOptions> auto& options, auto&& use) {
  use(OptionName{"max_distance", "LENGTH", kLimit}, options.maxDistance);
}

void forEachOption(OptionsOf<SceneOptions> auto& options, auto&& use) {
  use(OptionName{"max_distance", "LENGTH", kLimit}, options.maxDistance);
}

void forEachOption(OptionsOf<ThicknessOptions> auto& options, auto&& use) {
  use(OptionName{"max_thickness", "LENGTH", kLimit}, options.maxThickness);
}

void forEachOption(OptionsOf<RegionOptions> auto& options, auto&& use) {
  use(OptionName{"band", "SAMPLES", kFromZero}, options.band);
  use(OptionName{"triangle"}, options.triangle);
  use(OptionName{"winding"}, options.winding);
  use(OptionName{"confidence"}, options.confidence);
}

void forEachOption(OptionsOf<BandOptions> auto& options, auto&& use) {
  use(OptionName{"outside", "SAMPLES", kFromZero}, options.outside);
  use(OptionName{"inside", "SAMPLES", {0.0, false, true}}, options.inside);
  use(OptionName{"triangle"}, options.triangle);
  use(OptionName{"winding"}, options.winding);
  use(OptionName{"confidence"}, options.confidence);
}

void forEachOption(OptionsOf<SamplePointsOptions> auto& options, auto&& use) {
  use(OptionName{"count", "N", kFromZero}, options.count);
  use(OptionName{"surface_share", "SHARE", kFromZero}, options.surfaceShare);
  use(OptionName{"near_share", "SHARE", kFromZero}, options.nearShare);
  use(OptionName{"sigmas", "SHARE,...", kFromZero}, options.sigmas);
  use(OptionName{"seed", "N", kFromZero}, options.seed);
  use(OptionName{"normalize"}, options.normalize);
  use(OptionName{"unit", "LENGTH", kFromZero}, options.unit);
  use(OptionName{"in_cube"}, options.inCube);
  use(OptionName{"radius", "LENGTH", kFromZero}, options.radius);
}

void forEachOption(OptionsOf<IsosurfaceOptions> auto& options, auto&& use) {
  use(OptionName{"iso", "LENGTH"}, options.iso);
}

void forEachOption(OptionsOf<RepairOptions> auto& options, auto&& use) {
  use(OptionName{"close_holes"}, options.closeHoles);
  use(OptionName{"offset", "LENGTH"}, options.offset);
  use(OptionName{"shell", "LENGTH", kFromZero}, options.shell);
  use(OptionName{"min_thickness", "LENGTH", kFromZero}, options.minThickness);
  use(OptionName{"drain_hole", "LENGTH", kFromZero}, options.drainHole);
  use(OptionName{"drain_holes", "N", kFromOne}, options.drainHoles);
  use(OptionName{"down", "DIRECTION"}, options.down);
  use(OptionName{"drop_smaller", "VOLUME", kFromZero}, options.dropSmaller);
  use(OptionName{"base", "Z"}, options.base);
  use(OptionName{"keep_cavities"}, options.keepCavities);
  use(OptionName{"remesh"}, options.remesh);
  use(OptionName{"tolerance", "LENGTH", kFromZero}, options.tolerance);
  use(OptionName{"triangles", "N", kFromZero}, options.triangles);
  use(OptionName{"cut_plane", "NX NY NZ D"}, options.cutPlane);
  use(OptionName{"measure"}, options.measure);
}

void forEachOption(OptionsOf<SimplifyOptions> auto& options, auto&& use) {
  use(OptionName{"tolerance", "LENGTH", kFromZero}, options.tolerance);
  use(OptionName{"step", "LENGTH", kFromZero}, options.step);
  use(OptionName{"triangles", "N", kFromZero}, options.triangles);
}

void forEachOption(OptionsOf<RenderOptions> auto& options, auto&& use) {
  use(OptionName{"width", "N", kFromOne}, options.width);
  use(OptionName{"height", "N", kFromOne}, options.height);
  use(OptionName{"direction", "DIRECTION"}, options.direction);
  use(OptionName{"up", "DIRECTION"}, options.up);
  use(OptionName{"field_of_view", "DEGREES", kAboveZero}, options.fieldOfView);
  use(OptionName{"cut"}, options.cut);
  use(OptionName{"shell", "LENGTH", kFromZero}, options.shell);
  use(OptionName{"frame", "X0 Y0 Z0 X1 Y1 Z1"}, options.frame);
  use(OptionName{"eye", "X Y Z"}, options.eye);
  use(OptionName{"iso", "LENGTH"}, options.iso);
  use(OptionName{"cut_plane", "NX NY NZ D"}, options.cutPlane);
  use(OptionName{"slice_plane", "NX NY NZ D"}, options.slice);
  use(OptionName{"array", "ARRAY"}, options.array);
  use(OptionName{"range", "LENGTH", kFromZero}, options.range);
}

void forEachOption(OptionsOf<PageOptions> auto& options, auto&& use) {
  use(OptionName{"title", "TEXT"}, options.title);
  use(OptionName{"max_size", "N", kFromOne}, options.maxSize);
  use(OptionName{"array", "ARRAY"}, options.array);
  use(OptionName{"other_title", "TEXT"}, options.otherTitle);
}

/// All options of the library. A name means the same in all of them.
struct AllOptions {
  FieldOptions field = {};
  MachineOptions machine = {};
  GridOptions grid = {};
  SurfaceOptions surface = {};
  QueryOptions query = {};
  SceneOptions scene = {};
  ThicknessOptions thickness = {};
  RegionOptions region = {};
  BandOptions band = {};
  SamplePointsOptions samples = {};
  IsosurfaceOptions isosurface = {};
  RepairOptions repair = {};
  SimplifyOptions simplify = {};
  RenderOptions render = {};
  PageOptions page = {};
};

void forEachOption(OptionsOf<AllOptions> auto& all, auto&& use) {
  forEachOption(all.field, use);
  forEachOption(all.machine, use);
  forEachOption(all.grid, use);
  forEachOption(all.surface, use);
  forEachOption(all.query, use);
  forEachOption(all.scene, use);
  forEachOption(all.thickness, use);
  forEachOption(all.region, use);
  forEachOption(all.band, use);
  forEachOption(all.samples, use);
  forEachOption(all.isosurface, use);
  forEachOption(all.repair, use);
  forEachOption(all.simplify, use);
  forEachOption(all.render, use);
  forEachOption(all.page, use);
}

/// Kinds of values.
enum class OptionKind : uint8_t {
  Flag,
  Whole,
  Number,
  Text,
  Choice,   ///< Text that is the name of an enum's value (raymap/names.h).
  Numbers,  ///< As many numbers as the unit says.
};

/// A value in any form. A flag may be 0 or 1, and a whole number any number that is whole.
using OptionValue = std::variant<bool, int64_t, uint64_t, double, std::string, std::vector<double>>;

/// Sets each option of this name. Throws `Error(Usage)` that names it if there is none, or if the value makes
/// no sense for it.
RAYMAP_API void setOption(AllOptions& options, std::string_view name, const OptionValue& value);

/// Returns the kind of an option. Throws `Error(Usage)` if there is none of this name.
RAYMAP_API OptionKind optionKind(std::string_view name);

/// Text of an option.
struct OptionText {
  std::string_view name;
  std::string_view text;  ///< Names of other options and of values stand in back quotes.
};

/// Returns the texts of all options, by name in alphabetic order.
RAYMAP_API std::span<const OptionText> optionTexts();

}  // namespace raymap
