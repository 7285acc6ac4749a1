#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/field_slabs.h>

#include <algorithm>
#include <array>
#include <ostream>

#include "base/hash.h"
#include "base/memory.h"
#include "base/partial_file.h"
#include "base/require.h"
#include "base/source_file.h"
#include "field/field_sampler.h"
#include "io/field/field_formats.h"
#include "io/file_format.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

struct SlabFormat {
  std::string_view extension;
  Frame (*frame)(const Field& about, const NamedArray& array);
};

constexpr std::array kSlabFormats{SlabFormat{".nrrd", frameNrrd}, SlabFormat{".npy", frameNpy},
                                  SlabFormat{".vti", frameVti}};

const SlabFormat& findSlabFormat(const fs::path& path, std::string_view asked) {
  const auto found =
      std::ranges::find(kSlabFormats, formatOf(path, asked, slabExtensions()), &SlabFormat::extension);
  if (found == kSlabFormats.end())
    throw Error(ErrorCode::Usage, path.string() + ": '" + path.extension().string() +
                                      "' is not a format for slabs; use one of " + listOf(slabExtensions()));
  return *found;
}

/// Returns whether a path is a pipe, a device or a descriptor, which are written in place.
bool isStream(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return namedDescriptor(path) >= 0 || (fs::exists(status) && !fs::is_regular_file(status));
}

/// Throws `Error(File)` if the disk of a file has less space than this.
void checkSpace(const fs::path& path, uint64_t needed) {
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const fs::space_info space = fs::space(fs::exists(path, error) ? path : folder, error);
  if (!error && space.available < needed)
    throw Error(ErrorCode::File, path.string() + ": the file needs " + neededText(needed) + ", but only " +
                                     limitText(space.available) + " are free on its disk; free some space");
}

/// Throws `Error(Usage)` if a grid has no samples, or more than a file can hold.
void check(const Grid& grid, int thickness) {
  constexpr double kMostSamples = 1e18;
  validateGrid(grid);
  require(double(grid.dims.x) * double(grid.dims.y) * double(grid.dims.z) < kMostSamples,
          "the grid has more samples than a file can hold");
  require(thickness > 0, "a slab needs at least one plane");
}

/// Writes a field slab by slab.
class SlabWriter {
 public:
  SlabWriter(const fs::path& path, const Field& about, const PlaneSource& planes, const SlabOptions& options)
      : path_(path),
        about_(about),
        planes_(planes),
        options_(options),
        array_(describe(options.array)),
        frame_(findSlabFormat(path, options.format).frame(about, array_)) {}

  void writeAtOnce() const {
    if (!isStream(path_)) checkSpace(path_, size());
    writeAtomically(path_, [&](std::ostream& out) {
      out << frame_.head;
      writePlanes(0, [&](std::span<const std::byte> bytes) { writeBytes(out, bytes); });
      out << frame_.tail;
    });
  }

  /// Goes on from what an earlier call has left, and leaves what it wrote if it fails.
  void goOn() const {
    PartialFile file(path_, key());
    tellLeft(file);
    checkSpace(file.part(), size() - file.noted());
    if (file.noted() == 0) file.write(std::as_bytes(std::span(frame_.head)));
    try {
      writePlanes(planesIn(file.noted()), [&](std::span<const std::byte> bytes) {
        file.write(bytes);
        file.note();
      });
    } catch (...) {
      if (file.noted() > 0)
        warn(file.part().string() + " holds " + std::to_string(planesIn(file.noted())) + " of " +
             std::to_string(about_.grid.dims.z) + " planes; the same run goes on from there");
      throw;
    }
    file.write(std::as_bytes(std::span(frame_.tail)));
    file.publish();
  }

 private:
  uint64_t size() const { return frame_.head.size() + arrayBytes(about_.grid, array_) + frame_.tail.size(); }

  uint64_t key() const {
    const Grid& grid = about_.grid;
    std::string text = frame_.head + options_.key;
    for (const double number :
         {grid.origin.x, grid.origin.y, grid.origin.z, grid.spacing, about_.clampDistance})
      text += ' ' + toText(number);
    return hashOf(text);
  }

  int planesIn(uint64_t bytes) const {
    const uint64_t plane = arrayBytes(about_.grid, array_) / uint64_t(about_.grid.dims.z);
    return bytes < frame_.head.size() ? 0 : int((bytes - frame_.head.size()) / plane);
  }

  void warn(const std::string& message) const {
    if (options_.warn) options_.warn({WarningCode::PartFile, message, {.file = path_.string()}});
  }

  void tellLeft(const PartialFile& file) const {
    const std::string name = file.part().string();
    switch (file.left()) {
      case PartialFile::Left::Start:
        return warn(path_.string() + ": goes on after " + std::to_string(planesIn(file.noted())) + " of " +
                    std::to_string(about_.grid.dims.z) + " planes, which an earlier run has left");
      case PartialFile::Left::OtherWork:
        return warn(name + " is of another mesh, grid or options, or of another version; it is made anew");
      case PartialFile::Left::TooLittle:
        return warn(name + " is shorter than the earlier run noted; it is made anew");
      case PartialFile::Left::Nothing:
        return;
    }
  }

  template <class Write>
  void writePlanes(int begin, Write&& write) const {
    const Grid& grid = about_.grid;
    for (int z = begin, end = 0; z < grid.dims.z; z = end) {
      end = z + std::min(options_.thickness, grid.dims.z - z);
      const Field slab = planes_(z, end);
      const std::vector<NamedArray> arrays = arraysOf(slab);
      const auto found = std::ranges::find(arrays, array_.name, &NamedArray::name);
      require(found != arrays.end() &&
                  found->bytes.size() == arrayBytes({{grid.dims.x, grid.dims.y, end - z}}, array_),
              "the planes do not fit the grid");
      write(found->bytes);
    }
  }

  const fs::path& path_;
  const Field& about_;
  const PlaneSource& planes_;
  const SlabOptions& options_;
  NamedArray array_;
  Frame frame_;
};

}  // namespace

void writeFieldInSlabs(const fs::path& path, const Field& about, const PlaneSource& planes,
                       const SlabOptions& options) {
  check(about.grid, options.thickness);
  const SlabWriter writer(path, about, planes, options);
  if (options.key.empty() || isStream(path))
    writer.writeAtOnce();
  else
    writer.goOn();
}

std::vector<std::string> slabExtensions() {
  std::vector<std::string> extensions;
  for (const SlabFormat& format : kSlabFormats) extensions.emplace_back(format.extension);
  return extensions;
}

}  // namespace raymap
