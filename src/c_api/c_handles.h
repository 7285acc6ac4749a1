#pragma once

// The types behind the handles of raymap/c.h, and the way errors leave it.

#include <raymap/c.h>
#include <raymap/devices.h>
#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/picture.h>
#include <raymap/repair.h>
#include <raymap/scene.h>
#include <raymap/surface.h>
#include <raymap/verdict.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

struct raymap_options {
  raymap::FieldOptions field;
  raymap::MachineOptions machine;
  bool isCompact = false;  ///< Whether surfaces are.
};

struct raymap_mesh {
  raymap::Mesh owned;             ///< Empty if the caller's arrays are viewed.
  std::vector<glm::dvec3> exact;  ///< Positions of a file that `owned` would round.
  raymap::MeshView view;  ///< View of `owned`, with `exact` if that has any, or of the caller's arrays.
};

struct raymap_field {
  raymap::Field field;
  raymap::Stats stats;
};

struct raymap_sparse_field {
  raymap::SparseField field;
};

struct raymap_generator {
  raymap::Generator generator;
};

struct raymap_surface {
  explicit raymap_surface(raymap::Surface made) : surface(std::move(made)) {}

  raymap::Surface surface;
};

struct raymap_scene {
  raymap::Scene scene;
};

struct raymap_inspection {
  raymap::Diagnostics found;
  raymap::SelfIntersections crossings;
  raymap::Verdict verdict;
};

struct raymap_repaired {
  raymap_mesh mesh;
  raymap::RepairReport report;
};

struct raymap_picture {
  raymap::Picture picture;
};

struct raymap_devices {
  raymap::DeviceList list;
};

namespace raymap::c {

/// Remembers the error for this thread. Returns its code.
raymap_result fail(raymap_result code, const char* message) noexcept;

/// Returns the result of an error.
constexpr raymap_result resultOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::Usage:
      return RAYMAP_ERROR_USAGE;
    case ErrorCode::Input:
      return RAYMAP_ERROR_INPUT;
    case ErrorCode::File:
      return RAYMAP_ERROR_FILE;
    case ErrorCode::Memory:
      return RAYMAP_ERROR_MEMORY;
    case ErrorCode::Cancelled:
      return RAYMAP_ERROR_CANCELLED;
    case ErrorCode::Unsupported:
      return RAYMAP_ERROR_UNSUPPORTED;
    case ErrorCode::DeviceLost:
      return RAYMAP_ERROR_DEVICE_LOST;
    case ErrorCode::DeviceMemory:
      return RAYMAP_ERROR_DEVICE_MEMORY;
  }
  return RAYMAP_ERROR_BUG;
}

/// Runs `work`. Returns the code of what it throws, or RAYMAP_OK.
template <class Work>
raymap_result guard(Work&& work) noexcept {
  try {
    work();
    return RAYMAP_OK;
  } catch (const Error& error) {
    return fail(resultOf(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return fail(RAYMAP_ERROR_MEMORY, "out of memory; use a lower resolution");
  } catch (const std::exception& error) {
    return fail(RAYMAP_ERROR_BUG, error.what());
  } catch (...) {
    return fail(RAYMAP_ERROR_BUG, "an unknown exception");
  }
}

/// Returns the handle that `make` makes, released from its unique_ptr; null if it throws.
template <class Make>
auto create(Make&& make) noexcept {
  decltype(make().release()) handle = nullptr;
  guard([&] { handle = make().release(); });
  return handle;
}

/// Returns the object behind a pointer. Throws `Error(Usage)` that names it if the pointer is null.
template <class T>
T& need(T* pointer, const char* name) {
  if (!pointer) throw Error(ErrorCode::Usage, std::string(name) + " is NULL");
  return *pointer;
}

/// Returns the options, or the defaults for null.
inline const raymap_options& optionsOr(const raymap_options* options) {
  static const raymap_options kDefaults;
  return options ? *options : kDefaults;
}

/// Returns the data of an array of a handle's field; null if it is empty. Fails if the handle is null.
template <class T, class Handle, class AnyField>
const T* dataOf(const Handle* handle, Buffer<T> AnyField::*array) noexcept {
  const T* data = nullptr;
  guard([&] {
    const Buffer<T>& values = need(handle, "the field").field.*array;
    if (!values.empty()) data = values.data();
  });
  return data;
}

/// Returns options of a grid. Throws `Error(Usage)` as `read` does.
GridOptions gridOptions(const raymap_grid_options* options);

/// Returns the limit of a search; 0 = none.
inline double limitOr(double limit) {
  return limit != 0.0 ? limit : std::numeric_limits<double>::infinity();
}

/// Converts a grid from the struct for C.
inline Grid fromC(const raymap_grid& grid) {
  return {.dims = {grid.dims[0], grid.dims[1], grid.dims[2]},
          .origin = {grid.origin[0], grid.origin[1], grid.origin[2]},
          .spacing = grid.spacing};
}

inline glm::dvec3 vectorOf(const double (&numbers)[3]) {
  return {numbers[0], numbers[1], numbers[2]};
}

inline void copyVector(const glm::dvec3& from, double* to) {
  for (int a = 0; a < 3; ++a) to[a] = from[a];
}

/// Copies an array to the caller's, unless that is null.
template <class T>
void copyTo(T* to, const Buffer<T>& from) {
  if (to) std::ranges::copy(from, to);
}
inline void copyTo(double* to, const Buffer<glm::dvec3>& from) {
  for (size_t i = 0; to && i < from.size(); ++i) copyVector(from[i], to + 3 * i);
}

/// Returns the name of an enum's value. Names are literals, so they end with a zero.
template <class Enum>
const char* nameOf(Enum value) {
  return name(value).data();  // NOLINT(bugprone-suspicious-stringview-data-usage)
}

/// Converts a grid to the struct for C.
inline raymap_grid toC(const Grid& grid) {
  return {.dims = {grid.dims.x, grid.dims.y, grid.dims.z},
          .origin = {grid.origin.x, grid.origin.y, grid.origin.z},
          .spacing = grid.spacing};
}

/// Converts statistics to the struct for C.
inline raymap_stats toC(const Stats& stats) {
  return {.size = sizeof(raymap_stats),
          .milliseconds = stats.milliseconds,
          .bytes = stats.bytes,
          .doubtful_share = stats.doubtfulShare,
          .turned_faces = stats.turnedFaces.size(),
          .left_out_faces = stats.leftOutFaces.size(),
          .orientation_fits = stats.orientationFits,
          .misfit_given = stats.misfitGiven,
          .misfit = stats.misfit,
          .patch_triangles = stats.patchTriangles,
          .patch_area = stats.patchArea,
          .inverted_parts = stats.invertedParts.size()};
}

/// Makes a handle own a mesh.
inline void own(raymap_mesh& handle, Mesh mesh) {
  handle.owned = std::move(mesh);
  handle.view = handle.owned;
}

/// Returns a handle that owns the mesh.
inline std::unique_ptr<raymap_mesh> ownMesh(Mesh mesh) {
  auto handle = std::make_unique<raymap_mesh>();
  own(*handle, std::move(mesh));
  return handle;
}

}  // namespace raymap::c
