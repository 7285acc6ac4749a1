// NumPy's .npz: a zip file of .npy files. The writer stores them uncompressed, because distances hardly
// deflate. The reader accepts both.

#include <minizip/unzip.h>
#include <minizip/zip.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <ostream>
#include <set>

#include "io/field/field_formats.h"
#include "io/field/npy.h"

namespace raymap {

namespace {

/// Lets minizip write to a stream. Exceptions must not cross its C code, so `problem` keeps the first one.
struct ZipStream {
  std::ostream& out;
  std::exception_ptr problem;

  template <class Work>
  auto guarded(Work&& work, decltype(work()) otherwise) noexcept {
    try {
      return work();
    } catch (...) {
      if (!problem) problem = std::current_exception();
      return otherwise;
    }
  }
  static ZipStream& of(voidpf opaque) { return *static_cast<ZipStream*>(opaque); }
};

uLong writeStream(voidpf opaque, voidpf, const void* data, uLong count) {
  ZipStream& zip = ZipStream::of(opaque);
  return zip.guarded(
      [&] {
        zip.out.write(static_cast<const char*>(data), static_cast<std::streamsize>(count));
        return count;
      },
      uLong{0});
}
ZPOS64_T tellStream(voidpf opaque, voidpf) {
  ZipStream& zip = ZipStream::of(opaque);
  return zip.guarded([&] { return static_cast<ZPOS64_T>(zip.out.tellp()); }, ZPOS64_T(-1));
}
long seekStream(voidpf opaque, voidpf, ZPOS64_T offset, int origin) {
  ZipStream& zip = ZipStream::of(opaque);
  const auto from = origin == ZLIB_FILEFUNC_SEEK_SET   ? std::ios_base::beg
                    : origin == ZLIB_FILEFUNC_SEEK_CUR ? std::ios_base::cur
                                                       : std::ios_base::end;
  return zip.guarded(
      [&] {
        zip.out.seekp(static_cast<std::streamoff>(offset), from);
        return 0L;
      },
      -1L);
}

zlib_filefunc64_def streamFunctions(ZipStream& zip) {
  zlib_filefunc64_def functions{};
  functions.opaque = &zip;
  functions.zopen64_file = [](voidpf opaque, const void*, int) { return opaque; };
  functions.zread_file = [](voidpf, voidpf, void*, uLong) { return uLong{0}; };
  functions.zwrite_file = writeStream;
  functions.ztell64_file = tellStream;
  functions.zseek64_file = seekStream;
  functions.zclose_file = [](voidpf, voidpf) { return 0; };
  functions.zerror_file = [](voidpf, voidpf) { return 0; };
  return functions;
}

class ZipWriter {
 public:
  explicit ZipWriter(std::ostream& out) : stream_{out, nullptr} {
    zlib_filefunc64_def functions = streamFunctions(stream_);
    zip_ = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &functions);
    check(zip_ != nullptr);
  }
  ~ZipWriter() {
    if (zip_) zipClose(zip_, nullptr);
  }
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  void add(const std::string& name, const std::string& header, std::span<const std::byte> bytes) {
    zip_fileinfo info{};
    info.dosDate = (1U << 21) | (1U << 16);  // 1 January 1980: equal fields make equal files.
    check(zipOpenNewFileInZip64(zip_, (name + ".npy").c_str(), &info, nullptr, 0, nullptr, 0, nullptr, 0, 0,
                                1) == ZIP_OK);
    check(zipWriteInFileInZip(zip_, header.data(), static_cast<unsigned>(header.size())) == ZIP_OK);
    constexpr size_t kPiece = size_t{1} << 24;  // minizip counts in 32 bits.
    for (size_t begin = 0; begin < bytes.size(); begin += kPiece) {
      const auto count = static_cast<unsigned>(std::min(kPiece, bytes.size() - begin));
      check(zipWriteInFileInZip(zip_, bytes.data() + begin, count) == ZIP_OK);
    }
    check(zipCloseFileInZip(zip_) == ZIP_OK);
  }
  void finish() { check(zipClose(std::exchange(zip_, nullptr), nullptr) == ZIP_OK); }

 private:
  void check(bool good) const {
    if (stream_.problem) std::rethrow_exception(stream_.problem);
    if (!good) throw Error(ErrorCode::File, "cannot write a .npz here: it needs a regular file");
  }

  ZipStream stream_;
  zipFile zip_ = nullptr;
};

std::string doublesHeader(size_t count) {
  return npyHeader("<f8", count == 1 ? "" : std::to_string(count) + ",");
}

using UnzipFile = std::unique_ptr<void, decltype(&unzClose)>;

/// The .npy file at minizip's current position.
class Entry {
 public:
  Entry(const std::filesystem::path& path, unzFile zip, uint64_t fileBytes) : path_(path), zip_(zip) {
    std::array<char, 256> name{};
    unz_file_info64 info{};
    if (unzGetCurrentFileInfo64(zip, &info, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) != UNZ_OK)
      throwInvalid(path, "its zip directory is damaged");
    name_ = name.data();
    if (name_.ends_with(".npy")) name_.resize(name_.size() - 4);
    available_ = std::min<uint64_t>(info.uncompressed_size, inflatedBound(fileBytes));
    if ((info.flag & 1) != 0) throwUnsupported(path, "it is encrypted");
  }
  const std::string& name() const { return name_; }
  uint64_t available() const { return available_; }

