#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/error.h"

namespace strata {
namespace {

constexpr float kTextHeight = 13.0f;  // pixels, on an ordinary screen
constexpr float kClickPx = 4.0f;      // a button that goes up this near to where it went down has clicked
constexpr double kLongestStep = 0.1;  // seconds that a flight moves in one frame, however long the frame took

Error windowError() {
  const char* description = nullptr;
  glfwGetError(&description);
  return Error("window", std::string("cannot be opened: ") + (description != nullptr ? description : "unknown reason"));
}

/// GLFW, a window of it, and that window's context, current in this thread.
class GlfwWindow {
 public:
  GlfwWindow(const std::string& title, int width, int height, bool visible) {
    if (glfwInit() != GLFW_TRUE) throw windowError();
    // compute32 needs OpenGL 4.3; the CPU rasterizer and showing the picture are content with 3.3.
    constexpr int kVersions[][2] = {{4, 3}, {3, 3}};
    for (const auto& version : kVersions) {
      glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, version[0]);
      glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, version[1]);
      glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
      glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
      window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
      if (window_ != nullptr) break;
    }
    if (window_ == nullptr) {
      const Error error = windowError();
      glfwTerminate();
      throw error;
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(visible ? 1 : 0);
  }
  ~GlfwWindow() {
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;

  GLFWwindow* get() const { return window_; }

 private:
  GLFWwindow* window_ = nullptr;
};

/// How much larger letters should be than on an ordinary screen: 2 on most screens with many pixels.
float contentScale(GLFWwindow* window) {
  float x = 1.0f, y = 1.0f;
  glfwGetWindowContentScale(window, &x, &y);
  // Dear ImGui already draws larger where the framebuffer has more pixels than the window has units.
  int width = 0, framebufferWidth = 0;
  glfwGetWindowSize(window, &width, nullptr);
  glfwGetFramebufferSize(window, &framebufferWidth, nullptr);
  const float own = width > 0 ? static_cast<float>(framebufferWidth) / static_cast<float>(width) : 1.0f;
  return std::clamp(std::max(x, y) / std::max(own, 0.1f), 1.0f, 4.0f);
}

/// Dear ImGui in a window, in our style. noteItem() finds `positions` through it.
class Gui {
 public:
  Gui(GLFWwindow* window, ItemPositions& positions) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::GetIO().UserData = &positions;
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 6.0f;
    ImGui::GetStyle().FrameRounding = 3.0f;
    ImGui::GetStyle().Colors[ImGuiCol_PopupBg].w = 1.0f;  // the items of a list are hard to read over anything else
    const float scale = contentScale(window);
    ImGui::GetStyle().ScaleAllSizes(scale);
    ImFontConfig font;
    font.SizePixels = std::round(kTextHeight * scale);
    ImGui::GetIO().Fonts->AddFontDefault(&font);
    ImGui_ImplGlfw_InitForOpenGL(window, false);  // WindowEvents hands on what the callbacks say
    ImGui_ImplOpenGL3_Init("#version 330");
  }
  ~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
};

MouseInput mouseInput(const WindowEvents& events) {
  const ImGuiIO& io = ImGui::GetIO();
  MouseInput mouse;
  mouse.dragging = io.MouseDown[0] || io.MouseDown[1];
  if (io.WantCaptureMouse) return mouse;
  mouse.leftPressed = io.MouseClicked[0];
  mouse.rightPressed = io.MouseClicked[1];
  mouse.wheel = static_cast<double>(io.MouseWheel);
  mouse.doubleClicked = events.leftDoubleClicked();
  mouse.clicked = io.MouseReleased[0] && io.MouseDragMaxDistanceSqr[0] < kClickPx * kClickPx;
  return mouse;
}

}  // namespace

struct Window::Parts {
  GlfwWindow window;
  ItemPositions positions;
  Gui gui;
  WindowEvents events;

  Parts(const std::string& title, int width, int height, bool visible)
      : window(title, width, height, visible), gui(window.get(), positions), events(window.get()) {}
};

Window::Window(const std::string& title, int width, int height, bool visible)
    : parts_(std::make_unique<Parts>(title, width, height, visible)) {}

Window::~Window() = default;

bool Window::closed() const { return glfwWindowShouldClose(parts_->window.get()) == GLFW_TRUE; }

WindowInput Window::beginFrame(double waitSeconds) {
  GLFWwindow* const window = parts_->window.get();
  WindowEvents& events = parts_->events;
  events.beginFrame(waitSeconds);
  parts_->positions.clear();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  events.placeMouse();
  ImGui::NewFrame();

  const ImGuiIO& io = ImGui::GetIO();
  WindowInput input;
  glfwGetFramebufferSize(window, &input.width, &input.height);
  // X11 leaves a minimised window its size, so that the size alone does not tell.
  input.hidden = input.width == 0 || input.height == 0 || glfwGetWindowAttrib(window, GLFW_ICONIFIED) == GLFW_TRUE ||
                 glfwGetWindowAttrib(window, GLFW_VISIBLE) == GLFW_FALSE;
  input.seconds = std::min(static_cast<double>(io.DeltaTime), kLongestStep);
  const glm::dvec2 pixels(io.DisplayFramebufferScale.x, io.DisplayFramebufferScale.y);  // per window unit
  input.cursor = pixels * glm::dvec2(io.MousePos.x, io.MousePos.y);
  input.mouse = mouseInput(events);
  const CommandSet commands = events.keyboard().commands();
  if (commands.has(Command::quit)) glfwSetWindowShouldClose(window, GLFW_TRUE);
  if (!io.WantCaptureKeyboard) {
    input.commands = commands;
    if (!io.KeyCtrl) input.fly = events.keyboard().flying(io.KeyShift);
  }
  input.moreWaits = events.moreWaits();
  return input;
}

const InputCounts& Window::inputCounts() const { return parts_->events.counts(); }

glm::dvec2 Window::cursor() const { return parts_->events.cursor(); }

const ItemPositions& Window::itemPositions() const { return parts_->positions; }

bool Window::focused() const { return glfwGetWindowAttrib(parts_->window.get(), GLFW_FOCUSED) == GLFW_TRUE; }

bool Window::panelInUse() const { return ImGui::IsAnyItemActive() || ImGui::GetIO().WantTextInput; }

void Window::drawPicture(unsigned texture) {
  ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                                           ImVec2(0.0f, 0.0f), ImGui::GetIO().DisplaySize);
}

void Window::finishFrame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::present() { glfwSwapBuffers(parts_->window.get()); }

GlContext::GetProc Window::getProc() {
  return [](const char* name) -> GlContext::Function { return glfwGetProcAddress(name); };
}

}  // namespace strata
