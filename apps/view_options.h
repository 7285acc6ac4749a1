#pragma once

#include <raymap/render.h>

#include <CLI/CLI.hpp>
#include <vector>

namespace raymap {

/// How to look at what is drawn, as the command line has it.
struct ViewArguments {
  std::vector<int> size{1024, 768};
  std::vector<double> direction, up;
};

void addViewOptions(CLI::App& command, ViewArguments& arguments);

/// Throws `Error(Usage)` if the directions make no view.
void setView(const ViewArguments& arguments, RenderOptions& options);

}  // namespace raymap
