#ifdef __cplusplus
#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace raymap::view {
using glm::mat4;
using glm::vec3;
using uint = uint32_t;
#define RAYMAP_VIEW_ADDRESS(Type) uint64_t
#else
#define RAYMAP_VIEW_ADDRESS(Type) Type
#endif

#ifdef __cplusplus
#define RAYMAP_VIEW_CONSTANT inline constexpr
#else
#define RAYMAP_VIEW_CONSTANT const
#endif

// Values of `MeshPush::colour` that are no colours.
RAYMAP_VIEW_CONSTANT uint kNoFaces = 0, kPlainFaces = 1;

// Push constants of the shaders of a mesh and its defects. Positions are relative to the eye.
struct MeshPush {
  mat4 toClip;
  RAYMAP_VIEW_ADDRESS(Vectors) vertices;
  RAYMAP_VIEW_ADDRESS(Indices) indices;  // Three of a face, or two of an edge.
  RAYMAP_VIEW_ADDRESS(Depths) depth;     // Distance to what the field shows, row by row.
  vec3 origin;                           // Origin of the vertices.
  uint width;                            // Pixels in a row of `depth`.
  vec3 cutNormal;                        // Points beyond this plane are not drawn; 0 for no cut.
  float cutOffset;
  float slack;  // How far behind the field's surface a face is still seen; infinite where there is no field.
  uint colour;  // Colour of edges or of fronts: red in the lowest byte, green, blue, 255.
};

#ifdef __cplusplus
static_assert(sizeof(MeshPush) == 128);
}  // namespace raymap::view
#endif
