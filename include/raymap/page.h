#pragma once

#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/picture.h>

#include <filesystem>
#include <string>

namespace raymap {

/// How to write a page.
struct PageOptions {
  std::string title = {};  ///< Heading; empty: the name of the file.
  int maxSize = 256;       ///< Most samples along a side. Larger fields are sampled anew, on a coarser grid.
};

/// What `writePage` has written.
struct PageContent {
  Grid grid = {};    ///< Grid of its samples, the field's or a coarser one.
  size_t bytes = 0;  ///< Size of the file.
};

/// Writes a page that shows a field in a browser with WebGL 2: one HTML file, which needs no network. One can
/// turn the shape, move an iso value, a shell, a cut and a slice, and read off positions and distances.
/// Without WebGL the page shows a picture and figures.
///
/// It begins with the view and the colours of `renderField`. Distances are rounded to 16-bit whole numbers,
/// in steps of 1/32767 of the largest; their compression loses nothing. The file appears whole or not at all.
/// Throws `Error` as `renderField` and `writePng` do, and Usage if `maxSize` is below 2.
RAYMAP_API PageContent writePage(const std::filesystem::path& path, const Field& field,
                                 const RenderOptions& view = {}, const PageOptions& options = {},
                                 const MachineOptions& machine = {});

}  // namespace raymap
