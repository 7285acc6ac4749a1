#include "look.h"

#include <imgui.h>

#include <cfloat>

namespace raymap::view {

namespace {

constexpr double kFontHeight = 14.0;
constexpr float kLabelWidth = 8.0F;  // Of the column of labels, in heights of the font.

/// Colours as pages have them (src/render/page/page.html). The border has three times less light than the
/// ground, so that boxes which are not ticked are seen.
constexpr struct {
  ImGuiCol what;
  unsigned rgb;
} kPanelColours[] = {
    {ImGuiCol_Text, 0x1c1e22},
    {ImGuiCol_TextDisabled, 0x5a6069},
    {ImGuiCol_WindowBg, 0xeef0f2},
    {ImGuiCol_PopupBg, 0xffffff},
    {ImGuiCol_Border, 0x7f868f},
    {ImGuiCol_FrameBg, 0xffffff},
    {ImGuiCol_FrameBgHovered, 0xe9f2fc},
    {ImGuiCol_FrameBgActive, 0xd9e8f8},
    {ImGuiCol_TitleBg, 0xdfe4ea},
    {ImGuiCol_TitleBgActive, 0xdfe4ea},
    {ImGuiCol_TitleBgCollapsed, 0xdfe4ea},
    {ImGuiCol_ScrollbarBg, 0xeef0f2},
    {ImGuiCol_ScrollbarGrab, 0xb4bac3},
    {ImGuiCol_CheckMark, 0x0b63c5},
    {ImGuiCol_SliderGrab, 0x8fbcee},
    {ImGuiCol_SliderGrabActive, 0x5a9ee6},
    {ImGuiCol_Button, 0xffffff},
    {ImGuiCol_ButtonHovered, 0xe9f2fc},
    {ImGuiCol_ButtonActive, 0xd9e8f8},
    {ImGuiCol_Header, 0xdfe4ea},
    {ImGuiCol_HeaderHovered, 0xd0dfef},
    {ImGuiCol_HeaderActive, 0xc0d5ec},
    {ImGuiCol_Separator, 0xc3c8cf},
    {ImGuiCol_PlotLines, 0x0b63c5},
};

ImVec4 panelColour(unsigned rgb) {
  const auto part = [rgb](int shift) { return float(rgb >> shift & 0xff) / 255.0F; };
  return {part(16), part(8), part(0), 1.0F};
}

}  // namespace

void setLook(const std::filesystem::path& font, double scale, double pixelsPerPoint) {
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  for (const auto& [what, rgb] : kPanelColours) style.Colors[what] = panelColour(rgb);
  style.WindowPadding = {10.0F, 8.0F};
  style.FramePadding = {6.0F, 2.0F};
  style.ItemSpacing = {6.0F, 4.0F};
  style.ItemInnerSpacing = {6.0F, 4.0F};
  style.FrameBorderSize = 1.0F;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = style.WindowRounding = 3.0F;
  style.ScaleAllSizes(float(scale / pixelsPerPoint));
  // The font is drawn in the screen's pixels.
  ImGuiIO& io = ImGui::GetIO();
  ImFontConfig config;
  config.SizePixels = float(kFontHeight * scale);
  io.FontGlobalScale = float(1.0 / pixelsPerPoint);
  static constexpr ImWchar kGlyphs[] = {0x20,   0x17f,  0x370, 0x52f,
                                        0x2010, 0x2026, 0};  // Latin, Greek, Cyrillic.
  std::error_code error;
  if (std::filesystem::is_regular_file(font, error))
    io.Fonts->AddFontFromFileTTF(font.string().c_str(), config.SizePixels, &config, kGlyphs);
  else
    io.Fonts->AddFontDefault(&config);
}

float fontHeight() {
  const ImGuiIO& io = ImGui::GetIO();
  return io.Fonts->ConfigData[0].SizePixels * io.FontGlobalScale;
}

bool section(const char* title, bool isOpen) {
  ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, 0.0F);
  const bool isShown = ImGui::CollapsingHeader(title, isOpen ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  ImGui::PopStyleVar();
  return isShown;
}

void besideLabel() {
  ImGui::SameLine(kLabelWidth * ImGui::GetFontSize());
}

std::string row(const char* label) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  besideLabel();
  ImGui::SetNextItemWidth(-FLT_MIN);
  return std::string("##") + label;
}

}  // namespace raymap::view
