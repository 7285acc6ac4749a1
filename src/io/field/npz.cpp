// NumPy's .npz: a zip file of .npy files. The writer stores them uncompressed, because distances hardly
// deflate. The reader accepts both.

#include <algorithm>
#include <array>
#include <ostream>
#include <set>

#include "io/field/field_formats.h"
#include "io/field/npy.h"
#include "io/zip/zip_reader.h"
#include "io/zip/zip_writer.h"

namespace raymap {

namespace {

std::string doublesHeader(size_t count) {
  const auto side = static_cast<int64_t>(count);
  return npyHeader({"<f8", true, count == 1 ? std::vector<int64_t>() : std::vector<int64_t>{side}});
}

/// Returns the name of an array, for an entry's without ".npy".
std::string arrayName(std::string_view entry) {
  if (entry.ends_with(".npy")) entry.remove_suffix(4);
  return std::string(entry);
}

std::vector<double> readDoubles(const std::filesystem::path& path, size_t count, const ReadBytes& read) {
  const NpyHeader header = readNpyHeader(path, read);
  const bool isScalar = header.shape.empty() && count == 1;
  if (header.type != "<f8" ||
      !(isScalar || header.shape == std::vector<int64_t>{static_cast<int64_t>(count)}))
    throwInvalid(path, "its origin, spacing, band or surface_bounds is not " + std::to_string(count) +
                           " numbers of type float64");
  std::vector<double> values(count);
  read(values.data(), count * sizeof(double));
  return values;
}

void readEntry(const std::filesystem::path& path, const std::string& name, const StoredBytes& stored,
               const ReadBytes& read, Field& field) {
  if (name == "origin") {
    const auto origin = readDoubles(path, 3, read);
    field.grid.origin = {origin[0], origin[1], origin[2]};
  } else if (name == "spacing") {
    field.grid.spacing = readDoubles(path, 1, read)[0];
  } else if (name == kClampDistance || name == kFormerClampDistance) {
    field.clampDistance = readDoubles(path, 1, read)[0];
  } else if (name == kSurfaceBounds) {
    setSurfaceBounds(path, readDoubles(path, 6, read), field);
  } else {
    const NpyHeader header = readNpyHeader(path, read);
    const glm::ivec3 d = field.grid.dims;
    if (d != glm::ivec3(0) && header.shape != std::vector<int64_t>{d.x, d.y, d.z})
      throwInvalid(path, "the shape of '" + name + "' differs from the others'");
    readNpyArray(path, field, name, header, stored, read);
  }
}

/// Returns whether a field has an array or value of this name. numpy.savez calls an array without a name
/// arr_0.
bool isKnown(std::string_view name) {
  return isFieldArray(name) || name == "origin" || name == "spacing" || name == kClampDistance ||
         name == kFormerClampDistance || name == kSurfaceBounds || name == "arr_0";
}

void writeArrays(std::ostream& out, const Field& field, const NamedArray& array, bool half) {
  ZipWriter zip(out);
  std::array<Buffer<uint16_t>, kArrayNames.size()> halves;
  size_t count = 0;
  for (const NamedArray& each : arraysWith(field, array)) {
    const NamedArray written = half ? halvesOf(each, halves[count++]) : each;
    zip.add(std::string(written.name) + ".npy", npyHeader(field.grid, written.type), written.bytes);
  }
  const std::array origin{field.grid.origin.x, field.grid.origin.y, field.grid.origin.z};
  zip.add("origin.npy", doublesHeader(3), std::as_bytes(std::span(origin)));
  zip.add("spacing.npy", doublesHeader(1), std::as_bytes(std::span(&field.grid.spacing, 1)));
  zip.add(std::string(kClampDistance) + ".npy", doublesHeader(1),
          std::as_bytes(std::span(&field.clampDistance, 1)));
  const std::array<double, 6> box = surfaceBoundsOf(field);
  if (!field.surfaceBounds.isEmpty())
    zip.add(std::string(kSurfaceBounds) + ".npy", doublesHeader(6), std::as_bytes(std::span(box)));
  zip.finish();
}

}  // namespace

Field readNpz(const SourceFile& source, LeftOut& leftOut) {
  const std::filesystem::path& path = source.path();
  const StoredBytes file{InputFile(source).remaining(), true};
  const ZipReader zip(source);
  Field field;
  field.grid.spacing = 1.0;
  // Duplicate names could make the same bytes inflate over and over.
  std::set<std::string> seen;
  for (size_t i = 0; i < zip.entries().size(); ++i) {
    const std::string name = arrayName(zip.entries()[i].name);
    if (!isKnown(name)) {
      leftOut.push_back(name);
      continue;
    }
    if (!seen.insert(name).second) throwInvalid(path, "it has '" + name + "' twice");
    ZipContent content = zip.open(i);
    const ReadBytes read = [&](void* to, size_t count) {
      if (content.read(to, count) < count) throwInvalid(path, "its array '" + name + "' ends early");
    };
    const uint64_t bytes = zip.entries()[i].bytes;
    readEntry(path, name, bytes <= file.most() ? StoredBytes{bytes} : file, read, field);
    char rest = 0;
    content.read(&rest, 1);  // The checksum is compared at the end.
  }
  if (field.grid.dims == glm::ivec3(0)) throwInvalid(path, "it has no array 'distance'");
  checkPlacement(path, field);
  return field;
}

void writeNpz(std::ostream& out, const Field& field, const NamedArray& array) {
  writeArrays(out, field, array, false);
}

void writeHalfNpz(std::ostream& out, const Field& field, const NamedArray& array) {
  writeArrays(out, field, array, true);
}

}  // namespace raymap
