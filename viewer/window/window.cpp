#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <optional>
#include <vector>

#include "core/error.h"

namespace strata {
namespace {

constexpr float kTextHeight = 13.0f;  // pixels, on an ordinary screen
constexpr float kClickPx = 4.0f;      // a button that goes up this near to where it went down has clicked
constexpr double kLongestStep = 0.1;  // seconds a flight moves in one frame, however long the frame took

Error windowError() {
  const char* description = nullptr;
  glfwGetError(&description);
  return Error("window", std::string("cannot be opened: ") + (description != nullptr ? description : "unknown reason"));
}

GLFWwindow* openWindow(const std::string& title, int width, int height, bool visible) {
  // compute32 needs 4.3; drawing on the CPU and showing the picture does with 3.3.
  constexpr int kVersions[][2] = {{4, 3}, {3, 3}};
  for (const auto& version : kVersions) {
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, version[0]);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, version[1]);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
    if (GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr)) return window;
  }
  return nullptr;
}

/// How much larger than on an ordinary screen letters should be: 2 on most of those with many pixels.
float contentScale(GLFWwindow* window) {
  float x = 1.0f, y = 1.0f;
  glfwGetWindowContentScale(window, &x, &y);
  // Where the framebuffer has more pixels than the window has units, Dear ImGui draws larger by itself.
  int width = 0, framebufferWidth = 0;
  glfwGetWindowSize(window, &width, nullptr);
  glfwGetFramebufferSize(window, &framebufferWidth, nullptr);
  const float own = width > 0 ? static_cast<float>(framebufferWidth) / static_cast<float>(width) : 1.0f;
  return std::clamp(std::max(x, y) / std::max(own, 0.1f), 1.0f, 4.0f);
}

/// What went down since the last frame, however briefly, and where: Dear ImGui before 1.87 only knows what is down at a
/// frame and where the cursor is then. And which keys are down that went down without Control: those of a shortcut are
/// none that fly, not even while their letter outlasts Control.
struct Presses {
  struct Press {
    int key = 0;
    bool control = false;
  };
  std::vector<Press> keys;
  std::bitset<GLFW_KEY_LAST + 1> held;
  glm::dvec2 cursor{0.0};              ///< when the last event came, window units
  std::optional<glm::dvec2> buttonAt;  ///< where a mouse button went down

  bool plain(int key) const { return has({key, false}); }
  bool withControl(int key) const { return has({key, true}); }

 private:
  bool has(const Press& wanted) const {
    return std::any_of(keys.begin(), keys.end(),
                       [&](const Press& p) { return p.key == wanted.key && p.control == wanted.control; });
  }
};

void takeKey(GLFWwindow* window, int key, int, int action, int modifiers) {
  auto* presses = static_cast<Presses*>(glfwGetWindowUserPointer(window));
  const bool control = (modifiers & GLFW_MOD_CONTROL) != 0;
  if (action == GLFW_PRESS) presses->keys.push_back({key, control});
  if (key >= 0 && action != GLFW_REPEAT)
    presses->held.set(static_cast<std::size_t>(key), action == GLFW_PRESS && !control);
}

void takeCursor(GLFWwindow* window, double x, double y) {
  static_cast<Presses*>(glfwGetWindowUserPointer(window))->cursor = {x, y};
}

void takeButton(GLFWwindow* window, int, int action, int) {
  auto* presses = static_cast<Presses*>(glfwGetWindowUserPointer(window));
  if (action == GLFW_PRESS) presses->buttonAt = presses->cursor;
}

void readKeys(const Presses& keys, WindowInput& input) {
  input.frameAll = keys.plain(GLFW_KEY_F);
  input.front = keys.plain(GLFW_KEY_1) || keys.plain(GLFW_KEY_KP_1);
  input.side = keys.plain(GLFW_KEY_3) || keys.plain(GLFW_KEY_KP_3);
  input.top = keys.plain(GLFW_KEY_7) || keys.plain(GLFW_KEY_KP_7);
  input.orthographic = keys.plain(GLFW_KEY_O);
  input.keep = keys.plain(GLFW_KEY_ENTER) || keys.plain(GLFW_KEY_KP_ENTER);
  input.takeBack = keys.plain(GLFW_KEY_BACKSPACE);
  input.drop = keys.plain(GLFW_KEY_ESCAPE);
  input.save = keys.withControl(GLFW_KEY_S);
  input.measure = keys.plain(GLFW_KEY_M);
  input.profile = keys.plain(GLFW_KEY_X);
  input.clipBox = keys.plain(GLFW_KEY_B);
  input.help = keys.plain(GLFW_KEY_H) || keys.plain(GLFW_KEY_F1);
  input.pictures = keys.plain(GLFW_KEY_P);
  input.takePicture = keys.withControl(GLFW_KEY_P);
  input.pathKey = keys.plain(GLFW_KEY_K);
  input.record = keys.plain(GLFW_KEY_R);
  input.play = keys.plain(GLFW_KEY_SPACE);
  input.nextMode = keys.plain(GLFW_KEY_G);
  if (ImGui::GetIO().KeyCtrl) return;  // no flying with a shortcut
  const auto held = [&keys](std::size_t key) { return keys.held[key] ? 1 : 0; };
  input.fly.forward = held(GLFW_KEY_W) - held(GLFW_KEY_S);
  input.fly.right = held(GLFW_KEY_D) - held(GLFW_KEY_A);
  input.fly.up = held(GLFW_KEY_E) - held(GLFW_KEY_Q);
  input.fly.fast = ImGui::GetIO().KeyShift;
}

}  // namespace

