#pragma once

#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/mesh_view.h>
#include <raymap/picture.h>

#include <filesystem>
#include <optional>
#include <string>

namespace raymap {

/// Contents of a page besides a field.
struct PageOptions {
  std::string title = {};  ///< Heading; empty: the name of the file, or "Field".
  int maxSize = 256;       ///< Most samples along a side. Larger fields are resampled on a coarser grid.
  FieldArray array = FieldArray::Distance;  ///< Array in whose colours it begins; no triangles.
  std::optional<MeshView> mesh = {};        ///< Mesh whose defects it lists.
  const Field* other = nullptr;  ///< Second field to compare with, sampled on the grid of the page.
  std::string otherTitle = {};   ///< Name of the second field; empty: "Other field".
};

/// A page, not yet in a file.
struct Page {
  std::string html = {};  ///< The whole file.
  Grid grid = {};         ///< Grid of its samples, the field's or a coarser one.
};

/// Largest number of places that a page lists of each kind of defects.
inline constexpr size_t kMostDefectPlaces = 100;

/// Returns the grid of a page: the one given, or the finest one over the same box that has at most `maxSize`
/// samples along a side. Throws `Error(Usage)` if `maxSize` is below 2.
RAYMAP_API Grid pageGrid(const Grid& grid, int maxSize);

/// Returns a page that shows a field in a browser with WebGL 2: one HTML file, which needs no network. One
/// can turn the shape, move an iso value, a shell, a cut and a slice, and read off positions and distances.
/// Without WebGL the page shows a picture and figures.
///
/// It begins with the view and the colours of `renderField`, on the grid of the page. Distances are rounded
/// to 16-bit whole numbers, in steps of 1/32767 of the largest; their compression loses nothing. Winding
/// numbers are rounded to 1/2000 of the largest, confidences to 1/250; slices and cuts show them, confidences
/// the surface too.
///
/// The places of a mesh's defects are listed, at most `kMostDefectPlaces` of a kind, the largest first. A
/// page of two fields shows either, and their difference in colour; it shows distances only. Throws `Error`
/// as `renderField` does, Usage if `maxSize` is below 2, the field lacks `array` or the view names a second
/// field, Input for an invalid mesh.
///
/// The page of a narrow band takes time and memory that grow with the surface. It shows distances only, none
/// of them clamped: at each sample of the page that to the band's `isosurface`, which `generate` makes there.
/// So the surface across a hole of an open mesh is included. Where the band's box cuts the solid, distances
/// are those of a solid that goes straight on beyond it. `machine.device` and `memoryLimit` are used for that
/// field. Throws Usage, too, if no sample of the band is inside, or for an array other than the distance.
RAYMAP_API Page makePage(const Field& field, const RenderOptions& view = {}, const PageOptions& options = {},
                         const MachineOptions& machine = {});

/// Writes such a page to a file, which appears whole or not at all. Returns it. Throws as `makePage` does,
/// and File.
RAYMAP_API Page writePage(const std::filesystem::path& path, const Field& field,
                          const RenderOptions& view = {}, const PageOptions& options = {},
                          const MachineOptions& machine = {});

}  // namespace raymap
