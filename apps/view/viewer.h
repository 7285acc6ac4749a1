#pragma once

#include <filesystem>

#include "camera.h"
#include "state.h"

namespace raymap::view {

/// Arguments of a window. The functions belong to the program: they read files and know its options.
struct ViewerOptions {
  std::filesystem::path input = {};
  std::filesystem::path other = {};  ///< A second mesh or field; empty: there is none.
  ViewState state = {};
  MachineOptions machine = {};
  WindowSize size = {1280, 800};
  /// Reads a file; of an animated one the clip with this name.
  std::function<Content(const std::filesystem::path& path, const std::string& clip)> load = {};
  /// Returns the command that draws the view of a file without a window. `other` is the second file, on whose
  /// grid too it is shown; empty if there is none.
  std::function<std::string(const std::filesystem::path& path, const std::filesystem::path& other,
                            const ViewState& state)>
      command = {};
  /// Takes the view that a command describes. Throws `Error(Usage)`.
  std::function<void(const std::string& command, ViewState& state)> apply = {};
  double fps = 24.0;  ///< Frames of a record per second.
  /// Begins to record pictures of this size, and returns what takes each; null ends the record.
  std::function<std::function<void(const Picture*)>(int width, int height, double fps)> record = {};
  /// Writes a picture that a command draws too, and returns its name.
  std::function<std::string(const Picture& picture, const std::string& command)> write = {};
};

/// Opens a window, and returns the command that draws its last view when it is closed. Throws `Error`:
/// Unsupported if there is no display or no device that can show a window, or as the functions do for the
/// first file. A lost device is started again once.
std::string runViewer(ViewerOptions options);

}  // namespace raymap::view
