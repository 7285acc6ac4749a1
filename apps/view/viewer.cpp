#include "viewer.h"

#include <GLFW/glfw3.h>
#include <imgui.h>
#include <raymap/error.h>
#include <raymap/generate.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "defects.h"
#include "panel.h"
#include "picture.h"
#include "probe.h"
#include "second.h"
#include "window.h"

namespace raymap::view {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kMaking = 1.0 / 60.0;  // Seconds to wait for an event while the CPU makes a field.
constexpr double kIdle = 0.25;          // Seconds to wait for an event while nothing moves.
constexpr size_t kHistory = 120;        // Frames whose times are shown.

/// A frame takes faces as they point. So those that point the wrong way are turned once, beforehand, and the
/// other sides of double-sided ones and repeated ones are removed.
void turnWrongFaces(Content& content, const FieldOptions& options, const MachineOptions& machine) {
  if (content.isField() || options.sign == SignMode::None) return;
  MachineOptions onCpu = machine;
  onCpu.device = "cpu";
  constexpr int kResolution = 64;
  const FieldOptions turning{.orientation = options.orientation};
  const Stats stats =
      generate(content.mesh, fitGrid(content.mesh, {.resolution = kResolution}), turning, onCpu).stats;
  if (stats.turnedFaces.empty() && stats.leftOutFaces.empty()) return;
  content.given = content.mesh.triangles;
  for (Mesh* mesh : {&content.mesh, content.animated ? &content.animated->rest : nullptr})
    if (mesh) {
      turnFaces(*mesh, stats.turnedFaces);
      removeFaces(*mesh, stats.leftOutFaces);
    }
}

/// A mesh or field in the window, and the objects of the device and of other threads that belong to it.
struct ContentInWindow {
  ContentInWindow(Content given, const Gpu& gpu, bool isOnDevice, const MachineOptions& machine)
      : content(std::move(given)),
        mesh(content.isField() ? nullptr : std::make_unique<DeviceMesh>(gpu, content)),
        field(gpu, content, mesh.get(), isOnDevice, machine),
        probe(content, machine) {}
  Content content;
  std::unique_ptr<DeviceMesh> mesh;
  LiveField field;
  Probe probe;
};

/// The ray under the cursor in a frame. The device writes the depth along it.
struct Hover {
  Buffer depth;
  std::optional<glm::dvec3> eye;
  glm::dvec3 ray{0.0};
};

/// Steps that the rays of the picture have taken, of so many pixels. The device writes them.
struct Steps {
  Buffer sum;
  size_t pixels = 0;
};

fs::file_time_type timeOf(const fs::path& path) {
  std::error_code error;
  const fs::file_time_type time = fs::last_write_time(path, error);
  return error ? fs::file_time_type::min() : time;
}

class Viewer {
 public:
  explicit Viewer(ViewerOptions& options);
  ~Viewer() { vkDeviceWaitIdle(gpu_.device()); }  // A lost device has nothing to wait for.

  /// Runs until the window is closed.
  void run();
  /// Returns the command that draws what is shown.
  std::string command() const;

 private:
  static bool makesFieldsOnDevice(const Gpu& gpu, const std::string& device) {
    return device != "cpu" && (!gpu.isSoftware() || device.starts_with("vulkan"));
  }
  /// Returns how many pixels the panel takes from the left of the picture.
  int left() const {
    const double scale = window_.scale();
    const float points = float(swapchain_.size().width / scale);
    return options_.state.isPanelShown ? int(std::lround(scale * panelWidth(points))) : 0;
  }
  WindowSize pictureSize() const {
    return {int(swapchain_.size().width) - left(), int(swapchain_.size().height)};
  }
  /// Returns whether time stands still until a picture is as fine as it will be.
  bool isStill() const { return isPictureWanted_ || recorder_; }
  ContentInWindow& shown() const { return *shapes_[options_.state.isSecondShown ? 1 : 0]; }
  /// Returns the shape that is not shown; null if there is only one.
  ContentInWindow* other() const { return shapes_[options_.state.isSecondShown ? 0 : 1].get(); }
  /// Returns the shape whose difference is in colour; null if none is.
  ContentInWindow* compared() const { return options_.state.isDifferenceShown ? other() : nullptr; }
  const Content& content() const { return shown().content; }
  Defects& defects() { return defects_[options_.state.isSecondShown ? 1 : 0]; }
  const Defects& defects() const { return defects_[options_.state.isSecondShown ? 1 : 0]; }
  const fs::path& path(bool isSecond) const { return isSecond ? options_.other : options_.input; }
  /// Returns whether all that is shown is what was asked for.
  bool isCurrent() const {
    return shown().field.isCurrent() && (!compared() || compared()->field.isCurrent()) && !defects().isBusy();
  }

