#include "help.h"

#include <imgui.h>

#include <algorithm>

namespace raymap::view {

namespace {

constexpr struct {
  const char* keys;
  const char* effect;
} kHelp[] = {
    {"left drag", "turn"},
    {"right or Shift+left drag", "move"},
    {"wheel", "closer, towards the cursor"},
    {"double click", "turn around this point"},
    {"Ctrl+left drag", "move the cut, or else the slice"},
    {"F", "show all"},
    {"1, 3, 7", "along x, y, z; with Ctrl from behind"},
    {"C, X", "cut, slice"},
    {"W", "mesh: hidden, edges, faces"},
    {"V", "next colours"},
    {"B", "change between two shapes"},
    {"O", "the other mesh, where it sticks out"},
    {"D", "defects in colour"},
    {"N", "to the next defect; with Ctrl to the one before"},
    {"M", "measure from click to click"},
    {"Space", "play"},
    {"S, R", "write a picture, record a movie"},
    {"Ctrl+C", "copy the command that draws this"},
    {"Ctrl+V", "take the view of such a command"},
    {"drop a file", "show it"},
    {"P", "hide the panel"},
    {"H, Q", "this help, close"},
};

}  // namespace

void showHelp(bool& isShown, float left) {
  const float unit = ImGui::GetFontSize(), gap = 0.5F * unit;
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const ImVec2 most{all.x - 2.0F * gap, all.y - 2.0F * gap};
  const float width = std::min(38.0F * unit, most.x), column = std::min(13.0F * unit, 0.45F * width);
  // In the middle of the picture, or as near to it as all of it is seen.
  const float middle = std::min(0.5F * (left + all.x), all.x - gap - 0.5F * width);
  ImGui::SetNextWindowPos({middle, 0.5F * all.y}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, most.y});
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize;
  ImGui::Begin("Mouse and keys###help", &isShown, kFlags);
  for (const auto& [keys, effect] : kHelp) {
    ImGui::PushTextWrapPos(column - gap);
    ImGui::TextUnformatted(keys);
    ImGui::PopTextWrapPos();
    ImGui::SameLine(column);
    ImGui::PushTextWrapPos(0.0F);
    ImGui::TextUnformatted(effect);
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
}

}  // namespace raymap::view
