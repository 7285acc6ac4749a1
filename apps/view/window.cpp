#include "window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>
#include <raymap/error.h>

#include "look.h"

namespace raymap::view {

namespace {

std::string glfwMessage() {
  const char* message = nullptr;
  glfwGetError(&message);
  return message ? message : "unknown reason";
}

}  // namespace

Window::Window(const std::string& title, const WindowSize& size) {
  if (!glfwInit())
    throw Error(ErrorCode::Unsupported,
                "a window cannot be opened: " + glfwMessage() + "; raymap render draws without one");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  handle_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
  if (!handle_) {
    const std::string why = glfwMessage();
    glfwTerminate();
    throw Error(ErrorCode::Unsupported, "a window cannot be opened: " + why);
  }
  glfwSetWindowUserPointer(handle_, this);
  // Dear ImGui calls these when it has its own in place.
  glfwSetKeyCallback(handle_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
    if (action != GLFW_RELEASE)
      of(window).events_.emplace_back(Key{key, (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_SUPER)) != 0});
  });
  glfwSetMouseButtonCallback(handle_, [](GLFWwindow* window, int button, int action, int modifiers) {
    of(window).note({.kind = action == GLFW_PRESS ? Mouse::Kind::Press : Mouse::Kind::Release,
                     .button = button,
                     .hasShift = (modifiers & GLFW_MOD_SHIFT) != 0,
                     .hasControl = (modifiers & GLFW_MOD_CONTROL) != 0});
  });
  // The cursor's place is that of the event: by now, it may be elsewhere.
  glfwSetCursorPosCallback(handle_, [](GLFWwindow* window, double x, double y) {
    of(window).cursor_ = of(window).scale() * glm::dvec2(x, y);
    of(window).note({.kind = Mouse::Kind::Move});
  });
  glfwSetScrollCallback(handle_, [](GLFWwindow* window, double, double wheel) {
    of(window).note({.kind = Mouse::Kind::Wheel, .wheel = wheel});
  });
  glfwSetDropCallback(handle_, [](GLFWwindow* window, int count, const char** paths) {
    of(window).dropped_.assign(paths, paths + count);
  });
}

Window& Window::of(GLFWwindow* window) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

/// Adds where the cursor is.
void Window::note(Mouse mouse) {
  mouse.cursor = cursor_;
  events_.emplace_back(mouse);
}

Window::~Window() {
  glfwDestroyWindow(handle_);
  glfwTerminate();
}

std::vector<const char*> Window::extensions() {
  uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names)
    throw Error(ErrorCode::Unsupported, "Vulkan has no windows here: " + glfwMessage() +
                                            "; install a GPU's driver, or mesa-vulkan-drivers");
  return {names, names + count};
}

VkSurfaceKHR Window::makeSurface(VkInstance instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  check(glfwCreateWindowSurface(instance, handle_, nullptr, &surface), "connecting Vulkan to the window");
  return surface;
}

void Window::wait(double seconds) {
  if (seconds > 0.0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}

bool Window::isClosed() const {
  return glfwWindowShouldClose(handle_) != 0;
}

void Window::close() {
  glfwSetWindowShouldClose(handle_, GLFW_TRUE);
}

void Window::setTitle(const std::string& title) {
  glfwSetWindowTitle(handle_, title.c_str());
}

VkExtent2D Window::size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(handle_, &width, &height);
  return {uint32_t(width), uint32_t(height)};
}

bool Window::isMinimised() const {
  const VkExtent2D now = size();
  return now.width == 0 || now.height == 0 || glfwGetWindowAttrib(handle_, GLFW_ICONIFIED) != 0;
}

double Window::scale() const {
  int width = 1, height = 1;
  glfwGetWindowSize(handle_, &width, &height);
  return width > 0 ? double(size().width) / width : 1.0;
}

void Window::copy(const std::string& text) {
  glfwSetClipboardString(handle_, text.c_str());
}

std::string Window::paste() const {
  const char* text = glfwGetClipboardString(handle_);
  return text ? text : "";
}

Gui::Gui(const Window& window, const Gpu& gpu, const Swapchain& swapchain) {
  const VkDescriptorPoolSize font{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
  const VkDescriptorPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                            .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                            .maxSets = 4,
                                            .poolSizeCount = 1,
                                            .pPoolSizes = &font};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(gpu.device(), &poolInfo, nullptr, &pool), "making descriptors");
  pool_ = own(gpu.device(), pool, vkDestroyDescriptorPool);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // Nothing is written to the folder where it runs.
  float scale = 1.0F;
  glfwGetWindowContentScale(window.handle(), &scale, nullptr);
  setLook(RAYMAP_VIEW_FONT, scale, window.scale());
  ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = gpu.handles().instance;
  info.PhysicalDevice = gpu.handles().physical;
  info.Device = gpu.device();
  info.QueueFamily = gpu.handles().queueFamily;
  info.Queue = gpu.handles().queue;
  info.DescriptorPool = pool;
  info.MinImageCount = 2;
  info.ImageCount = std::max(swapchain.count(), 2u);
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = [](VkResult result) { check(result, "drawing the panels"); };
#if IMGUI_VERSION_NUM >= 19030
  info.RenderPass = swapchain.overlay();
  ImGui_ImplVulkan_Init(&info);
#else
  ImGui_ImplVulkan_Init(&info, swapchain.overlay());
#endif
#if IMGUI_VERSION_NUM < 19000  // Later ones do it themselves.
  uploadFont(gpu);
#endif
}

#if IMGUI_VERSION_NUM < 19000
void Gui::uploadFont(const Gpu& gpu) const {
  const VkCommandPoolCreateInfo poolInfo{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                         .queueFamilyIndex = gpu.handles().queueFamily};
  VkCommandPool pool = VK_NULL_HANDLE;
  check(vkCreateCommandPool(gpu.device(), &poolInfo, nullptr, &pool), "making a command pool");
  const Owned<VkCommandPool> owned = own(gpu.device(), pool, vkDestroyCommandPool);
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool,
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(gpu.device(), &info, &commands), "making a command buffer");
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check(vkBeginCommandBuffer(commands, &begin), "recording");
  ImGui_ImplVulkan_CreateFontsTexture(commands);
  check(vkEndCommandBuffer(commands), "recording");
  const VkSubmitInfo submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
  check(vkQueueSubmit(gpu.handles().queue, 1, &submit, VK_NULL_HANDLE), "giving work to the device");
  gpu.waitIdle();
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}
#endif

Gui::~Gui() {
  ImGui_ImplVulkan_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Gui::begin() const {
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Gui::record(VkCommandBuffer commands) const {
  ImGui::Render();
  ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
}

}  // namespace raymap::view
