#pragma once

// The types behind the handles of raymap/c.h, and the way errors leave it.

#include <raymap/c.h>
#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/named_options.h>
#include <raymap/scene.h>
#include <raymap/surface.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

struct raymap_options {
  raymap::AllOptions all;
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

struct raymap_picture {
  raymap::Picture picture;
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
inline const AllOptions& optionsOr(const raymap_options* options) {
  static const AllOptions kDefaults;
  return options ? options->all : kDefaults;
}

/// Returns the field of a handle. Throws `Error(Usage)` if that is null.
inline const Field& fieldOf(const raymap_field* handle) {
  return need(handle, "the field").field;
}

/// Returns a handle that owns a field.
inline std::unique_ptr<raymap_field> ownField(Field field, Stats stats = {}) {
  return std::make_unique<raymap_field>(raymap_field{std::move(field), std::move(stats)});
}

/// Returns a text for the caller to free.
char* ownText(const std::string& text);

/// Converts a grid from the struct for C.
inline Grid fromC(const raymap_grid& grid) {
  return {.dims = {grid.dims[0], grid.dims[1], grid.dims[2]},
          .origin = {grid.origin[0], grid.origin[1], grid.origin[2]},
          .spacing = grid.spacing};
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

/// Converts a grid to the struct for C.
inline raymap_grid toC(const Grid& grid) {
  return {.dims = {grid.dims.x, grid.dims.y, grid.dims.z},
          .origin = {grid.origin.x, grid.origin.y, grid.origin.z},
          .spacing = grid.spacing};
}

/// Returns a handle that owns the mesh.
/// Returns a pose from its rows; that of the same coordinates for null.
inline glm::dmat4 poseOf(const double* rows) {
  glm::dmat4 pose(1.0);
  for (int row = 0; rows && row < 4; ++row)
    for (int column = 0; column < 4; ++column) pose[column][row] = rows[4 * row + column];
  return pose;
}

inline raymap_surface_pair toC(const SurfacePair& pair) {
  raymap_surface_pair result{.distance = pair.distance,
                             .bound = pair.bound,
                             .triangle = pair.triangle,
                             .other_triangle = pair.otherTriangle};
  copyVector(pair.point, result.point);
  copyVector(pair.otherPoint, result.other_point);
  return result;
}

inline std::unique_ptr<raymap_mesh> ownMesh(Mesh mesh) {
  auto handle = std::make_unique<raymap_mesh>();
  handle->owned = std::move(mesh);
  handle->view = handle->owned;
  return handle;
}

}  // namespace raymap::c
