#include <raymap/atomic_file.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>
#include <ostream>
#include <span>

#include "base/text.h"
#include "field/field_sampler.h"
#include "io/field/field_formats.h"
#include "io/file_format.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

struct Format {
  std::string_view extension;
  Field (*read)(const SourceFile& source,
                LeftOut& leftOut);  ///< Null for a format that has `readChosen`.
  void (*write)(std::ostream& out, const Field& field, const NamedArray& array);
  bool goesBack = false;  ///< Whether the writer goes back in its stream.
  // Reader and writers of the formats that have grids with names and narrow bands.
  Field (*readChosen)(const SourceFile& source, LeftOut& leftOut, const GridChoice& grid) = nullptr;
  const VdbWriter& (*writer)() = nullptr;
  /// Writer with numbers of 16 bits; null for a format without them, or with `writer`.
  void (*writeHalf)(std::ostream& out, const Field& field, const NamedArray& array) = nullptr;

  /// Returns whether this build has the library for the format.
  bool isKnown() const { return read || readChosen; }
};

constexpr std::array kFormats{
    Format{".nrrd", readNrrd, writeNrrd},
    Format{.extension = ".npy", .read = readNpy, .write = writeNpy, .writeHalf = writeHalfNpy},
    Format{
        .extension = ".npz", .read = readNpz, .write = writeNpz, .goesBack = true, .writeHalf = writeHalfNpz},
    Format{".vti", readVti, writeVti},
#ifdef RAYMAP_OPENVDB
    Format{".vdb", nullptr, nullptr, true, readVdb, vdbWriter},
    Format{".nvdb", nullptr, nullptr, false, readNvdb, nvdbWriter},
#else
    Format{".vdb", nullptr, nullptr},
    Format{".nvdb", nullptr, nullptr},
#endif
};

const Format& findFormat(const fs::path& path, std::string_view extension) {
  const auto found = std::ranges::find(kFormats, extension, &Format::extension);
  if (found != kFormats.end() && !found->isKnown())
    throw Error(ErrorCode::Unsupported,
                path.string() + ": raymap was built without OpenVDB; build it with RAYMAP_OPENVDB=ON");
  if (found != kFormats.end()) return *found;
  throw Error(ErrorCode::Usage, path.string() + ": '" + path.extension().string() +
                                    "' is not a format for fields; use one of " + listOf(fieldExtensions()));
}

NamedArray arrayOf(const Field& field, FieldArray asked) {
  const std::string_view name = kArrayNames[size_t(asked)];
  const auto arrays = arraysOf(field);
  const auto found = std::ranges::find(arrays, name, &NamedArray::name);
  if (found == arrays.end())
    throw Error(ErrorCode::Usage, "the field has no array '" + std::string(name) + "' to write");
  return *found;
}

void checkLength(const fs::path& path, const Format& format, const std::string& gridName) {
  constexpr size_t kMost = 255;  // NanoVDB's.
  if (format.extension == ".nvdb" && gridName.size() > kMost)
    throw Error(ErrorCode::Usage, path.string() + ": the name of a grid has " +
                                      std::to_string(gridName.size()) +
                                      " bytes, and a .nvdb holds 255; choose a shorter one");
}

/// Returns whether a format has a type for numbers of 16 bits.
bool hasHalf(const Format& format) {
  return format.writer || format.writeHalf;
}

/// Throws `Error(Usage)` unless the format has a place for what the options ask for.
void checkFormat(const fs::path& path, const Format& format, const FieldWriteOptions& options) {
  if (format.writer) format.writer();  // Before a field is made for it.
  if (!format.writer && !options.gridName.empty())
    throw Error(ErrorCode::Usage, path.string() + ": only a .vdb or .nvdb has a grid's name; leave it out");
  if (options.half && !hasHalf(format))
    throw Error(ErrorCode::Usage, path.string() + ": a " + std::string(format.extension) +
                                      " has no type for numbers of 16 bits; write a .npy, .npz, .vdb or "
                                      ".nvdb, or use 32 bits");
  const std::string name(options.gridName);
  checkLength(path, format, name);
  if (std::ranges::any_of(kArrayNames, [&](std::string_view other) {
        return other == name && other != kArrayNames[size_t(options.array)];
      }))
    throw Error(ErrorCode::Usage, "'" + name + "' is the name of another array; choose another for the grid");
}

