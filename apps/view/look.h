#pragma once

#include <filesystem>
#include <string>

namespace raymap::view {

/// Sets the font, colours and sizes of the panels. `scale` is that of the screen, and a point has so many
/// pixels. Without the font's file, or if that is empty, Dear ImGui's own font of pixels serves.
void setLook(const std::filesystem::path& font, double scale, double pixelsPerPoint);

/// Returns the height of the font, in points. Lengths of panels are multiples of it.
float fontHeight();

/// Shows the title of a section, which is open at first or not. Returns whether it is open.
bool section(const char* title, bool isOpen);
/// Goes on beside the column of labels.
void besideLabel();
/// Begins a row of the panel: its label, then a control as wide as the rest. Returns the control's name.
std::string row(const char* label);

}  // namespace raymap::view
