#include "panel.h"

#include <imgui.h>
#include <raymap/names.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "defect_list.h"

namespace raymap::view {

namespace {

constexpr const char* kHelp =
    "left drag: turn\n"
    "right or Shift+left drag: move\n"
    "wheel: closer, towards the cursor\n"
    "double click: turn around this point\n"
    "Ctrl+left drag: move the cut, or else the slice\n"
    "F: show all    1 3 7: along x, y, z (Ctrl: from behind)\n"
    "C: cut    X: slice    W: mesh    Space: play\n"
    "V: next colours    B: change between two shapes\n"
    "O: the other mesh, where it sticks out\n"
    "D: defects in colour    N: to the next (Ctrl: to the one before)\n"
    "M: measure from click to click\n"
    "S: write a picture    R: record\n"
    "Ctrl+C: copy the command that draws this\n"
    "Ctrl+V: take the view of such a command\n"
    "drop a file: show it\n"
    "H: this help    Q: close";

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

std::string text(const glm::dvec3& p) {
  return text(p.x) + ", " + text(p.y) + ", " + text(p.z);
}

std::string megabytes(uint64_t bytes) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.1f MB", 1e-6 * double(bytes));
  return buffer;
}

template <class Enum>
void choose(const char* label, Enum& value) {
  const std::string now(name(value));
  if (!ImGui::BeginCombo(label, now.c_str())) return;
  for (const std::string_view each : names<Enum>()) {
    const std::string option(each);
    if (ImGui::Selectable(option.c_str(), option == now)) value = fromName<Enum>(each);
  }
  ImGui::EndCombo();
}

void drag(const char* label, double& value, double speed, double low, double high) {
  ImGui::DragScalar(label, ImGuiDataType_Double, &value, float(speed), &low, &high, "%.5g");
}

/// Returns the range of a plane's offset in a box.
std::pair<double, double> offsets(const glm::dvec3& normal, const Box& box) {
  const double middle = glm::dot(normal, box.centre());
  const double half = 0.5 * glm::dot(glm::abs(normal), box.size());
  return {middle - 1.1 * half, middle + 1.1 * half};
}

void showPlane(const char* label, MovingPlane& plane, const RenderOptions& view, const Box& box) {
  ImGui::PushID(label);
  ImGui::Checkbox(label, &plane.isOn);
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
      if (ImGui::SmallButton(kAxes[axis])) turn(normal);
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("view")) turn(-view.direction);
    ImGui::SameLine();
    if (ImGui::SmallButton("flip")) {
      plane.normal = -plane.normal;
      plane.offset = -plane.offset;
    }
    const auto [low, high] = offsets(plane.normal, box);
    ImGui::SliderScalar("at", ImGuiDataType_Double, &plane.offset, &low, &high, "%.5g");
  }
  ImGui::PopID();
}

/// Shows which colours there are, and what belongs to them.
void showColours(ViewState& state, const PanelFigures& figures) {
  const std::vector<Colours> all = coloursOf(figures.content, figures.other);
  const Colours now{state.view.array, state.isDifferenceShown};
  if (all.size() > 1 && ImGui::BeginCombo("colours", now.name().c_str())) {
    for (const Colours& each : all)
      if (ImGui::Selectable(each.name().c_str(), each == now)) each.choose(state);
    ImGui::EndCombo();
  }
  if (figures.other && !figures.other->isField())
    ImGui::Checkbox("other mesh where it sticks out", &state.isOtherOverlaid);
  if (state.isDifferenceShown) {
    const double size = glm::length(figures.content.bounds.size());
    drag("range", state.view.range, 1e-4 * size, 0.0, size);
  }
}

