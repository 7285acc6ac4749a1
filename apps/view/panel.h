#pragma once

#include "state.h"

namespace raymap::view {

/// Shows all controls and figures, and changes the state as its user wishes.
Wishes showPanel(ViewState& state, const PanelFigures& figures, bool isRecording);

}  // namespace raymap::view
