#pragma once

#include <raymap/animation.h>
#include <raymap/field.h>
#include <raymap/surface.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raymap::view {

/// A mesh, an animated mesh or a field to show.
struct Content {
  std::string title = {};
  Mesh mesh = {};                      ///< At rest, if it is animated; empty for a field.
  std::vector<glm::uvec3> given = {};  ///< Triangles of the file, if those of `mesh` differ.
  std::optional<AnimatedMesh> animated = {};
  std::vector<std::string> clips = {};  ///< Names of the file's animations.
  std::optional<Field> field = {};
  Box bounds = {};                ///< Bounds of the surface, in all poses, and of another one beside it.
  std::optional<Grid> grid = {};  ///< Grid of the mesh's field, if it is not fitted to the bounds.

  /// Returns whether there is no mesh.
  bool isField() const { return field.has_value(); }
  double seconds() const { return animated ? animated->seconds() : 0.0; }
};

/// Returns a mesh or a field to show. Throws `Error(Input)` if a mesh has no face.
Content contentOf(Mesh mesh);
Content contentOf(Field field);
Content contentOf(AnimatedMesh mesh);

}  // namespace raymap::view
