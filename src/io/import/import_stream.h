#pragma once

// Output of `raymap-import`, in the machine's own byte order: an ImportHeader and its message. Unless that is
// an error, one of these follows:
// - a MeshHeader, the positions (three doubles each), the triangles (three 32-bit indices each), and the
//   attributes: the MeshRuns, the names of parts and of materials, each with a 0 at its end, the colours of
//   materials (glm::vec4 each, sRGB), and for each vertex the texture coordinates (glm::vec2) and the colour
//   (glm::vec4, sRGB), if there are any;
// - for each mesh of a request for Draco, a MeshHeader, the triangles, and for each attribute that was asked
//   for the number of its components (64 bits) and its numbers (doubles);
// - for each grid, a VdbHeader and the samples (four bytes each, x fastest);
// - for a narrow band, a VdbHeader, the leaves (glm::ivec3 each), the tiles (NarrowBand::Tile each) and the
//   distances (512 of four bytes per leaf, x fastest); for each further grid, a VdbHeader and its values.

#include <array>
#include <cstdint>

namespace raymap {

inline constexpr uint32_t kImportMagic = 0x39494d52;  // RMI9

struct ImportHeader {
  uint32_t magic = kImportMagic;
  uint32_t failure = 0;  ///< 0 for success, else 1 + ErrorCode; the message then gives the reason.
  /// Length of the message. Without an error it has the names of the grids that are left out, a line each.
  uint64_t messageBytes = 0;
};
static_assert(sizeof(ImportHeader) == 16);

struct MeshHeader {
  uint64_t vertices = 0;
  uint64_t triangles = 0;
  uint64_t otherFaces = 0;  ///< Points, lines and faces without corners, which are left out.
  uint64_t uncutFaces = 0;  ///< Those that `PolygonCut::None` describes.
  uint64_t runs = 0, parts = 0, materials = 0;
  uint64_t nameBytes = 0;                 ///< Bytes of all names.
  uint64_t hasUvs = 0, hasColours = 0;    ///< Whether any vertex has these.
  uint64_t moreUvs = 0, moreColours = 0;  ///< Whether there are further ones, which are left out.
  uint64_t textures = 0;                  ///< Number of textures, which are left out.
};
static_assert(sizeof(MeshHeader) == 104);

/// Triangles in a row that have a part and a material, or `kNone`.
struct MeshRun {
  static constexpr uint32_t kNone = UINT32_MAX;

  uint64_t triangles = 0;
  uint32_t part = kNone, material = kNone;
  uint32_t hasUvs = 0, hasColours = 0;  ///< Whether their vertices have these.
};
static_assert(sizeof(MeshRun) == 24);

/// Begins each mesh of a request for Draco, a file that only `raymap-import` reads. The unique numbers of the
/// attributes (32 bits each) and the compressed bytes follow.
struct DracoHeader {
  uint64_t attributes = 0;
  uint64_t bytes = 0;
};
static_assert(sizeof(DracoHeader) == 16);

struct VdbHeader {
  std::array<int64_t, 3> dims{};
  std::array<double, 3> origin{};
  double spacing = 0.0;
  double clampDistance = 0.0;
  uint64_t hasSurface = 0;  ///< 1 if the bounds of the surface are known, x0 y0 z0 x1 y1 z1.
  std::array<double, 6> surface{};
  uint64_t isWhole = 0;     ///< 1 if the samples are signed integers, 0 if they are floats.
  uint64_t gridsAfter = 0;  ///< Number of grids that follow this one.
  std::array<char, 16> name{};
  uint64_t isBand = 0;  ///< 1 for a narrow band, of which the following is known.
  double outside = 0.0, inside = 0.0;
  uint64_t leaves = 0, tiles = 0;
};
static_assert(sizeof(VdbHeader) == 192);

}  // namespace raymap
