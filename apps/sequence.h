#pragma once

#include <raymap/animation.h>
#include <raymap/field.h>

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "mesh_units.h"
#include "parser.h"

namespace raymap {

/// Options of a command that makes a result for each frame.
struct FrameArguments {
  std::string frames;  ///< FIRST:LAST or FIRST:LAST:STEP; empty: one result.
  double fps = 24.0;
  int start = 0;  ///< Frame at the time 0.
  std::string clip;
};

/// Adds `--frames`, `--fps`, `--start-frame` and `--clip`.
void addFrameOptions(Command& command, FrameArguments& arguments);

/// Returns the path of one frame: that of `pattern` with the number in the place of %d or %04d, or else of $F
/// or $F4, or else of #, a digit each. Throws `Error(Usage)` unless its name has one such place.
std::filesystem::path framePath(const std::filesystem::path& pattern, int frame);

/// The frames of an animated glTF file, or of numbered files.
class Sequence {
 public:
  /// `format` counts if the names of files do not tell. With `allowEmpty` meshes may have no triangles.
  /// Throws `Error(Usage)` if the options contradict the input, `Error(File)` if a numbered file is missing,
  /// and as `readAnimatedMesh` does.
  Sequence(const FrameArguments& arguments, const std::filesystem::path& input, const std::string& format,
           const MeshUnits& units, bool allowEmpty = false, const std::string& grid = "");

  size_t size() const { return size_; }
  int frame(size_t i) const { return first_ + static_cast<int>(i) * step_; }
  /// Returns the frames per second of a movie of them.
  double fps() const { return fps_ / step_; }
  /// Returns the file that holds a frame.
  std::filesystem::path input(size_t i) const;
  /// Returns "frame 12 of 0 to 60: ", for progress.
  std::string title(size_t i) const;

  /// Reads or poses the mesh of a frame, or reads its field. Warns of what is odd in a file once.
  std::variant<Mesh, Field> read(size_t i);
  /// Returns the bounds of the shapes of all frames. Holds one frame at a time.
  Box bounds();

 private:
  void parse(const std::string& frames);
  void warnOfEnd() const;
  Mesh pose(size_t i) const;
  double seconds(size_t i) const { return (frame(i) - start_) / fps_; }

  int first_ = 0, step_ = 1, start_ = 0;
  size_t size_ = 0, seen_ = 0;
  double fps_;
  std::filesystem::path input_;
  std::string format_, grid_;
  MeshUnits units_;
  bool allowEmpty_;
  std::optional<AnimatedMesh> animated_;
};

}  // namespace raymap
