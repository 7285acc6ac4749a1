// Points as a NumPy array: (N, 3), or any shape whose last axis has length 3.

#include "base/memory.h"
#include "io/field/npy.h"
#include "io/points/point_formats.h"

namespace raymap {

namespace {

std::string shapeText(const std::vector<int64_t>& shape) {
  std::string text;
  for (const int64_t side : shape) text += (text.empty() ? "" : " x ") + std::to_string(side);
  return text.empty() ? "no axes" : text;
}

/// Returns the number of points. Must be called before anything is allocated.
size_t checkedPointCount(const std::filesystem::path& path, const NpyHeader& header, ElementType type,
                         uint64_t available) {
  const std::vector<int64_t>& shape = header.shape;
  if (shape == std::vector<int64_t>{0}) return 0;  // What NumPy makes of an empty list.
  if (shape.empty() || shape.back() != 3)
    throwInvalid(path, "its shape is " + shapeText(shape) + "; points need one of N x 3");
  if (header.xFastest && shape.size() > 2)
    throwUnsupported(path, "points of more than two axes in Fortran order; save them in C order");
  uint64_t room = available / (3 * elementSize(type)), count = 1;
  for (size_t axis = 0; axis + 1 < shape.size(); ++axis) {
    if (shape[axis] < 0) throwInvalid(path, "its shape is " + shapeText(shape));
    if (shape[axis] == 0) return 0;
    count *= static_cast<uint64_t>(shape[axis]);
    room /= static_cast<uint64_t>(shape[axis]);
    if (room == 0) throwInvalid(path, "its shape is " + shapeText(shape) + ", more than its bytes can hold");
  }
  if (room == 0) throwInvalid(path, "its shape is 3, more than its bytes can hold");
  const uint64_t bytes = count * sizeof(glm::dvec3), left = memoryLeft();
  if (bytes > left)
    throw Error(ErrorCode::Memory, path.string() + ": its points need " + neededText(bytes) + ", and only " +
                                       limitText(left) + " are available");
  return count;
}

}  // namespace

std::vector<glm::dvec3> readPointNpy(const SourceFile& source) {
  const std::filesystem::path& path = source.path();
  InputFile file(source);
  const ReadBytes read = [&](void* to, size_t count) { file.read(to, count); };
  const NpyHeader header = readNpyHeader(path, read);
  const ArrayLayout layout = layoutOf(path, header);
  std::vector<glm::dvec3> points(checkedPointCount(path, header, layout.type, file.remaining()));
  if (points.empty()) return points;
  if (layout.zFastest) {
    readReals({&points[0].x, 3 * points.size()}, layout, read);
    return points;
  }
  std::vector<double> coordinates(points.size());
  for (int c = 0; c < 3; ++c) {
    readReals(coordinates, layout, read);
    for (size_t i = 0; i < points.size(); ++i) points[i][c] = coordinates[i];
  }
  return points;
}

}  // namespace raymap
