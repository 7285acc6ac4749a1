#pragma once

#include "state.h"

namespace raymap::view {

/// Returns how much of a window of this width the panel takes from the picture, in points; 0 if it lies over
/// a small one.
float panelWidth(float window);

/// Shows all controls and figures, and changes the state as its user wishes.
Wishes showPanel(ViewState& state, const PanelFigures& figures, bool isRecording);

}  // namespace raymap::view
