#include "legend.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace raymap::view {

namespace {

constexpr int kBarColours = 128;

std::string shortText(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", number);
  return buffer;
}

}  // namespace

Legend legendOf(const RenderOptions& view, std::optional<double> range) {
  if (range) return {differenceBar(*range, kBarColours), {0.0}, {"other farther out", "other farther in"}};
  const ColourBar bar = colourBar(view, kBarColours);
  switch (view.array) {
    case FieldArray::Distance:
      return {bar, {view.iso}, {"inside", "outside"}};
    case FieldArray::Winding:
      return {bar, {-0.5, 0.5}, {"inside", "outside", "inside"}};
    default:
      return {bar, {}, {""}};
  }
}

void showLegend(const Legend& legend) {
  const ColourBar& bar = legend.bar;
  const float unit = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x, line = 1.25F * unit;
  const ImVec2 at = ImGui::GetCursorScreenPos(), low{at.x, at.y + line},
               high{at.x + width, low.y + 0.9F * unit};
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float step = width / float(bar.colours.size());
  for (size_t i = 0; i < bar.colours.size(); ++i) {
    const auto& [red, green, blue] = bar.colours[i];
    draw.AddRectFilled({low.x + float(i) * step, low.y}, {low.x + float(i + 1) * step, high.y},
                       IM_COL32(red, green, blue, 255));
  }
  draw.AddRect(low, high, ImGui::GetColorU32(ImGuiCol_Border));
  const auto placeOf = [&](double number) {
    return low.x + width * float((number - bar.least) / (bar.most - bar.least));
  };
  // Writes a text around a place, as far to the side as the bar's ends demand. Returns where it begins.
  const auto write = [&](const std::string& what, float middle, float top, ImGuiCol colour) {
    const float wide = ImGui::CalcTextSize(what.c_str()).x;
    const float left = std::clamp(middle - 0.5F * wide, low.x, std::max(high.x - wide, low.x));
    draw.AddText({left, top}, ImGui::GetColorU32(colour), what.c_str());
    return left;
  };
  const float below = high.y + 0.15F * unit;
  float free = low.x + ImGui::CalcTextSize(shortText(bar.least).c_str()).x;
  bool hasLeast = true;
  for (const double level : legend.levels) {
    const float place = placeOf(level);
    draw.AddRectFilled({place - 2.0F, low.y}, {place + 2.0F, high.y}, IM_COL32(255, 255, 255, 160));
    draw.AddRectFilled({place - 1.0F, low.y}, {place + 1.0F, high.y}, IM_COL32(28, 30, 34, 255));
    if (write(shortText(level), place, below, ImGuiCol_Text) < free) hasLeast = false;
  }
  if (hasLeast) write(shortText(bar.least), low.x, below, ImGuiCol_TextDisabled);
  write(shortText(bar.most), high.x, below, ImGuiCol_TextDisabled);
  for (size_t i = 0; i < legend.sides.size(); ++i) {
    const float from = i > 0 ? placeOf(legend.levels[i - 1]) : low.x;
    const float to = i < legend.levels.size() ? placeOf(legend.levels[i]) : high.x;
    write(legend.sides[i], 0.5F * (from + to), at.y, ImGuiCol_Text);
  }
  ImGui::Dummy({width, below + unit - at.y});
}

void showRefining(double share) {
  constexpr const char* kText = "refining";
  const float unit = ImGui::GetFontSize(), high = std::round(1.6F * unit), radius = 0.4F * unit;
  const float wide = std::round(ImGui::CalcTextSize(kText).x + 2.6F * unit), gap = std::round(0.6F * unit);
  const ImVec2 low{ImGui::GetIO().DisplaySize.x - wide - gap, gap};
  const ImVec2 end{low.x + wide, low.y + high}, disc{low.x + 1.1F * unit, low.y + 0.5F * high};
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImU32 accent = ImGui::GetColorU32(ImGuiCol_CheckMark);
  draw.AddRectFilled(low, end, ImGui::GetColorU32(ImGuiCol_WindowBg), 0.5F * high);
  draw.AddRect(low, end, ImGui::GetColorU32(ImGuiCol_Border), 0.5F * high);
  draw.AddCircle(disc, radius, accent);
  constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
  draw.PathLineTo(disc);
  draw.PathArcTo(disc, radius, -0.25F * kTurn, (float(share) - 0.25F) * kTurn);
  draw.PathFillConvex(accent);
  draw.AddText({disc.x + radius + 0.5F * unit, low.y + 0.3F * unit}, ImGui::GetColorU32(ImGuiCol_Text),
               kText);
}

}  // namespace raymap::view