  using Shapes = std::array<std::unique_ptr<ContentInWindow>, 2>;
  Shapes load(const fs::path& first, const fs::path& second);
  Content loadContent(const fs::path& path);
  void show(const fs::path& first, const fs::path& second, bool isSameView);
  void keepColours();
  void chooseNextColours();
  void setTitle();
  std::array<fs::file_time_type, 2> fileTimes() const;
  void watchFile();
  void resize();
  void fitPicture();
  void step();
  void draw(Frame& frame, uint32_t image);
  void takeEvents();
  void take(const Window::Key& key);
  void take(Window::Mouse mouse);
  void click();
  void movePlane(const glm::dvec2& drag);
  void obey(const Wishes& wishes);
  void readHover(size_t slot);
  void askHover(Frame& frame, size_t slot);
  void readSteps(size_t slot);
  void askSteps(Frame& frame, size_t slot);
  void advance(double seconds);
  void takePicture(Frame& frame);
  void writePictures();
  void endRecord();
  Picture readPicture() const;
  Legend legend() const;
  bool isRefining() const;
  PanelFigures figures() const;
  RenderOptions view() const;
  void goToPlace();
  void goToNextPlace(int step);
  void markPlace() const;
  void placeCamera() { camera_.place(options_.state.view); }

  ViewerOptions& options_;
  Window window_;
  Gpu gpu_;
  Swapchain swapchain_;
  LivePicture picture_;
  std::array<Frame, 2> frames_;
  std::array<Hover, 2> hovers_;
  std::array<Steps, 2> steps_;
  Shapes shapes_;
  std::array<Defects, 2> defects_;
  Gui gui_;
  Camera camera_;
  std::array<fs::file_time_type, 2> fileTimes_;
  Clock::time_point lastStep_ = Clock::now(), lastLook_ = Clock::now();
  /// A button that is held down, and how far the cursor has moved since.
  struct Drag {
    Window::Mouse start;
    double length = 0.0;
  };
  std::optional<Drag> drag_;
  glm::dvec2 cursor_{0.0};
  Clock::time_point lastClick_ = {};
  size_t next_ = 0;
  bool isMoving_ = true;
  std::optional<RenderOptions> lastView_;
  std::array<double, 8> lastRest_{};  ///< Further values that a picture depends on.
  std::vector<Frame::Time> times_;
  std::vector<float> history_;
  std::string message_;
  std::optional<Probed> probed_;
  std::optional<double> stepsPerRay_;
  std::vector<glm::dvec3> measured_;
  bool isPictureWanted_ = false;
  Buffer pixels_;
  std::function<void(const Picture*)> recorder_;
};

/// Returns the box of the cells around a grid's samples.
Box boxOf(const Grid& grid) {
  return {grid.position(glm::dvec3(-0.5)), grid.position(glm::dvec3(grid.dims) - 0.5)};
}

/// Puts a plane that was never moved into the middle.
void centre(MovingPlane& plane, const Box& box) {
  if (!plane.isOn) plane.offset = glm::dot(plane.normal, box.centre());
}

Swapchain sized(Swapchain swapchain, const Window& window) {
  swapchain.resize(window.size());
  return swapchain;
}

Viewer::Viewer(ViewerOptions& options)
    : options_(options),
      window_("raymap", options.size),
      gpu_(options.machine.device, Window::extensions(),
           [this](VkInstance instance) { return window_.makeSurface(instance); }),
      swapchain_(sized(Swapchain(gpu_), window_)),
      picture_(gpu_),
      frames_{Frame(gpu_), Frame(gpu_)},
      shapes_(load(options.input, options.other)),
      defects_{Defects(gpu_), Defects(gpu_)},
      gui_(window_, gpu_, swapchain_),
      camera_(options.state.view, content().bounds, pictureSize()) {
  for (MovingPlane* plane : {&options.state.cut, &options.state.slice}) centre(*plane, content().bounds);
  for (Hover& hover : hovers_) hover.depth = gpu_.makeBuffer(sizeof(float), true);
  for (Steps& steps : steps_) steps.sum = gpu_.makeBuffer(sizeof(uint32_t), true);
  fitPicture();
  setTitle();
  fileTimes_ = fileTimes();
  options_.state.isDifferenceShown = bool(other()) && options_.state.view.array == FieldArray::Distance;
  keepColours();
  placeCamera();
}

Content Viewer::loadContent(const fs::path& path) {
  Content content = options_.load(path, options_.state.clip);
  if (makesFieldsOnDevice(gpu_, options_.machine.device))
    turnWrongFaces(content, options_.state.field.options, options_.machine);
  return content;
}

Viewer::Shapes Viewer::load(const fs::path& first, const fs::path& second) {
  const bool isOnDevice = makesFieldsOnDevice(gpu_, options_.machine.device);
  const auto prepared = [&](Content& content) {
    return std::make_unique<ContentInWindow>(std::move(content), gpu_, isOnDevice, options_.machine);
  };
  Content content = loadContent(first);
  if (second.empty()) return {prepared(content), nullptr};
  Content beside = loadContent(second);
  makeComparable(content, beside);
  return {prepared(content), prepared(beside)};
}

void Viewer::setTitle() {
  const std::string beside = shapes_[1] ? " and " + shapes_[1]->content.title : "";
  window_.setTitle(shapes_[0]->content.title + beside + " – raymap");
}

/// Colours that a shape does not have give way to distances.
void Viewer::keepColours() {
  ViewState& state = options_.state;
  const std::vector<Colours> all = coloursOf(content(), other() ? &other()->content : nullptr);
  const Colours now{state.view.array, state.isDifferenceShown};
  if (std::ranges::find(all, now) == all.end()) Colours{}.choose(state);
  state.field.options.winding = state.view.array == FieldArray::Winding;
  state.field.options.confidence = state.view.array == FieldArray::Confidence;
}

void Viewer::chooseNextColours() {
  const std::vector<Colours> all = coloursOf(content(), other() ? &other()->content : nullptr);
  const auto now =
      std::ranges::find(all, Colours{options_.state.view.array, options_.state.isDifferenceShown});
  const size_t next = now == all.end() ? 0 : size_t(now - all.begin()) + 1;
  all[next % all.size()].choose(options_.state);
}

/// A file that cannot be read leaves what is shown.
void Viewer::show(const fs::path& first, const fs::path& second, bool isSameView) {
  try {
    Shapes shapes = load(first, second);
    gpu_.waitIdle();
    shapes_ = std::move(shapes);
    for (Defects& defects : defects_) defects.clear();
    message_.clear();
  } catch (const Error& error) {
    message_ = error.what();
    return;
  }
  options_.input = first;
  options_.other = second;
  if (second.empty()) options_.state.isSecondShown = false;
  fileTimes_ = fileTimes();
  lastView_.reset();
  measured_.clear();
  options_.state.seconds = std::min(options_.state.seconds, content().seconds());
  setTitle();
  if (isSameView) return;
  options_.state.view.iso = options_.state.view.shell = 0.0;
  options_.state.cut = options_.state.slice = {};
  for (MovingPlane* plane : {&options_.state.cut, &options_.state.slice}) centre(*plane, content().bounds);
  camera_.frame(content().bounds, pictureSize());
  placeCamera();
}

std::array<fs::file_time_type, 2> Viewer::fileTimes() const {
  return {timeOf(options_.input), options_.other.empty() ? fs::file_time_type() : timeOf(options_.other)};
}

void Viewer::watchFile() {
  const Clock::time_point now = Clock::now();
  if (now - lastLook_ < std::chrono::milliseconds(500)) return;
  lastLook_ = now;
  const std::array<fs::file_time_type, 2> times = fileTimes();
  if (times == fileTimes_) return;
  fileTimes_ = times;
  for (const bool isSecond : {false, true})
    if (times[isSecond ? 1 : 0] == fs::file_time_type::min()) {
      message_ = path(isSecond).string() + " is gone; what was read is still shown";
      return;
    }
  show(options_.input, options_.other, true);
}

void Viewer::resize() {
  gpu_.waitIdle();
  swapchain_.resize(window_.size());
  fitPicture();
  lastView_.reset();
}

/// Gives the picture the size that the window and the panel leave. A movie has pictures of one size, so it
/// ends.
void Viewer::fitPicture() {
  const VkExtent2D size{uint32_t(pictureSize().width), uint32_t(pictureSize().height)}, now = picture_.size();
  if (now.width == size.width && now.height == size.height) return;
  endRecord();
  gpu_.waitIdle();
  picture_.resize(size);
  lastView_.reset();
}

void Viewer::run() {
  while (!window_.isClosed()) {
    const bool isSeen = !window_.isMinimised();
    const bool isDrawing = shown().field.isReady() && (isMoving_ || !picture_.isFinished());
    window_.wait(isSeen && (isDrawing || isStill()) ? 0.0 : !isSeen || isCurrent() ? kIdle : kMaking);
    for (const fs::path& path : window_.takeDropped()) show(path, {}, false);
    watchFile();
    if (window_.isMinimised()) {
      lastStep_ = Clock::now();  // Time rests.
      continue;
    }
    const VkExtent2D size = window_.size();
    if (size.width != swapchain_.size().width || size.height != swapchain_.size().height) resize();
    step();
  }
  endRecord();
}

void Viewer::advance(double seconds) {
  ViewState& state = options_.state;
  const double end = content().seconds();
  if (!state.isPlaying || !(end > 0.0)) return;
  state.seconds = std::fmod(state.seconds + state.speed * seconds, end);
}

void Viewer::step() {
  const size_t slot = next_++ % frames_.size();
  Frame& frame = frames_[slot];
  frame.begin();
  const std::optional<uint32_t> image = swapchain_.acquire(frame.isFree());
  if (!image) return resize();  // Nothing was recorded yet.
  readHover(slot);
  readSteps(slot);
  const Clock::time_point now = Clock::now();
  const double passed = std::chrono::duration<double>(now - lastStep_).count();
  lastStep_ = now;
  if (!isStill()) advance(passed);
  if (!frame.times().empty()) times_ = frame.times();
  history_.push_back(float(1e3 * passed));
  if (history_.size() > kHistory) history_.erase(history_.begin());

  gui_.begin();
  obey(showPanel(options_.state, figures(), bool(recorder_)));
  takeEvents();
  fitPicture();
  markPlace();
  draw(frame, *image);
  askHover(frame, slot);
  askSteps(frame, slot);
  const bool isTaken = isStill() && picture_.isFinished() && isCurrent();
  if (isTaken) takePicture(frame);
  frame.submit(swapchain_.isDrawn(*image));
  const bool fits = swapchain_.present(*image);
  if (isTaken) {
    gpu_.waitIdle();
    writePictures();
  }
  if (!fits) resize();
}

/// A file that cannot be written ends the record, not the window.
void Viewer::writePictures() {
  const Picture picture = readPicture();
  try {
    if (std::exchange(isPictureWanted_, false)) message_ = "wrote " + options_.write(picture, command());
    if (recorder_) recorder_(&picture);
    if (recorder_) advance(1.0 / options_.fps);
  } catch (const Error& error) {
    message_ = error.what();
    recorder_ = {};
  }
}

void Viewer::endRecord() {
  if (!recorder_) return;
  try {
    std::exchange(recorder_, {})(nullptr);
  } catch (const Error& error) {
    message_ = error.what();
  }
}

RenderOptions Viewer::view() const {
  const ViewState& state = options_.state;
  RenderOptions view = state.view;
  camera_.place(view);
  view.width = pictureSize().width;
  view.height = pictureSize().height;
  view.cut = false;
  view.cutPlane = state.cut.plane();
  view.slice = state.slice.plane();
  // The padding by the iso value must fit, too.
  const double pad = std::max(view.iso, 0.0) + 0.5 * state.field.options.thickness;
  view.frame = Box{content().bounds.min - pad, content().bounds.max + pad};
  // Until the field has the array, distances are shown.
  if (view.array != shown().field.array()) view.array = FieldArray::Distance;
  const double band = shown().field.buffer().clampDistance;
  if (band > 0.0) view.shell = std::min(view.shell, 0.99 * band);
  if (band > 0.0) view.iso = std::clamp(view.iso, -0.99 * band, 0.99 * band);
  return view;
}

void Viewer::draw(Frame& frame, uint32_t image) {
  ViewState& state = options_.state;
  const RenderOptions now = view();
  const std::array<double, 8> rest{double(state.mesh),
                                   double(state.isFieldShown),
                                   state.seconds,
                                   double(state.areDefectsShown),
                                   double(state.isSecondShown),
                                   double(state.isDifferenceShown),
                                   double(state.isOtherOverlaid),
                                   double(state.countsSteps)};
  if (state.areDefectsShown && shown().mesh) defects().find(content(), state.seconds, options_.machine);
  const bool isFound = defects().record(frame);
  const bool hasMoved = lastView_ != now || lastRest_ != rest || isFound;
  isMoving_ = hasMoved || (state.isPlaying && !isStill());
  lastView_ = now;
  lastRest_ = rest;
  // The edges of the grid are seen on a slice, and by a surface outside of the mesh. A difference needs both
  // fields on one grid.
  const bool mayMove = !state.slice.isOn && now.iso <= 0.0 && !compared();
  bool isNew = false;
  for (ContentInWindow* each : {&shown(), compared()}) {
    if (!each) continue;
    if (each->mesh) each->mesh->record(frame, state.seconds);
    const bool isRemade = each->field.record(frame, state.field, state.seconds, isMoving_, mayMove);
    if (isRemade && each->field.isOnDevice()) frame.stamp("field");
    isNew = isNew || isRemade;
  }
  DeviceMesh* const overlaid = state.isOtherOverlaid && other() ? other()->mesh.get() : nullptr;
  if (overlaid && !compared()) overlaid->record(frame, state.seconds);
  try {
    picture_.record(frame,
                    {.field = shown().field,
                     .other = compared() ? &compared()->field : nullptr,
                     .isFieldShown = state.isFieldShown || !shown().mesh,
                     .mesh = shown().mesh.get(),
                     .style = state.mesh,
                     .parts = state.areDefectsShown ? std::span<const MeshPart>(defects().parts())
                                                    : std::span<const MeshPart>(),
                     .overlaid = overlaid,
                     .countsSteps = state.countsSteps,
                     .camera = camera_,
                     .view = now,
                     .bounds = content().bounds},
                    hasMoved || isNew);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::DeviceLost) throw;
    message_ = error.what();
  }
  const VkCommandBuffer commands = frame.commands();
  moveImage(commands, swapchain_.image(image), VK_IMAGE_LAYOUT_UNDEFINED,
            VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  picture_.copyTo(commands, swapchain_.image(image), left());
  moveImage(commands, swapchain_.image(image), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
            VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  swapchain_.beginOverlay(commands, image);
  gui_.record(commands);
  vkCmdEndRenderPass(commands);
  frame.stamp("panels");
}

void Viewer::readHover(size_t slot) {
  const Hover& hover = hovers_[slot];
  probed_.reset();
  if (!hover.eye) return;
  const float depth = *static_cast<const float*>(hover.depth.mapped);
  if (depth == std::numeric_limits<float>::max()) return;
  probed_ = shown().probe.at(*hover.eye + double(depth) * hover.ray);
  if (other()) probed_->other = other()->probe.at(probed_->position).distance;
}

void Viewer::askHover(Frame& frame, size_t slot) {
  Hover& hover = hovers_[slot];
  hover.eye.reset();
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse || !ImGui::IsMousePosValid()) return;
  const glm::dvec2 cursor =
      window_.scale() * glm::dvec2(io.MousePos.x, io.MousePos.y) - glm::dvec2(left(), 0.0);
  *static_cast<float*>(hover.depth.mapped) = std::numeric_limits<float>::max();
  picture_.copyDepth(frame.commands(), cursor, hover.depth);
  hover.eye = camera_.eye();
  hover.ray = camera_.ray(cursor, pictureSize());
}

void Viewer::readSteps(size_t slot) {
  const Steps& steps = steps_[slot];
  stepsPerRay_.reset();
  if (steps.pixels > 0)
    stepsPerRay_ = double(*static_cast<const uint32_t*>(steps.sum.mapped)) / double(steps.pixels);
}

void Viewer::askSteps(Frame& frame, size_t slot) {
  Steps& steps = steps_[slot];
  steps.pixels = options_.state.countsSteps ? picture_.countedPixels() : 0;
  if (steps.pixels > 0) picture_.copySteps(frame.commands(), steps.sum);
}

void Viewer::takeEvents() {
  for (const Window::Event& event : window_.takeEvents())
    std::visit([this](const auto& each) { take(each); }, event);
  if (!options_.state.isMeasuring) measured_.clear();
}

void Viewer::take(const Window::Key& pressed) {
  if (ImGui::GetIO().WantTextInput) return;
  const auto& [key, hasControl] = pressed;
  ViewState& state = options_.state;
  Wishes wishes;
  if (hasControl) {
    if (key == GLFW_KEY_C) wishes.copy = true;
    if (key == GLFW_KEY_V) {
      try {
        options_.apply(window_.paste(), state);
        camera_ = Camera(state.view, content().bounds, pictureSize());
      } catch (const Error& error) {
        message_ = error.what();
      }
    }
  }
  const int side = hasControl ? -1 : 1;
  if (key == GLFW_KEY_1 || key == GLFW_KEY_KP_1) wishes.axis = side * 1;
  if (key == GLFW_KEY_3 || key == GLFW_KEY_KP_3) wishes.axis = side * 2;
  if (key == GLFW_KEY_7 || key == GLFW_KEY_KP_7) wishes.axis = side * 3;
  if (key == GLFW_KEY_N) goToNextPlace(side);
  if (hasControl) return obey(wishes);
  if (key == GLFW_KEY_F) wishes.frame = true;
  if (key == GLFW_KEY_S) wishes.picture = true;
  if (key == GLFW_KEY_R) wishes.record = true;
  if (key == GLFW_KEY_C) state.cut.isOn = !state.cut.isOn;
  if (key == GLFW_KEY_X) state.slice.isOn = !state.slice.isOn;
  if (key == GLFW_KEY_O) state.isOtherOverlaid = !state.isOtherOverlaid;
  if (key == GLFW_KEY_W) state.mesh = MeshStyle((int(state.mesh) + 1) % 3);
  if (key == GLFW_KEY_B && other()) state.isSecondShown = !state.isSecondShown;
  if (key == GLFW_KEY_V) chooseNextColours();
  if (key == GLFW_KEY_D) state.areDefectsShown = !state.areDefectsShown;
  if (key == GLFW_KEY_SPACE) state.isPlaying = !state.isPlaying;
  if (key == GLFW_KEY_M) state.isMeasuring = !state.isMeasuring;
  if (key == GLFW_KEY_P) state.isPanelShown = !state.isPanelShown;
  if (key == GLFW_KEY_H) state.isHelpShown = !state.isHelpShown;
  if (key == GLFW_KEY_Q) window_.close();
  obey(wishes);
}

/// Moves the cut, or else the slice, so that it follows the cursor.
void Viewer::movePlane(const glm::dvec2& drag) {
  ViewState& state = options_.state;
  MovingPlane& plane = state.cut.isOn ? state.cut : state.slice;
  if (!plane.isOn) return;
  const glm::dvec3 centre = content().bounds.centre();
  const glm::dvec3 on = centre + (plane.offset - glm::dot(plane.normal, centre)) * plane.normal;
  const double unit = 1e-3 * glm::length(content().bounds.size());
  const glm::dvec3 from = camera_.project(on, pictureSize()),
                   to = camera_.project(on + unit * plane.normal, pictureSize());
  const glm::dvec2 along(to.x - from.x, to.y - from.y);
  const double length2 = glm::dot(along, along);
  // Seen along its normal, a plane does not move across the window: up is towards the eye.
  const double steps = length2 > 0.01 ? glm::dot(drag, along) / length2 : -drag.y * 2.0;
  plane.offset += unit * steps;
}

void Viewer::take(Window::Mouse mouse) {
  using Kind = Window::Mouse::Kind;
  mouse.cursor.x -= left();
  const bool isOverPanel = ImGui::GetIO().WantCaptureMouse;
  const glm::dvec2 moved = mouse.cursor - std::exchange(cursor_, mouse.cursor);
  if (mouse.kind == Kind::Press && !isOverPanel) {
    if (!drag_) drag_ = Drag{.start = mouse};
  } else if (mouse.kind == Kind::Release && drag_ && drag_->start.button == mouse.button) {
    if (drag_->length < 3.0 && mouse.button == GLFW_MOUSE_BUTTON_LEFT) click();
    drag_.reset();
  } else if (mouse.kind == Kind::Wheel && !isOverPanel) {
    camera_.zoom(std::pow(0.88, mouse.wheel), mouse.cursor, pictureSize());
  } else if (mouse.kind == Kind::Move && drag_) {
    drag_->length += glm::length(moved);
    if (drag_->start.button != GLFW_MOUSE_BUTTON_LEFT || drag_->start.hasShift)
      camera_.pan(moved, pictureSize());
    else if (drag_->start.hasControl)
      movePlane(moved);
    else
      camera_.orbit(moved, pictureSize());
  }
  placeCamera();
}

/// Looks at the point that was clicked on twice, or notes it to measure.
void Viewer::click() {
  const Clock::time_point now = Clock::now();
  const bool isSecond = now - std::exchange(lastClick_, now) < std::chrono::milliseconds(400);
  if (!probed_) return;
  if (options_.state.isMeasuring) {
    if (measured_.size() == 2) measured_.clear();
    measured_.push_back(probed_->position);
  } else if (isSecond) {
    camera_.lookAt(probed_->position);
  }
}

void Viewer::obey(const Wishes& wishes) {
  if (wishes.frame) camera_.frame(content().bounds, pictureSize());
  if (wishes.axis != 0) {
    glm::dvec3 direction(0.0);
    direction[std::abs(wishes.axis) - 1] = wishes.axis > 0 ? -1.0 : 1.0;
    camera_.lookAlong(direction);
  }
  if (wishes.place) defects().choose(*wishes.place);
  if (wishes.place) goToPlace();
  if (wishes.nextPlace) goToNextPlace(1);
  placeCamera();
  keepColours();
  if (wishes.picture) isPictureWanted_ = true;
  if (wishes.copy) {
    window_.copy(command());
    message_ = "copied: " + command();
  }
  if (wishes.clip) show(options_.input, options_.other, true);
  if (!wishes.record) return;
  if (recorder_) return endRecord();
  try {
    recorder_ = options_.record(pictureSize().width, pictureSize().height, options_.fps);
  } catch (const Error& error) {
    message_ = error.what();
  }
}

/// Looks at the chosen place of defects from as near as its surroundings are of use.
void Viewer::goToPlace() {
  const DefectPlace* place = defects().place();
  if (!place) return;
  constexpr double kSurroundings = 2.5, kLeast = 0.03;  // Shares of its own size, and of the mesh's.
  const double size =
      std::max(kSurroundings * place->diameter, kLeast * glm::length(content().bounds.size()));
  camera_.frame({place->centre - 0.5 * size, place->centre + 0.5 * size}, pictureSize());
}

void Viewer::goToNextPlace(int step) {
  defects().chooseNext(step);
  goToPlace();
}

void Viewer::markPlace() const {
  const DefectPlace* place = defects().place();
  if (!place || !options_.state.areDefectsShown) return;
  const glm::dvec3 at = camera_.project(place->centre, pictureSize());
  if (!(at.z > 0.0)) return;
  const glm::dvec3 beside =
      camera_.project(place->centre + 0.5 * place->diameter * camera_.right(), pictureSize());
  constexpr double kLeastRadius = 12.0;
  const double radius = std::max(1.2 * (beside.x - at.x), kLeastRadius), scale = window_.scale();
  ImGui::GetBackgroundDrawList()->AddCircle({float((left() + at.x) / scale), float(at.y / scale)},
                                            float(radius / scale), IM_COL32(214, 30, 40, 255), 0, 2.0F);
}

std::string Viewer::command() const {
  ViewState state = options_.state;
  state.view = view();
  if (content().animated) state.box = boxOf(shown().field.gridFor(state.field));
  state.view.array = options_.state.view.array;
  const bool isSecond = options_.state.isSecondShown;
  return options_.command(path(isSecond), path(!isSecond), state);
}

void Viewer::takePicture(Frame& frame) {
  const VkDeviceSize bytes = VkDeviceSize{4} * picture_.size().width * picture_.size().height;
  if (pixels_.bytes != bytes) {
    gpu_.waitIdle();
    pixels_ = gpu_.makeBuffer(bytes, true);
  }
  picture_.copyPixels(frame.commands(), pixels_);
}

Picture Viewer::readPicture() const {
  Picture picture{.width = int(picture_.size().width), .height = int(picture_.size().height)};
  const auto* pixels = static_cast<const uint32_t*>(pixels_.mapped);
  const size_t count = size_t(picture.width) * size_t(picture.height);
  picture.rgb.reserve(3 * count);
  for (size_t p = 0; p < count; ++p)
    for (const int shift : {0, 8, 16}) picture.rgb.push_back(uint8_t(pixels[p] >> shift));
  return picture;
}

Legend Viewer::legend() const {
  const RenderOptions now = view();
  if (!compared()) return legendOf(now, {});
  const double spacing = shown().field.isReady() ? shown().field.grid().spacing : 1.0;
  return legendOf(now, now.range > 0.0 ? now.range : spacing);
}

/// Returns whether the picture, or its field, is not yet as fine as it will be. One that is played never is.
bool Viewer::isRefining() const {
  return !(options_.state.isPlaying && !isStill()) && !(picture_.isFinished() && shown().field.isCurrent());
}

PanelFigures Viewer::figures() const {
  const LiveField& field = shown().field;
  std::string grid = "no field yet";
  if (field.isReady()) {
    const glm::ivec3 dims = field.grid().dims;
    char text[128];
    std::snprintf(text, sizeof text, "%d x %d x %d%s\nspacing %.4g%s", dims.x, dims.y, dims.z,
                  content().field && content().field->narrow ? ", a narrow band" : "", field.grid().spacing,
                  field.isBusy() ? " ..." : "");
    grid = text;
  }
  std::vector<Frame::Time> times = times_;
  if (field.milliseconds() > 0.0 && !field.isMoved())
    times.insert(times.begin(), {"field (CPU)", field.milliseconds()});
  return {.content = content(),
          .other = other() ? &other()->content : nullptr,
          .defects = defects(),
          .legend = legend(),
          .refined = isRefining() ? std::optional(picture_.share()) : std::nullopt,
          .device = gpu_.name() + (field.isOnDevice() ? ", makes the fields" : ", fields by the CPU"),
          .grid = grid,
          .times = std::move(times),
          .isFieldMoved = field.isMoved(),
          .fieldBytes = field.bytes(),
          .memory = gpu_.memory(),
          .steps = stepsPerRay_,
          .history = history_,
          .message = field.error().empty() ? message_ : field.error(),
          .probed = probed_,
          .measured = measured_};
}

}  // namespace

std::string runViewer(ViewerOptions options) {
  for (int start = 0;; ++start) {
    try {
      Viewer viewer(options);
      viewer.run();
      return viewer.command();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::DeviceLost || start > 0) throw;
    }
  }
}

}  // namespace raymap::view
