#pragma once

#include <raymap/diagnostics.h>
#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/mesh_view.h>
#include <raymap/picture.h>

#include <array>
#include <cstdint>
#include <filesystem>

namespace raymap {

/// Draws the surface at the distance `iso` on a light background. Without `eye`, the camera stands where the
/// shape fills the picture. The grid's box cuts off what reaches it.
///
/// A field without a negative sample, such as an unsigned one, has no inside. It is drawn as a skin around
/// its surface, 0.7 of the spacing thick, the least without gaps between samples.
///
/// `cut` removes the half nearer to the camera along the horizontal grid axis that points to it most. The cut
/// face shows the distance inside as `renderSlice` does.
///
/// Winding numbers and confidences have the colours of `renderSlice`, differences from blue (less) to red
/// (more). The thick line is the surface; thin lines lie half a step off zero.
///
/// Rays pass cubes of samples without leaves of a narrow band at once, and the hits are those of the field
/// that `toDense` makes of it. Winding numbers and confidences are violet where they are not known: around
/// samples in no leaf. The second field is then read at the positions themselves, on whatever grid, on the
/// CPU: another device is an error if it was named. Where a distance is clamped, the difference is known only
/// to be at least, or at most, what the values give. It is in the deepest colour if that is beyond `range`,
/// else violet.
///
/// All of `machine` but `memoryLimit` is used. A GPU's picture differs a little from the CPU's: the mean of a
/// colour by at most 0.1 of 255, and at most 0.2 % of the pixels, on edges, by more than 8. Else the same
/// field and options give the same picture, for any number of threads. Throws `Error`: Usage, Input if a
/// number to draw is not finite, Cancelled; for the device Unsupported, Memory, DeviceLost.
RAYMAP_API Picture renderField(const Field& field, const RenderOptions& options = {},
                               const MachineOptions& machine = {});

/// Draws a mesh's triangles and its defects in colour. Only these options are used: the size,
/// `direction`, `up` and `fieldOfView`. Only `threads` and `progress` of `machine` are used.
///
/// Edges with one face are red, with more than two violet. Faces that cross others are orange, those that
/// point against their neighbours blue, double-sided ones green, duplicates yellow, backs darker. Faces in
/// one place show the first of these, else a front. Throws `Error`: Usage, Input (see `validate`),
/// Cancelled.
RAYMAP_API Picture renderDefects(const MeshView& mesh, const RenderOptions& options = {},
                                 const MachineOptions& machine = {});

/// Returns the colour in which `renderDefects` draws defects of a kind, in sRGB: that of fronts for
/// degenerate faces, which are too thin to be seen.
RAYMAP_API std::array<uint8_t, 3> defectColour(Defect defect);

/// Draws a slice across axis 0, 1 or 2 at sample `index`; -1 = the middle one.
///
/// Across x, y points right and z up; across y, x right and z up; across z, x right and y up. Values between
/// samples are bilinear, and a sample fills `width` / samples pixels. Outside is warm, inside cool, darker
/// with distance. Thin lines mark multiples of a round distance (1, 2 or 5 times a power of ten), a thick
/// line zero. Throws `Error(Usage)`.
///
/// Other arrays have colours of their own:
/// - `Winding`: a thick line where |w| = 0.5, the default threshold. Outside is warm. Inside is cool, or
/// green
///   where w < 0, and deeper with each turn; thin lines at 1.5, 2.5, ... part the whole numbers.
/// - `Confidence`: dark at 0, teal at 0.5, pale at 1.
/// - `Triangle`: a colour of its own for each triangle, one square per sample; light grey = none.
///
/// A narrow band is drawn as the field that `toDense` makes of it, without its memory.
RAYMAP_API Picture renderSlice(const Field& field, int axis, int index = -1, int width = 1024,
                               FieldArray array = FieldArray::Distance);

/// Colours of evenly spaced numbers, the first and the last included.
struct ColourBar {
  double least = 0.0;
  double most = 0.0;
  std::vector<std::array<uint8_t, 3>> colours = {};  ///< In sRGB.
};

/// Returns `count` colours in which `renderField` draws an array on slices and cut faces. Distances, in the
/// mesh's units, reach from the deepest colour inside to the deepest outside, which follow from
/// `options.frame`, `iso` and `shell`; winding numbers from -1 to 2, confidences from 0 to 1. Throws
/// `Error(Usage)` without a frame, for triangles, or if `count` is less than 2.
RAYMAP_API ColourBar colourBar(const RenderOptions& options, int count = 256);
/// Returns the same of the differences of two fields, which reach from `-range` to `range`.
RAYMAP_API ColourBar differenceBar(double range, int count = 256);

/// Differences of an array of two fields on the same grid. Errors of distances are in samples (distance over
/// spacing), of winding numbers and confidences as they are, of triangles 0.
struct Comparison {
  double maxError = 0.0;       ///< Largest error.
  double meanError = 0.0;      ///< Mean error.
  double rmsError = 0.0;       ///< Root mean square of the errors.
  size_t signDifferences = 0;  ///< Number of samples with a distance that is negative in one field only.
  size_t differences = 0;      ///< Number of samples whose values differ.
  size_t nonFinite = 0;  ///< Number of samples that are NaN or infinite in either; the errors leave them out.
  size_t samples = 0;    ///< Number of all samples.
  glm::ivec3 worstSample{0};  ///< The first sample with the largest error.
};

/// Compares an array of two fields. If either is clamped to a band, compares distances within the narrower
/// one. Two narrow bands are compared as the fields that `toDense` makes of them, without their memory:
/// numbers other than distances are known in leaves alone, so that other samples are not finite. Throws
/// `Error(Usage)` if the grids differ by more than rounding, a field lacks the array, or one alone is a
/// narrow band.
RAYMAP_API Comparison compareFields(const Field& a, const Field& b, FieldArray array = FieldArray::Distance);

/// Draws the slice with the most sign differences, across any axis, one square per sample, laid out as by
/// `renderSlice` (Krayer & Müller 2019, Fig. 11).
///
/// Samples on which both agree are light grey outside and grey inside. Inside by `a` only is red, by `b` only
/// green, not finite violet. The zero contours of `a` (black) and `b` (blue) lie on top. If no sign differs,
/// draws the slice across z of the worst sample instead, from white (equal) to dark red (`maxError`). Throws
/// as `compareFields` does.
///
/// Winding numbers and confidences are drawn as distances without a difference of sign. The contours are
/// those of |w| = 0.5; confidences have none. For indices of triangles, the slice with the most differences
/// is drawn: light grey where they agree, red where they differ.
RAYMAP_API Picture renderComparison(const Field& a, const Field& b, int width = 1024,
                                    FieldArray array = FieldArray::Distance);

/// Writes a picture as PNG. The file appears whole or not at all. Throws `Error`: Usage if the picture is
/// empty or larger than `kMaxPictureSide`, File if it cannot be written.
RAYMAP_API void writePng(const std::filesystem::path& path, const Picture& picture);

}  // namespace raymap