/// Throws `Error(Usage)` unless 16 bits hold the numbers of a field as the format stores them. `farthest` is
/// its largest distance.
void checkHalf(const fs::path& path, const Format& format, const Field& field, double farthest) {
  if (format.extension == ".nvdb") {
    constexpr double kMost = 1e38;  // The range of a leaf must be a float.
    const auto isHeld = [](float value) { return std::abs(double(value)) <= kMost; };
    if (farthest > kMost || !std::ranges::all_of(field.distance, isHeld) ||
        !std::ranges::all_of(field.winding, isHeld) || !std::ranges::all_of(field.confidence, isHeld))
      throw Error(ErrorCode::Usage,
                  path.string() + ": a .nvdb holds finite numbers of up to 1e38 in 16 bits; use 32 bits");
    return;
  }
  // In a .vdb the largest half float but one: the background lies above all distances.
  const double mostHalf = format.writeHalf ? 65504.0 : 65472.0;
  constexpr double kLeastSpacing = 1e-4;
  const double spacing = field.grid.spacing;
  if (farthest > mostHalf || spacing < kLeastSpacing)
    throw Error(ErrorCode::Usage, path.string() + ": numbers of 16 bits reach from " +
                                      numberText(kLeastSpacing) + " to " + numberText(mostHalf) +
                                      ", and here are samples " + numberText(spacing) +
                                      " apart and distances of " + numberText(farthest) +
                                      "; write a .nvdb, or use another unit or 32 bits");
}

/// Throws `Error(Usage)` unless the format has what the options ask for. `farthest` is the largest distance.
void checkStorage(const fs::path& path, const Format& format, const Field& field, double farthest,
                  const FieldWriteOptions& options) {
  checkFormat(path, format, options);
  if (options.half) checkHalf(path, format, field, farthest);
}

/// Returns the number of samples above which a level set becomes a narrow band.
uint64_t mostDense(LevelSet levelSet) {
  constexpr uint64_t kManySamples = uint64_t{1} << 24;
  if (levelSet == LevelSet::Narrow) return 0;
  return levelSet == LevelSet::Dense ? UINT64_MAX : kManySamples;
}

/// Returns "'a', 'b' and 3 more".
std::string listed(const LeftOut& names) {
  constexpr size_t kMost = 8;
  std::string text;
  for (size_t i = 0; i < std::min(names.size(), kMost); ++i)
    text += (i == 0 ? "'" : i + 1 == names.size() ? " and '" : ", '") + names[i] + "'";
  return names.size() > kMost ? text + " and " + std::to_string(names.size() - kMost) + " more" : text;
}

}  // namespace

std::vector<std::string> fieldExtensions() {
  std::vector<std::string> extensions;
  for (const Format& format : kFormats)
    if (format.isKnown()) extensions.emplace_back(format.extension);
  return extensions;
}

void checkFieldFile(const fs::path& path, const FieldWriteOptions& options) {
  checkFormat(path, findFormat(path, formatOf(path, options.format, fieldExtensions())), options);
}

bool canHalve(const fs::path& path, std::string_view given) {
  return hasHalf(findFormat(path, formatOf(path, given, fieldExtensions())));
}

Formats knownFieldFormats() {
  Formats formats;
  for (const Format& format : kFormats) formats.emplace_back(format.extension);
  return formats;
}

Field readFieldAs(const SourceFile& source, std::string_view format, const ReadOptions& options) {
  const std::string path = source.path().string();
  if (format.empty() && !formatOf(source, {}, knownMeshFormats()).empty())
    throw Error(ErrorCode::Usage, path + ": it is a mesh, and a field is needed; generate one of it");
  const Format& found = findFormat(source.path(), format);
  if (!found.readChosen && !options.gridName.empty())
    throw Error(ErrorCode::Usage, path + ": only a .vdb or .nvdb has grids with names; leave the name out");
  if (!found.readChosen && options.levelSet == LevelSet::Narrow)
    throw Error(ErrorCode::Usage, path + ": a " + std::string(found.extension) +
                                      " holds no narrow bands; read it as a field, and make a band of it");
  LeftOut leftOut;
  Field field = found.readChosen
                    ? found.readChosen(source, leftOut, {options.gridName, mostDense(options.levelSet)})
                    : found.read(source, leftOut);
  std::erase_if(leftOut, [&](const std::string& name) {
    return std::ranges::find(options.alsoRead, name) != options.alsoRead.end();
  });
  if (options.warn && !leftOut.empty() && options.gridName.empty())
    options.warn({WarningCode::FileContent,
                  path + ": it also holds " + listed(leftOut) + ", which a field has no place for",
                  {.file = path}});
  return field;
}

