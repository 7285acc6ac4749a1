#include "defect_list.h"

#include <imgui.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <string>

#include "look.h"

namespace raymap::view {

namespace {

constexpr int kLines = 8;  // Places of a kind that are seen without scrolling.

std::string titleOf(const DefectList& list) {
  const bool isHoles = list.defect == Defect::Hole;
  return std::string(list.name) + ": " + (list.complete ? "" : "at least ") +
         std::to_string(isHoles ? list.places.size() : list.count());
}

void showPlaces(const DefectList& list, size_t first, const Defects& defects, Wishes& wishes) {
  const float height = ImGui::GetTextLineHeightWithSpacing();
  ImGui::BeginChild("places", {0.0F, height * (0.5F + float(std::min(list.places.size(), size_t{kLines})))},
                    true);
  ImGuiListClipper clipper;
  clipper.Begin(int(list.places.size()));
  while (clipper.Step())
    for (int p = clipper.DisplayStart; p < clipper.DisplayEnd; ++p) {
      const DefectPlace& place = list.places[size_t(p)];
      const char* unit = list.edges.empty() ? "face" : "edge";
      char text[96];
      std::snprintf(text, sizeof text, "%zu %s%s, %.4g across##%d", place.count, unit,
                    place.count == 1 ? "" : "s", place.diameter, p);
      if (ImGui::Selectable(text, defects.chosen() == first + size_t(p))) wishes.place = first + size_t(p);
    }
  ImGui::EndChild();
}

}  // namespace

void showDefectList(ViewState& state, const Defects& defects, Wishes& wishes) {
  ImGui::Checkbox(row("Defects").c_str(), &state.areDefectsShown);
  if (!state.areDefectsShown) return;
  ImGui::SameLine();
  if (defects.isBusy()) return ImGui::TextUnformatted("searching ...");
  if (!defects.error().empty()) return ImGui::TextWrapped("%s", defects.error().c_str());
  if (defects.lists().empty()) return ImGui::TextUnformatted("none");
  if (ImGui::Button("next")) wishes.nextPlace = true;
  size_t first = 0;
  for (const DefectList& list : defects.lists()) {
    const std::array<uint8_t, 3> colour = defectColour(list.defect);
    ImGui::PushID(int(list.defect));
    ImGui::ColorButton("colour", {colour[0] / 255.0F, colour[1] / 255.0F, colour[2] / 255.0F, 1.0F},
                       ImGuiColorEditFlags_NoTooltip, {ImGui::GetFontSize(), ImGui::GetFontSize()});
    ImGui::SameLine();
    if (ImGui::TreeNode("kind", "%s", titleOf(list).c_str())) {
      showPlaces(list, first, defects, wishes);
      ImGui::TreePop();
    }
    ImGui::PopID();
    first += list.places.size();
  }
}

}  // namespace raymap::view
