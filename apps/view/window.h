#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "camera.h"
#include "gpu.h"
#include "swapchain.h"

struct GLFWwindow;

namespace raymap::view {

/// A window, and what its user did.
class Window {
 public:
  /// Throws `Error(Unsupported)` if there is no display.
  Window(const std::string& title, const WindowSize& size);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Returns the extensions of Vulkan that it needs.
  static std::vector<const char*> extensions();
  VkSurfaceKHR makeSurface(VkInstance instance) const;

  /// Waits for events, so many seconds at most.
  void wait(double seconds);
  bool isClosed() const;
  void close();
  void setTitle(const std::string& title);
  /// Returns its size in pixels.
  VkExtent2D size() const;
  /// Returns whether nothing of it is seen.
  bool isMinimised() const;
  /// Returns the number of pixels of a point, in which the cursor is measured.
  double scale() const;
  /// Returns the text of the clipboard, or sets it.
  void copy(const std::string& text);
  std::string paste() const;

  /// Actions of the mouse.
  struct Mouse {
    enum class Kind { Press, Release, Move, Wheel };
    Kind kind;
    glm::dvec2 cursor{0.0};                     ///< In pixels.
    double wheel = 0.0;                         ///< Notches, away from its user.
    int button = 0;                             ///< GLFW's number.
    bool hasShift = false, hasControl = false;  ///< Keys held during a press.
  };
  /// A key that was pressed.
  struct Key {
    int key;  ///< GLFW's number.
    bool hasControl;
  };
  using Event = std::variant<Key, Mouse>;
  /// Returns what happened to keys and mouse since the last call, first things first. Nothing is lost however
  /// long a frame takes.
  std::vector<Event> takeEvents() { return std::exchange(events_, {}); }
  /// Returns the files that were dropped on it since the last call.
  std::vector<std::filesystem::path> takeDropped() { return std::exchange(dropped_, {}); }
  GLFWwindow* handle() const { return handle_; }

 private:
  GLFWwindow* handle_ = nullptr;
  static Window& of(GLFWwindow* window);
  void note(Mouse mouse);

  glm::dvec2 cursor_{0.0};
  std::vector<Event> events_;
  std::vector<std::filesystem::path> dropped_;
};

/// Dear ImGui in a window.
class Gui {
 public:
  Gui(const Window& window, const Gpu& gpu, const Swapchain& swapchain);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  void begin() const;
  /// Ends the frame's panels, and draws them within a pass of `Swapchain::beginOverlay`.
  void record(VkCommandBuffer commands) const;

 private:
  void uploadFont(const Gpu& gpu) const;

  Owned<VkDescriptorPool> pool_;
};

}  // namespace raymap::view