struct Window::Parts {
  GLFWwindow* window = nullptr;
  Presses presses;

  Parts(const std::string& title, int width, int height, bool visible) {
    if (glfwInit() != GLFW_TRUE) throw windowError();
    window = openWindow(title, width, height, visible);
    if (window == nullptr) {
      const Error error = windowError();
      glfwTerminate();
      throw error;
    }
    glfwMakeContextCurrent(window);
    glfwSwapInterval(visible ? 1 : 0);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 6.0f;
    const float scale = contentScale(window);
    ImGui::GetStyle().ScaleAllSizes(scale);
    ImFontConfig font;
    font.SizePixels = std::round(kTextHeight * scale);
    ImGui::GetIO().Fonts->AddFontDefault(&font);
    glfwSetWindowUserPointer(window, &presses);
    glfwGetCursorPos(window, &presses.cursor.x, &presses.cursor.y);
    glfwSetKeyCallback(window, takeKey);  // before Dear ImGui's, which call these
    glfwSetMouseButtonCallback(window, takeButton);
    glfwSetCursorPosCallback(window, takeCursor);
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330");
  }
  ~Parts() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window);
    glfwTerminate();
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
};

Window::Window(const std::string& title, int width, int height, bool visible)
    : parts_(std::make_unique<Parts>(title, width, height, visible)) {}

Window::~Window() = default;

bool Window::closed() const { return glfwWindowShouldClose(parts_->window) == GLFW_TRUE; }

WindowInput Window::beginFrame(double waitSeconds) {
  parts_->presses.keys.clear();
  parts_->presses.buttonAt.reset();
  if (waitSeconds > 0.0)
    glfwWaitEventsTimeout(waitSeconds);
  else
    glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();

  const ImGuiIO& io = ImGui::GetIO();
  WindowInput input;
  glfwGetFramebufferSize(parts_->window, &input.width, &input.height);
  // X11 leaves a minimised window its size.
  input.hidden = input.width == 0 || input.height == 0 ||
                 glfwGetWindowAttrib(parts_->window, GLFW_ICONIFIED) == GLFW_TRUE ||
                 glfwGetWindowAttrib(parts_->window, GLFW_VISIBLE) == GLFW_FALSE;
  input.seconds = std::min(static_cast<double>(io.DeltaTime), kLongestStep);
  const glm::dvec2 pixels(io.DisplayFramebufferScale.x, io.DisplayFramebufferScale.y);  // in a window unit
  input.cursor = pixels * glm::dvec2(io.MousePos.x, io.MousePos.y);
  input.dragging = io.MouseDown[0] || io.MouseDown[1];
  if (!io.WantCaptureMouse) {
    input.leftPressed = io.MouseClicked[0];
    input.rightPressed = io.MouseClicked[1];
    // A hand that moves on before a slow frame begins has still pressed where it pressed; the next frame moves.
    if ((input.leftPressed || input.rightPressed) && parts_->presses.buttonAt)
      input.cursor = pixels * *parts_->presses.buttonAt;
    input.wheel = static_cast<double>(io.MouseWheel);
    input.doubleClicked = io.MouseDoubleClicked[0];
    input.clicked = io.MouseReleased[0] && io.MouseDragMaxDistanceSqr[0] < kClickPx * kClickPx;
  }
  if (!io.WantCaptureKeyboard) readKeys(parts_->presses, input);
  if (parts_->presses.withControl(GLFW_KEY_Q)) glfwSetWindowShouldClose(parts_->window, GLFW_TRUE);
  return input;
}

bool Window::panelInUse() const { return ImGui::IsAnyItemActive() || ImGui::GetIO().WantTextInput; }

void Window::drawPicture(unsigned texture) {
  ImGui::GetBackgroundDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)),
                                           ImVec2(0.0f, 0.0f), ImGui::GetIO().DisplaySize);
}

void Window::finishFrame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::present() { glfwSwapBuffers(parts_->window); }

GlContext::GetProc Window::getProc() {
  return [](const char* name) -> GlContext::Function { return glfwGetProcAddress(name); };
}

}  // namespace strata