  void open() {
    if (unzOpenCurrentFile(zip_) != UNZ_OK) throwInvalid(path_, "its entry '" + name_ + "' is damaged");
  }
  void read(void* to, size_t count) {
    constexpr size_t kPiece = size_t{1} << 24;
    for (auto* at = static_cast<char*>(to); count > 0;) {
      const int got = unzReadCurrentFile(zip_, at, static_cast<unsigned>(std::min(count, kPiece)));
      if (got <= 0) throwInvalid(path_, "its entry '" + name_ + "' is damaged or ends early");
      at += got;
      count -= static_cast<size_t>(got);
    }
  }
  void close() {
    if (unzCloseCurrentFile(zip_) != UNZ_OK) throwInvalid(path_, "the checksum of '" + name_ + "' is wrong");
  }

 private:
  const std::filesystem::path& path_;
  unzFile zip_;
  std::string name_;
  uint64_t available_ = 0;
};

std::vector<double> readDoubles(const std::filesystem::path& path, size_t count, const ReadBytes& read) {
  const NpyHeader header = readNpyHeader(path, read);
  const bool isScalar = header.shape.empty() && count == 1;
  if (header.type != "<f8" ||
      !(isScalar || header.shape == std::vector<int64_t>{static_cast<int64_t>(count)}))
    throwInvalid(path,
                 "its origin, spacing or band is not " + std::to_string(count) + " numbers of type float64");
  std::vector<double> values(count);
  read(values.data(), count * sizeof(double));
  return values;
}

void readEntry(const std::filesystem::path& path, Entry& entry, Field& field) {
  const ReadBytes read = [&](void* to, size_t count) { entry.read(to, count); };
  const std::string& name = entry.name();
  if (name == "origin") {
    const auto origin = readDoubles(path, 3, read);
    field.grid.origin = {origin[0], origin[1], origin[2]};
  } else if (name == "spacing") {
    field.grid.spacing = readDoubles(path, 1, read)[0];
  } else if (name == "band") {
    field.band = readDoubles(path, 1, read)[0];
  } else {
    const NpyHeader header = readNpyHeader(path, read);
    const glm::ivec3 d = field.grid.dims;
    if (d != glm::ivec3(0) && header.shape != std::vector<int64_t>{d.x, d.y, d.z})
      throwInvalid(path, "the shape of '" + name + "' differs from the others'");
    readNpyArray(path, field, name, header, entry.available(), read);
  }
}

/// Returns whether a field has an array or value of this name. numpy.savez calls an array without a name
/// arr_0.
bool isKnown(std::string_view name) {
  constexpr std::array kNames{"distance", "winding", "confidence", "triangle",
                              "origin",   "spacing", "band",       "arr_0"};
  return std::ranges::find(kNames, name) != kNames.end();
}

}  // namespace

Field readNpz(const std::filesystem::path& path) {
  const uint64_t fileBytes = InputFile(path).remaining();
  const UnzipFile zip(unzOpen64(path.c_str()), &unzClose);
  if (!zip) throwInvalid(path, "is no whole zip file");
  Field field;
  field.grid.spacing = 1.0;
  // Duplicate names could make the same bytes inflate over and over.
  std::set<std::string> seen;
  int status = unzGoToFirstFile(zip.get());
  for (; status == UNZ_OK; status = unzGoToNextFile(zip.get())) {
    Entry entry(path, zip.get(), fileBytes);
    if (!isKnown(entry.name())) continue;
    if (!seen.insert(entry.name()).second) throwInvalid(path, "it has '" + entry.name() + "' twice");
    entry.open();
    readEntry(path, entry, field);
    entry.close();
  }
  if (status != UNZ_END_OF_LIST_OF_FILE) throwInvalid(path, "its zip directory is damaged");
  if (field.grid.dims == glm::ivec3(0)) throwInvalid(path, "it has no array 'distance'");
  checkPlacement(path, field);
  return field;
}

void writeNpz(std::ostream& out, const Field& field, const NamedArray& array) {
  ZipWriter zip(out);
  // The distance is written with all other arrays, any other array alone.
  for (const NamedArray& each : arraysOf(field))
    if (array.name == "distance" || each.name == array.name)
      zip.add(std::string(each.name), npyHeader(field.grid, each.type), each.bytes);
  const std::array origin{field.grid.origin.x, field.grid.origin.y, field.grid.origin.z};
  zip.add("origin", doublesHeader(3), std::as_bytes(std::span(origin)));
  zip.add("spacing", doublesHeader(1), std::as_bytes(std::span(&field.grid.spacing, 1)));
  zip.add("band", doublesHeader(1), std::as_bytes(std::span(&field.band, 1)));
  zip.finish();
}

}  // namespace raymap
