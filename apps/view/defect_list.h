#pragma once

#include "state.h"

namespace raymap::view {

/// Shows the part of the panel that lists the places of defects.
void showDefectList(ViewState& state, const Defects& defects, Wishes& wishes);

}  // namespace raymap::view
