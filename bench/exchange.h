#pragma once

// Files that programs in other languages read.

#include <raymap/error.h>
#include <raymap/grid.h>
#include <raymap/mesh.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace raymap::bench {

template <class T>
void writeRaw(const std::string& path, const T* data, size_t count) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(data), std::streamsize(count * sizeof(T)));
  if (!file.flush()) throw Error(ErrorCode::File, path + ": cannot be written");
}

/// Writes NAME.vertices (double x 3) and NAME.triangles (uint32 x 3).
inline void exportMesh(const Mesh& mesh, const std::string& name) {
  std::vector<glm::dvec3> positions;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) positions.push_back(mesh.position(v));
  writeRaw(name + ".vertices", positions.data(), positions.size());
  writeRaw(name + ".triangles", mesh.triangles.data(), mesh.triangles.size());
}

inline nlohmann::json describe(const Mesh& mesh, const Grid& grid) {
  return {{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
          {"origin", {grid.origin.x, grid.origin.y, grid.origin.z}},
          {"spacing", grid.spacing},
          {"triangles", mesh.triangles.size()}};
}

}  // namespace raymap::bench