void showView(ViewState& state, Wishes& wishes, const PanelFigures& figures) {
  if (!ImGui::CollapsingHeader("View", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const Box& box = figures.content.bounds;
  const double size = glm::length(box.size());
  if (!figures.content.isField()) {
    ImGui::Checkbox("field", &state.isFieldShown);
    int style = int(state.mesh);
    ImGui::Combo("mesh", &style, "hidden\0edges\0faces\0");
    state.mesh = MeshStyle(style);
    if (!state.isFieldShown && state.mesh == MeshStyle::Hidden) state.mesh = MeshStyle::Faces;
    showDefectList(state, figures.defects, wishes);
  }
  showColours(state, figures);
  drag("iso value", state.view.iso, 1e-3 * size, -size, size);
  drag("shell", state.view.shell, 1e-3 * size, 0.0, size);
  showPlane("cut", state.cut, state.view, box);
  showPlane("slice", state.slice, state.view, box);
  wishes.frame = ImGui::Button("show all");
  constexpr const char* kAxes[] = {"along x", "along y", "along z"};
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SameLine();
    if (ImGui::Button(kAxes[axis])) wishes.axis = axis + 1;
  }
  ImGui::Checkbox("measure", &state.isMeasuring);
}

void showField(ViewState& state, const PanelFigures& figures) {
  if (figures.content.isField() || !ImGui::CollapsingHeader("Field", ImGuiTreeNodeFlags_DefaultOpen)) return;
  FieldOptions& options = state.field.options;
  ImGui::SliderInt("resolution", &state.field.resolution, 16, 512);
  choose("distance", options.distance);
  choose("sign", options.sign);
  choose("orientation", options.orientation);
  ImGui::SliderInt("passes", &options.passes, 1, 32);
  drag("threshold", options.threshold, 0.01, 0.01, 10.0);
  drag("band (samples)", options.band, 0.1, 0.0, 512.0);
  ImGui::Checkbox("close holes", &options.closeHoles);
  ImGui::SameLine();
  ImGui::Checkbox("invert", &options.invert);
  drag("thickness", options.thickness, 1e-3 * glm::length(figures.content.bounds.size()), 0.0, 1e30);
  ImGui::TextUnformatted(figures.grid.c_str());
}

void showAnimation(ViewState& state, const PanelFigures& figures, Wishes& wishes) {
  const double end = figures.content.seconds();
  if (!(end > 0.0) || !ImGui::CollapsingHeader("Animation", ImGuiTreeNodeFlags_DefaultOpen)) return;
  if (ImGui::Button(state.isPlaying ? "pause" : "play")) state.isPlaying = !state.isPlaying;
  ImGui::SameLine();
  const double start = 0.0;
  ImGui::SliderScalar("s", ImGuiDataType_Double, &state.seconds, &start, &end, "%.3f");
  drag("speed", state.speed, 0.01, 0.01, 100.0);
  if (figures.content.clips.size() > 1 && ImGui::BeginCombo("clip", state.clip.c_str())) {
    for (const std::string& clip : figures.content.clips)
      if (ImGui::Selectable(clip.c_str(), clip == state.clip)) {
        state.clip = clip;
        wishes.clip = true;
      }
    ImGui::EndCombo();
  }
}

void showTimes(ViewState& state, const PanelFigures& figures) {
  state.countsSteps = ImGui::CollapsingHeader("Times and memory");
  if (!state.countsSteps) return;
  ImGui::TextWrapped("%s", figures.device.c_str());
  std::string memory = "memory: " + megabytes(figures.fieldBytes) + " for fields";
  if (const auto& all = figures.memory)
    memory += ", " + megabytes(all->held) + " of " + megabytes(all->most) + " in all";
  ImGui::TextWrapped("%s", memory.c_str());
  if (figures.steps) ImGui::Text("%.1f steps a ray", *figures.steps);
  if (!figures.history.empty())
    ImGui::PlotLines("ms a frame", figures.history.data(), int(figures.history.size()), 0, nullptr, 0.0F,
                     FLT_MAX, {0.0F, 48.0F});
  if (figures.isFieldMoved) ImGui::TextUnformatted("field       moved");
  for (const Frame::Time& time : figures.times) ImGui::Text("%-8s %8.2f ms", time.stage, time.milliseconds);
}

void showProbed(const PanelFigures& figures) {
  if (!figures.probed) return;
  const Probed& probed = *figures.probed;
  ImGui::Separator();
  ImGui::TextUnformatted(("at " + text(probed.position)).c_str());
  std::string values;
  const auto add = [&](const char* label, const std::string& value) {
    values += (values.empty() ? "" : ", ") + (label + value);
  };
  if (probed.distance) add("distance ", text(*probed.distance));
  if (probed.other) add("distance of the other ", text(*probed.other));
  if (probed.winding) add("winding number ", text(*probed.winding));
  if (probed.confidence) add("confidence ", text(*probed.confidence));
  if (probed.triangle) add("triangle ", std::to_string(*probed.triangle));
  ImGui::TextWrapped("%s", values.c_str());
}

}  // namespace

Wishes showPanel(ViewState& state, const PanelFigures& figures, bool isRecording) {
  Wishes wishes;
  const float unit = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({unit, unit}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints({26.0F * unit, 0.0F}, {26.0F * unit, FLT_MAX});
  ImGui::Begin("raymap", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::TextUnformatted(figures.content.title.c_str());
  if (figures.other) {
    ImGui::SameLine();
    if (ImGui::SmallButton(("show " + figures.other->title).c_str()))
      state.isSecondShown = !state.isSecondShown;
  }
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
  if (state.isHelpShown) ImGui::TextUnformatted(kHelp);
  if (figures.measured.size() == 2)
    ImGui::Text("measured: %s", text(glm::distance(figures.measured[0], figures.measured[1])).c_str());
  showProbed(figures);
  if (!figures.message.empty()) ImGui::TextWrapped("%s", figures.message.c_str());
  ImGui::End();
  return wishes;
}

}  // namespace raymap::view
