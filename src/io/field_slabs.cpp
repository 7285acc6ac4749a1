#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/field_slabs.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <functional>
#include <future>
#include <memory>
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
  Frame (*frame)(const Field& about, std::span<const NamedArray> arrays);
  bool holdsSeveral = false;  ///< Whether a file has a place for several arrays.
};

constexpr std::array kSlabFormats{SlabFormat{".nrrd", frameNrrd}, SlabFormat{".npy", frameNpy},
                                  SlabFormat{".vti", frameVti, true}};

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

/// Returns the folder of a file.
fs::path folderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Returns the number of the disk that a folder lies on.
dev_t diskOf(const fs::path& folder) {
  struct stat about {};
  return stat(folder.c_str(), &about) == 0 ? about.st_dev : dev_t{};
}

/// Throws `Error(Usage)` if a grid has no samples, or more than a file can hold.
void check(const Grid& grid, int planes) {
  constexpr double kMostSamples = 1e18;
  validateGrid(grid);
  require(double(grid.dims.x) * double(grid.dims.y) * double(grid.dims.z) < kMostSamples,
          "the grid has more samples than a file can hold");
  require(planes > 0, "a slab needs at least one plane");
}

/// Function that writes bytes at their place in a file.
using Write = std::function<void(uint64_t place, std::span<const std::byte> bytes)>;

/// The places of header, samples and end in a file that is written in slabs.
class SlabLayout {
 public:
  SlabLayout(const SlabFile& file, const Field& about, std::string_view asked)
      : path_(file.path), grid_(about.grid) {
    const SlabFormat& format = findSlabFormat(path_, asked);
    std::vector<FieldArray> ordered = file.arrays;
    std::ranges::sort(ordered);
    require(!ordered.empty() && std::ranges::adjacent_find(ordered) == ordered.end(),
            path_.string() + ": a file needs an array, and each only once");
    require(ordered.size() == 1 || format.holdsSeveral,
            path_.string() + ": a " + std::string(format.extension) + " holds one array, not " +
                std::to_string(ordered.size()) + "; write a .vti, or a file for each");
    for (const FieldArray array : ordered) arrays_.push_back(describe(array));
    frame_ = format.frame(about, arrays_);
    for (size_t i = 0; i < arrays_.size(); ++i) {
      places_.push_back(size_ + frame_.before[i].size());
      size_ = places_.back() + arrayBytes(grid_, arrays_[i]);
    }
    size_ += frame_.tail.size();
  }

  const fs::path& path() const { return path_; }
  bool isSeveral() const { return arrays_.size() > 1; }
  uint64_t size() const { return size_; }
  /// Returns the bytes that so many planes take.
  uint64_t bytesOf(uint64_t planes) const {
    uint64_t bytes = 0;
    for (const NamedArray& array : arrays_) bytes += planes * arrayBytes(slabGrid(1), array);
    return bytes;
  }
  /// Returns a text that names the file's content besides its samples.
  std::string content() const {
    std::string text;
    for (size_t i = 0; i < arrays_.size(); ++i) text += frame_.before[i] + std::string(arrays_[i].name);
    return text;
  }

  void writeHead(const Write& write) const {
    for (size_t i = 0; i < arrays_.size(); ++i)
      write(places_[i] - frame_.before[i].size(), std::as_bytes(std::span(frame_.before[i])));
  }
  void writeSlab(const Field& slab, int begin, int end, const Write& write) const {
    const std::vector<NamedArray> given = arraysOf(slab);
    for (size_t i = 0; i < arrays_.size(); ++i) {
      const auto found = std::ranges::find(given, arrays_[i].name, &NamedArray::name);
      require(found != given.end() && found->bytes.size() == arrayBytes(slabGrid(end - begin), arrays_[i]),
              "the planes do not fit the grid");
      write(places_[i] + arrayBytes(slabGrid(begin), arrays_[i]), found->bytes);
    }
  }
  void writeTail(const Write& write) const {
    write(size_ - frame_.tail.size(), std::as_bytes(std::span(frame_.tail)));
  }

 private:
  Grid slabGrid(int planes) const { return {{grid_.dims.x, grid_.dims.y, planes}}; }

  fs::path path_;
  Grid grid_;
  std::vector<NamedArray> arrays_;
  Frame frame_;
  std::vector<uint64_t> places_;  ///< First byte of the samples of each array.
  uint64_t size_ = 0;
};

/// Writes the files of a field slab by slab.
class SlabWriter {
 public:
  SlabWriter(const std::vector<SlabFile>& files, const Field& about, const PlaneSource& planes,
             const SlabOptions& options)
      : about_(about), planes_(planes), options_(options) {
    for (const SlabFile& file : files) files_.emplace_back(file, about, options.format);
  }

  void writeAtOnce() const {
    std::vector<uint64_t> needed;
    for (const SlabLayout& file : files_) needed.push_back(isStream(file.path()) ? 0 : file.size());
    checkSpace(needed, "");
    std::vector<Write> writes;
    openNext(writes);
  }