Field readField(const fs::path& path, const ReadOptions& options) {
  const SourceFile source(path);
  return readFieldAs(source, formatOf(source, options.format, knownFieldFormats()), options);
}

namespace {

/// Throws `Error(Usage)` unless a file can hold a band with these options.
void checkBand(const fs::path& path, const Format& format, const Field& band,
               const FieldWriteOptions& options) {
  validateField(band);
  const auto [outside, inside] = std::pair(band.narrow->outside, band.narrow->inside);
  const double farthest = std::max(outside, std::isfinite(inside) ? inside : 0.0);
  checkStorage(path, format, band, std::max(farthest, double(largestMagnitude(band.distance))), options);
}

const Format& bandFormat(const fs::path& path, const FieldWriteOptions& options) {
  const Format& format = findFormat(path, formatOf(path, options.format, fieldExtensions()));
  if (!format.writer)
    throw Error(ErrorCode::Usage, path.string() + ": a " + std::string(format.extension) +
                                      " holds no narrow bands; write a .vdb or .nvdb, or a whole field");
  if (options.array != FieldArray::Distance)
    throw Error(ErrorCode::Usage, "the file of a narrow band holds the distance and all other arrays");
  return format;
}

/// Returns the names of all grids of one of several bands.
std::vector<std::string> gridNames(const NamedField& each) {
  std::vector<std::string> names;
  for (const FieldArray array : each.field->arrays())
    names.push_back(array == FieldArray::Distance ? std::string(each.name)
                                                  : arrayGridName(each.name, kArrayNames[size_t(array)]));
  return names;
}

void writeAllBands(const fs::path& path, const Format& format, std::span<const NamedField> bands,
                   const FieldWriteOptions& options) {
  writeAtomically(path, [&](std::ostream& out) {
    writeSeekable(out, [&](std::ostream& seekable) {
      format.writer().bands(seekable, bands, {options.gridName, options.half});
    });
  });
}

}  // namespace

void writeFields(const fs::path& path, std::span<const NamedField> bands, const FieldWriteOptions& options) {
  const Format& format = bandFormat(path, options);
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorCode::Usage, path.string() + ": " + what);
  };
  require(!bands.empty(), "it must hold at least one narrow band");
  require(options.gridName.empty(), "each narrow band has a name of its own; leave the other one out");
  std::vector<std::string> names;
  for (const NamedField& each : bands) {
    const std::string name(each.name);
    require(!name.empty(), "each of several narrow bands needs a name");
    FieldWriteOptions one = options;
    one.gridName = each.name;
    requireNarrow(*each.field);
    checkBand(path, format, *each.field, one);
    for (const std::string& grid : gridNames(each)) {
      require(std::ranges::find(names, grid) == names.end(),
              "two grids have the name '" + grid + "'; choose another for one of the bands");
      checkLength(path, format, grid);
      names.push_back(grid);
    }
  }
  writeAllBands(path, format, bands, options);
}

void writeField(const fs::path& path, const Field& field, const FieldWriteOptions& options) {
  if (field.narrow) {
    const Format& format = bandFormat(path, options);
    checkBand(path, format, field, options);
    return writeAllBands(path, format, std::array{NamedField{options.gridName, &field}}, options);
  }
  const Format& format = findFormat(path, formatOf(path, options.format, fieldExtensions()));
  const NamedArray array = arrayOf(field, options.array);
  validateGrid(field.grid);
  for (const NamedArray& each : arraysOf(field))
    if (each.bytes.size() != field.grid.sampleCount() * elementSize(each.type))
      throw Error(ErrorCode::Usage,
                  "the field's array '" + std::string(each.name) + "' does not fit its grid");
  checkStorage(path, format, field, largestMagnitude(field.distance), options);
  const auto write = [&](std::ostream& out) {
    if (format.writer)
      format.writer().field(out, field, array, {options.gridName, options.half});
    else
      (options.half ? format.writeHalf : format.write)(out, field, array);
  };
  writeAtomically(path, [&](std::ostream& out) { format.goesBack ? writeSeekable(out, write) : write(out); });
}

}  // namespace raymap
