#pragma once

#include <raymap/field.h>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace raymap {

/// An 8-bit RGB picture, rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;
};

/// How to draw a field by sphere tracing (Hart 1996).
struct RenderOptions {
  int width = 1024;
  int height = 768;
  glm::dvec3 direction{-0.6, -0.45, -1.0};  ///< From the camera towards the centre of the field.
  glm::dvec3 up{0.0, 1.0, 0.0};
  bool cut = false;    ///< Show half: what lies before the middle plane is cut away (paper Fig. 1).
  double shell = 0.0;  ///< Hollow it out, leaving an outer wall this thick, mesh units (paper Fig. 1).
};

Picture renderField(const Field& field, const RenderOptions& options = {});

/// A slice through the middle (or at `index`) across axis 0, 1 or 2: iso-lines and the zero contour.
Picture renderSlice(const Field& field, int axis, int index = -1, int width = 1024);

/// Where two fields on the same grid differ, in samples.
struct Comparison {
  double maxError = 0.0;
  double meanError = 0.0;
  double rmsError = 0.0;
  size_t signDifferences = 0;
  size_t samples = 0;
  glm::ivec3 worstSample{0};
};

/// Throws `Error(Usage)` if the grids differ.
Comparison compareFields(const Field& a, const Field& b);

/// The slice with the most sign differences (or error): grey where both agree, red inside by `a` only, green
/// by `b` only (paper Fig. 11).
Picture renderComparison(const Field& a, const Field& b, int width = 1024);

void writePng(const std::filesystem::path& path, const Picture& picture);

}  // namespace raymap
