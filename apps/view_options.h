#pragma once

#include <raymap/render.h>

#include <filesystem>
#include <string>
#include <vector>

#include "parser.h"

namespace raymap {

/// Arguments that say how to look at a picture.
struct ViewArguments {
  std::vector<int> size{1024, 768};
  std::vector<double> direction, up, eye, frame, cutPlane, slicePlane;
};

/// Adds the options of every picture.
void addViewOptions(Command& command, ViewArguments& arguments);
/// Adds those of a sphere-traced field.
void addSceneOptions(Command& command, ViewArguments& arguments, RenderOptions& view);

/// Returns whether z is up in files of this kind, as 3D printing and CAD have it: .stl and .3mf. `format` is
/// that of a file whose name does not tell it.
bool isZUp(const std::filesystem::path& path, const std::string& format);

/// Returns the view of a mesh that nobody asked another one for. The camera looks from above, aslant.
RenderOptions defaultView(bool isZUp);

/// Converts the arguments, with `isZUp` where --up is not given. Without --direction, the camera looks from
/// above whatever is up. Throws `Error(Usage)` if the directions make no view.
void setView(const ViewArguments& arguments, bool isZUp, RenderOptions& options);

}  // namespace raymap
