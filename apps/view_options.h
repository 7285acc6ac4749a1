#pragma once

#include <raymap/render.h>

#include <CLI/CLI.hpp>
#include <vector>

namespace raymap {

/// Arguments that say how to look at a picture.
struct ViewArguments {
  std::vector<int> size{1024, 768};
  std::vector<double> direction, up;
};

/// Adds their options to a command.
void addViewOptions(CLI::App& command, ViewArguments& arguments);

/// Converts the arguments. Throws `Error(Usage)` if the directions make no view.
void setView(const ViewArguments& arguments, RenderOptions& options);

}  // namespace raymap
