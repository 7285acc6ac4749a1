#pragma once

namespace raymap::view {

/// Lists the mouse and the keys over the picture, which begins `left` points from the left. Closing it clears
/// `isShown`.
void showHelp(bool& isShown, float left);

}  // namespace raymap::view
