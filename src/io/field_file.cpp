#include <raymap/atomic_file.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <ostream>

#include "field/field_sampler.h"
#include "io/field/field_formats.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

struct Format {
  std::string_view extension;
  Field (*read)(const fs::path& path);  ///< Null if this build lacks the library for the format.
  void (*write)(std::ostream& out, const Field& field, const NamedArray& array);
};

constexpr std::array kFormats{
    Format{".nrrd", readNrrd, writeNrrd}, Format{".npy", readNpy, writeNpy},
    Format{".npz", readNpz, writeNpz},    Format{".vti", readVti, writeVti},
#ifdef RAYMAP_OPENVDB
    Format{".vdb", readVdb, writeVdb},
#else
    Format{".vdb", nullptr, nullptr},
#endif
};

const Format& formatOf(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  const auto found = std::ranges::find(kFormats, extension, &Format::extension);
  if (found != kFormats.end() && !found->read)
    throw Error(ErrorCode::Unsupported,
                path.string() + ": raymap was built without OpenVDB; build it with RAYMAP_OPENVDB=ON");
  if (found != kFormats.end()) return *found;
  std::string known;
  for (const std::string& each : fieldExtensions()) known.append(" ").append(each);
  throw Error(ErrorCode::Usage,
              path.string() + ": '" + extension + "' is no kind of field; use one of" + known);
}

NamedArray arrayOf(const Field& field, std::string_view name) {
  const auto arrays = arraysOf(field);
  const auto found = std::ranges::find(arrays, name, &NamedArray::name);
  if (found == arrays.end())
    throw Error(ErrorCode::Usage, "the field has no array '" + std::string(name) + "' to write");
  return *found;
}

}  // namespace

std::vector<std::string> fieldExtensions() {
  std::vector<std::string> extensions;
  for (const Format& format : kFormats)
    if (format.read) extensions.emplace_back(format.extension);
  return extensions;
}

Field readField(const fs::path& path) {
  return formatOf(path).read(path);
}

void writeField(const fs::path& path, const Field& field, std::string_view name) {
  const Format& format = formatOf(path);
  const NamedArray array = arrayOf(field, name);
  validateGrid(field.grid);
  for (const NamedArray& each : arraysOf(field))
    if (each.bytes.size() != field.grid.sampleCount() * elementSize(each.type))
      throw Error(ErrorCode::Usage,
                  "the field's array '" + std::string(each.name) + "' does not fit its grid");
  writeAtomically(path, [&](std::ostream& out) { format.write(out, field, array); });
}

}  // namespace raymap