  /// Goes on from what an earlier call has left, and leaves what it wrote if it fails.
  void goOn() const {
    std::vector<std::unique_ptr<PartialFile>> parts;
    std::vector<Write> writes;
    std::vector<uint64_t> needed;
    for (const SlabLayout& file : files_) {
      PartialFile& part = *parts.emplace_back(std::make_unique<PartialFile>(file.path(), keyOf(file)));
      writes.emplace_back(
          [&part](uint64_t place, std::span<const std::byte> bytes) { part.write(place, bytes); });
      needed.push_back(file.size() - file.bytesOf(part.noted()));
    }
    const uint64_t begin =
        (*std::ranges::min_element(parts, {}, [](const auto& part) { return part->noted(); }))->noted();
    for (size_t i = 0; i < parts.size(); ++i) tellLeft(files_[i], *parts[i], begin);
    checkSpace(needed, ".part");
    try {
      writePlanes(int(begin), writes, [&](int end) {
        for (const auto& part : parts) part->note(uint64_t(end));
      });
    } catch (...) {
      for (size_t i = 0; i < parts.size(); ++i)
        if (parts[i]->noted() > 0)
          warn(files_[i], parts[i]->part().string() + " holds " + countOf(parts[i]->noted()) +
                              "; the same run goes on from there");
      throw;
    }
    for (const auto& part : parts) part->publish();
  }

 private:
  /// Opens the files that are not open yet, one in the other, and writes all.
  void openNext(std::vector<Write>& writes) const {  // NOLINT(misc-no-recursion)
    if (writes.size() == files_.size()) return writePlanes(0, writes, [](int) {});
    const SlabLayout& file = files_[writes.size()];
    writeAtomically(file.path(), [&](std::ostream& out) {  // NOLINT(misc-no-recursion)
      const bool isSeekable = out.tellp() != std::ostream::pos_type(-1);
      require(isSeekable || !file.isSeveral(),
              file.path().string() + ": a pipe takes one array in slabs; write a file, or a pipe for each");
      writes.emplace_back([&out, isSeekable](uint64_t place, std::span<const std::byte> bytes) {
        if (isSeekable) out.seekp(std::streamoff(place));
        writeBytes(out, bytes);
      });
      openNext(writes);
    });
  }

  /// Throws `Error(File)` if a disk has less space than its files need.
  void checkSpace(const std::vector<uint64_t>& needed, const std::string& suffix) const {
    for (size_t i = 0; i < files_.size(); ++i) {
      const fs::path folder = folderOf(files_[i].path());
      uint64_t all = 0;
      for (size_t k = 0; k < files_.size(); ++k)
        if (diskOf(folderOf(files_[k].path())) == diskOf(folder)) all += needed[k];
      std::error_code error;
      const fs::space_info space = fs::space(folder, error);
      if (!error && space.available < all)
        throw Error(ErrorCode::File, files_[i].path().string() + suffix +
                                         (all == needed[i] ? ": the file needs " : ": the files need ") +
                                         neededText(all) + ", but only " + limitText(space.available) +
                                         " are free on its disk; free some space");
    }
  }

  uint64_t keyOf(const SlabLayout& file) const {
    const Grid& grid = about_.grid;
    std::string text = file.content() + options_.key;
    for (const double number :
         {grid.origin.x, grid.origin.y, grid.origin.z, grid.spacing, about_.clampDistance})
      text += ' ' + toText(number);
    return hashOf(text);
  }

  std::string countOf(uint64_t planes) const {
    return std::to_string(planes) + " of " + std::to_string(about_.grid.dims.z) + " planes";
  }

  void warn(const SlabLayout& file, const std::string& message) const {
    if (options_.warn) options_.warn({WarningCode::PartFile, message, {.file = file.path().string()}});
  }

  void tellLeft(const SlabLayout& file, const PartialFile& part, uint64_t begin) const {
    const std::string name = part.part().string();
    switch (part.left()) {
      case PartialFile::Left::Start:
        return warn(file, begin > 0 ? file.path().string() + ": goes on after " + countOf(begin) +
                                          ", which an earlier run has left"
                                    : name + " is made anew, because another file of the run has no part");
      case PartialFile::Left::OtherWork:
        return warn(file,
                    name + " is of another mesh, grid or options, or of another version; it is made anew");
      case PartialFile::Left::TooLittle:
        return warn(file, name + " is shorter than the earlier run noted; it is made anew");
      case PartialFile::Left::Nothing:
        return;
    }
  }

  /// Writes all but the planes before `begin`. Calls `done(end)` after each slab. While a slab is made, a
  /// thread writes the one before.
  template <class Done>
  void writePlanes(int begin, const std::vector<Write>& writes, Done&& done) const {
    for (size_t i = 0; i < files_.size(); ++i) files_[i].writeHead(writes[i]);
    const int planes = about_.grid.dims.z;
    std::future<void> writing;  // Of the slab before. It is waited for, even after an error.
    for (int z = begin, end = 0; z < planes; z = end) {
      end = z + std::min(options_.planes, planes - z);
      Field slab = planes_(z, end);
      if (writing.valid()) writing.get();
      writing = std::async(std::launch::async, [this, &writes, &done, z, end, made = std::move(slab)] {
        for (size_t i = 0; i < files_.size(); ++i) files_[i].writeSlab(made, z, end, writes[i]);
        done(end);
      });
    }
    if (writing.valid()) writing.get();
    for (size_t i = 0; i < files_.size(); ++i) files_[i].writeTail(writes[i]);
  }

  const Field& about_;
  const PlaneSource& planes_;
  const SlabOptions& options_;
  std::vector<SlabLayout> files_;
};

}  // namespace

void writeFieldInSlabs(const std::vector<SlabFile>& files, const Field& about, const PlaneSource& planes,
                       const SlabOptions& options) {
  check(about.grid, options.planes);
  require(!files.empty(), "a field needs a file to be written into");
  const SlabWriter writer(files, about, planes, options);
  const auto isStreamed = [](const SlabFile& file) { return isStream(file.path); };
  if (options.key.empty() || std::ranges::any_of(files, isStreamed))
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
