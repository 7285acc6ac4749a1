// NumPy's .npz: a zip file of .npy files. The writer stores them uncompressed, because distances hardly
// deflate. The reader accepts both.

#include <minizip/unzip.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <set>

#include "io/field/field_formats.h"
#include "io/field/npy.h"
#include "io/field/zip_writer.h"

namespace raymap {

namespace {

std::string doublesHeader(size_t count) {
  const auto side = static_cast<int64_t>(count);
  return npyHeader({"<f8", true, count == 1 ? std::vector<int64_t>() : std::vector<int64_t>{side}});
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
  return isFieldArray(name) || name == "origin" || name == "spacing" || name == "band" || name == "arr_0";
}

}  // namespace

Field readNpz(const SourceFile& source) {
  const std::filesystem::path& path = source.path();
  const uint64_t fileBytes = InputFile(source).remaining();
  const UnzipFile zip(unzOpen64(source.place().c_str()), &unzClose);
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
  for (const NamedArray& each : arraysWith(field, array))
    zip.add(std::string(each.name) + ".npy", npyHeader(field.grid, each.type), each.bytes);
  const std::array origin{field.grid.origin.x, field.grid.origin.y, field.grid.origin.z};
  zip.add("origin.npy", doublesHeader(3), std::as_bytes(std::span(origin)));
  zip.add("spacing.npy", doublesHeader(1), std::as_bytes(std::span(&field.grid.spacing, 1)));
  zip.add("band.npy", doublesHeader(1), std::as_bytes(std::span(&field.band, 1)));
  zip.finish();
}

}  // namespace raymap
