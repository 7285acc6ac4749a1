#include "panel.h"

#include <imgui.h>
#include <raymap/names.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "defect_list.h"
#include "help.h"
#include "look.h"

namespace raymap::view {

namespace {

constexpr float kWidth = 24.0F;  // Of the panel, in heights of the font.
constexpr float kLeastWindow =
    1.8F;  // Width of a window, in panels, in which the picture lies beside the panel.

std::string rounded(double value, int digits, const char* unit = "") {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*f%s", digits, value, unit);
  return buffer;
}

std::string text(double value, int digits = 6) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
  return buffer;
}

std::string text(const glm::dvec3& p) {
  constexpr int kDigits = 5;  // They fit into a line.
  return text(p.x, kDigits) + ", " + text(p.y, kDigits) + ", " + text(p.z, kDigits);
}

std::string megabytes(uint64_t bytes) {
  return rounded(1e-6 * double(bytes), 1, " MB");
}

/// Shows a text beside its label.
void figure(const char* label, const std::string& value) {
  ImGui::TextUnformatted(label);
  besideLabel();
  ImGui::TextWrapped("%s", value.c_str());
}

template <class Enum>
void choose(const char* label, Enum& value) {
  const std::string now(name(value));
  if (!ImGui::BeginCombo(row(label).c_str(), now.c_str())) return;
  for (const std::string_view each : names<Enum>()) {
    const std::string option(each);
    if (ImGui::Selectable(option.c_str(), option == now)) value = fromName<Enum>(each);
  }
  ImGui::EndCombo();
}

void drag(const char* label, double& value, double speed, double low, double high) {
  ImGui::DragScalar(row(label).c_str(), ImGuiDataType_Double, &value, float(speed), &low, &high, "%.5g");
}

/// Returns the range of a plane's offset in a box.
std::pair<double, double> offsets(const glm::dvec3& normal, const Box& box) {
  const double middle = glm::dot(normal, box.centre());
  const double half = 0.5 * glm::dot(glm::abs(normal), box.size());
  return {middle - 1.1 * half, middle + 1.1 * half};
}

void showPlane(const char* label, MovingPlane& plane, const RenderOptions& view, const Box& box) {
  ImGui::PushID(label);
  ImGui::Checkbox(row(label).c_str(), &plane.isOn);
  if (plane.isOn) {
    const auto turn = [&](const glm::dvec3& normal) {
      plane.normal = glm::normalize(normal);
      const auto [low, high] = offsets(plane.normal, box);
      plane.offset = 0.5 * (low + high);
    };
    constexpr const char* kAxes[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      ImGui::SameLine();
      glm::dvec3 normal(0.0);
      normal[axis] = 1.0;
      if (ImGui::Button(kAxes[axis])) turn(normal);
    }
    ImGui::SameLine();
    if (ImGui::Button("view")) turn(-view.direction);
    ImGui::SameLine();
    if (ImGui::Button("flip")) {
      plane.normal = -plane.normal;
      plane.offset = -plane.offset;
    }
    const auto [low, high] = offsets(plane.normal, box);
    ImGui::SliderScalar(row("   at").c_str(), ImGuiDataType_Double, &plane.offset, &low, &high, "%.5g");
  }
  ImGui::PopID();
}

/// Shows which colours there are, and what belongs to them.
void showColours(ViewState& state, const PanelFigures& figures) {
  const std::vector<Colours> all = coloursOf(figures.content, figures.other);
  const Colours now{state.view.array, state.isDifferenceShown};
  if (all.size() > 1 && ImGui::BeginCombo(row("Colours").c_str(), now.name().c_str())) {
    for (const Colours& each : all)
      if (ImGui::Selectable(each.name().c_str(), each == now)) each.choose(state);
    ImGui::EndCombo();
  }
  showLegend(figures.legend);
  if (state.isDifferenceShown) {
    const double size = glm::length(figures.content.bounds.size());
    drag("Range", state.view.range, 1e-4 * size, 0.0, size);
  }
  if (figures.other && !figures.other->isField()) {
    ImGui::Checkbox(row("Other mesh").c_str(), &state.isOtherOverlaid);
    ImGui::SameLine();
    ImGui::TextUnformatted("where it sticks out");
  }
}

void showView(ViewState& state, Wishes& wishes, const PanelFigures& figures) {
  if (!section("View", true)) return;
  const Box& box = figures.content.bounds;
  const double size = glm::length(box.size());
  if (!figures.content.isField()) {
    ImGui::Checkbox(row("Field").c_str(), &state.isFieldShown);
    int style = int(state.mesh);
    ImGui::Combo(row("Mesh").c_str(), &style, "hidden\0edges\0faces\0");
    state.mesh = MeshStyle(style);
    if (!state.isFieldShown && state.mesh == MeshStyle::Hidden) state.mesh = MeshStyle::Faces;
    showDefectList(state, figures.defects, wishes);
  }
  showColours(state, figures);
  drag("Iso value", state.view.iso, 1e-3 * size, -size, size);
  drag("Shell", state.view.shell, 1e-3 * size, 0.0, size);
  showPlane("Cut", state.cut, state.view, box);
  showPlane("Slice", state.slice, state.view, box);
  row("Look");
  wishes.frame = ImGui::Button("at all");
  constexpr const char* kAxes[] = {"along x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SameLine();
    if (ImGui::Button(kAxes[axis])) wishes.axis = axis + 1;
  }
  ImGui::Checkbox(row("Measure").c_str(), &state.isMeasuring);
  if (figures.measured.size() != 2) return;
  ImGui::SameLine();
  ImGui::TextUnformatted(text(glm::distance(figures.measured[0], figures.measured[1])).c_str());
}

void showField(ViewState& state, const PanelFigures& figures) {
  if (figures.content.isField() || !section("Field", true)) return;
  FieldOptions& options = state.field.options;
  ImGui::SliderInt(row("Resolution").c_str(), &state.field.resolution, 16, 512);
  choose("Distance", options.distance);
  choose("Sign", options.sign);
  choose("Orientation", options.orientation);
  ImGui::SliderInt(row("Passes").c_str(), &options.passes, 1, 32);
  drag("Threshold", options.threshold, 0.01, 0.01, 10.0);
  drag("Band (samples)", options.band, 0.1, 0.0, 512.0);
  ImGui::Checkbox(row("Close holes").c_str(), &options.closeHoles);
  ImGui::Checkbox(row("Invert").c_str(), &options.invert);
  drag("Thickness", options.thickness, 1e-3 * glm::length(figures.content.bounds.size()), 0.0, 1e30);
  figure("Samples", figures.grid);
}

void showAnimation(ViewState& state, const PanelFigures& figures, Wishes& wishes) {
  const double end = figures.content.seconds();
  if (!(end > 0.0) || !section("Animation", true)) return;
  const double start = 0.0;
  ImGui::SliderScalar(row("Time").c_str(), ImGuiDataType_Double, &state.seconds, &start, &end, "%.3f s");
  row("Play");
  if (ImGui::Button(state.isPlaying ? "pause" : "play")) state.isPlaying = !state.isPlaying;
  drag("Speed", state.speed, 0.01, 0.01, 100.0);
  if (figures.content.clips.size() > 1 && ImGui::BeginCombo(row("Clip").c_str(), state.clip.c_str())) {
    for (const std::string& clip : figures.content.clips)
      if (ImGui::Selectable(clip.c_str(), clip == state.clip)) {
        state.clip = clip;
        wishes.clip = true;
      }
    ImGui::EndCombo();
  }
}

void showTimes(ViewState& state, const PanelFigures& figures) {
  state.countsSteps = section("Times and memory", false);
  if (!state.countsSteps) return;
  figure("Device", figures.device);
  std::string memory = megabytes(figures.fieldBytes) + " for fields";
  if (const auto& all = figures.memory)
    memory += ", " + megabytes(all->held) + " of " + megabytes(all->most) + " in all";
  figure("Memory", memory);
  if (figures.steps) figure("Steps a ray", rounded(*figures.steps, 1));
  if (!figures.history.empty())
    ImGui::PlotLines(row("ms a frame").c_str(), figures.history.data(), int(figures.history.size()), 0,
                     nullptr, 0.0F, FLT_MAX, {0.0F, 3.0F * ImGui::GetFontSize()});
  if (figures.isFieldMoved) figure("field", "moved");
  for (const Frame::Time& time : figures.times) figure(time.stage, rounded(time.milliseconds, 2, " ms"));
}

void showProbed(const PanelFigures& figures) {
  if (!figures.probed) return;
  const Probed& probed = *figures.probed;
  ImGui::Separator();
  figure("At", text(probed.position));
  if (probed.distance) figure("Distance", text(*probed.distance));
  if (probed.other) figure("Of the other", text(*probed.other));
  if (probed.winding) figure("Winding no.", text(*probed.winding));
  if (probed.confidence) figure("Confidence", text(*probed.confidence));
  if (probed.triangle) figure("Triangle", std::to_string(*probed.triangle));
}

/// Puts the panel beside the picture, or over a small one.
void placePanel() {
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const float unit = ImGui::GetFontSize(), beside = panelWidth(window.x);
  ImGui::SetNextWindowPos(beside > 0.0F ? ImVec2() : ImVec2(0.5F * unit, 0.5F * unit), ImGuiCond_Always);
  const ImVec2 size{kWidth * unit, beside > 0.0F ? window.y : 0.0F};
  const float most = beside > 0.0F ? size.y : std::max(window.y - unit, 4.0F * unit);
  ImGui::SetNextWindowSizeConstraints(size, {size.x, most});
  const ImGuiWindowFlags flags =
      beside > 0.0F ? ImGuiWindowFlags_NoTitleBar : ImGuiWindowFlags_AlwaysAutoResize;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, beside > 0.0F ? 0.0F : ImGui::GetStyle().WindowRounding);
  ImGui::Begin("raymap", nullptr, flags | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  ImGui::PopStyleVar();
}

}  // namespace

