#pragma once

#include <raymap/callbacks.h>
#include <raymap/field.h>
#include <raymap/mesh.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace raymap {

/// An 8-bit sRGB picture, rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;
};

/// The longest side of a picture, in pixels.
inline constexpr int kMaxPictureSide = 16384;

/// How to draw a field by sphere tracing (Hart 1996).
struct RenderOptions {
  int width = 1024;
  int height = 768;
  glm::dvec3 direction{-0.6, -0.45, -1.0};  ///< From the camera towards the centre of the shape.
  glm::dvec3 up{0.0, 1.0, 0.0};             ///< Points up in the picture; the floor is perpendicular to it.
  double fieldOfView = 30.0;                ///< Degrees from the bottom to the top of the picture.
  bool cut = false;    ///< Show half: what lies before the middle plane is cut away (paper Fig. 1).
  double shell = 0.0;  ///< Hollow it out, leaving an outer wall this thick, mesh units (paper Fig. 1).
  /// What the camera frames, instead of the shape: a box in the mesh's units that many fields share, so that
  /// it stands still while a shape moves. What reaches beyond the ball around it is cut off.
  std::optional<Box> frame;
  int threads = 0;  ///< Of the CPU; 0 = all.

  /// What draws, as in `Options`. A GPU's picture differs a little from the CPU's: the mean of a colour by
  /// at most 0.1 of 255, and at most 0.2 % of the pixels, on edges, by more than 8.
  std::string device = "auto";
  WarningCallback warn;  ///< Called with the reason when `auto` falls back to the CPU.
  ProgressCallback progress;
};

/// Draws the surface at distance zero on a light background; the camera stands so that the shape fills the
/// picture. A field without a negative sample (an unsigned one) has no inside: it is drawn as a thin skin
/// around its surface, at 0.7 of the spacing, the least that leaves no gap between samples. `cut` removes the
/// half nearer to the camera along the horizontal grid axis that points to it most; the cut face shows the
/// distance inside as `renderSlice` does. The grid's box cuts off what reaches it. Same field and options,
/// same picture, for any number of threads. Throws `Error`: Usage, Input if a sample is not finite,
/// Cancelled; of a device Unsupported, Memory, DeviceLost.
Picture renderField(const Field& field, const RenderOptions& options = {});

/// Draws a mesh's triangles as they are, not its field, what is wrong with them in colour: edges with one
/// face red, with more than two violet; faces that cross others orange, point against their neighbours blue,
/// or lie on others yellow. The backs of faces are darker. Of the options only the view counts.
Picture renderDefects(const Mesh& mesh, const RenderOptions& options = {});

/// A slice through the middle (or at sample `index`) across axis 0, 1 or 2, seen with y right and z up
/// across x, x right and z up across y, x right and y up across z. Values between samples are bilinear; a
/// sample fills `width` / samples pixels. Warm outside, cool inside, deeper with distance; thin lines at
/// multiples of a round distance (1, 2 or 5 times a power of ten), a thick line at zero.
Picture renderSlice(const Field& field, int axis, int index = -1, int width = 1024);

/// Where two fields on the same grid differ, in samples (distance over spacing).
struct Comparison {
  double maxError = 0.0;
  double meanError = 0.0;
  double rmsError = 0.0;
  size_t signDifferences = 0;  ///< Negative in one field only.
  size_t nonFinite = 0;        ///< Samples that are NaN or infinite in either; left out of all the above.
  size_t samples = 0;          ///< All of them.
  glm::ivec3 worstSample{0};   ///< The first with the largest error.
};

/// Throws `Error(Usage)` if the grids differ by more than rounding. If either field is clamped to a band,
/// both are compared within the narrower one.
Comparison compareFields(const Field& a, const Field& b);

/// The slice, across any axis, with the most sign differences, a square per sample, laid out as by
/// `renderSlice` (paper Fig. 11): where both agree light grey outside and grey inside; red inside by `a`
/// only, green by `b` only, violet not finite; the zero contours of `a` (black) and `b` (blue) on top. If no
/// sign differs: the slice across z of the worst sample, from white (equal) to dark red (`maxError`).
Picture renderComparison(const Field& a, const Field& b, int width = 1024);

/// Throws `Error(Usage)` if the picture is empty or larger than `kMaxPictureSide`, `Error(File)` if the file
/// cannot be written. The file appears whole or not at all.
void writePng(const std::filesystem::path& path, const Picture& picture);

}  // namespace raymap