float panelWidth(float window) {
  const float width = kWidth * fontHeight();
  return window >= kLeastWindow * width ? width : 0.0F;
}

Wishes showPanel(ViewState& state, const PanelFigures& figures, bool isRecording) {
  Wishes wishes;
  if (figures.refined) showRefining(*figures.refined);
  if (state.isHelpShown)
    showHelp(state.isHelpShown, state.isPanelShown ? panelWidth(ImGui::GetIO().DisplaySize.x) : 0.0F);
  if (!state.isPanelShown) return wishes;
  placePanel();
  ImGui::TextWrapped("%s", figures.content.title.c_str());
  if (figures.other && ImGui::Button(("show " + figures.other->title).c_str(), {-FLT_MIN, 0.0F}))
    state.isSecondShown = !state.isSecondShown;
  showView(state, wishes, figures);
  showField(state, figures);
  showAnimation(state, figures, wishes);
  showTimes(state, figures);
  wishes.picture = ImGui::Button("picture");
  ImGui::SameLine();
  wishes.record = ImGui::Button(isRecording ? "stop" : "record");
  ImGui::SameLine();
  wishes.copy = ImGui::Button("copy command");
  ImGui::SameLine();
  if (ImGui::Button("help")) state.isHelpShown = !state.isHelpShown;
  if (!figures.message.empty()) ImGui::TextWrapped("%s", figures.message.c_str());
  showProbed(figures);
  ImGui::End();
  return wishes;
}

}  // namespace raymap::view
