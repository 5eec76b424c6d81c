#include "viewer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <algorithm>

#include "core/error.h"

namespace strata {
namespace {

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

// Dear ImGui names keys itself since 1.87 and by GLFW's numbers before.
#if IMGUI_VERSION_NUM >= 18700
ImGuiKey keyOf(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) return static_cast<ImGuiKey>(ImGuiKey_A + (key - GLFW_KEY_A));
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) return static_cast<ImGuiKey>(ImGuiKey_0 + (key - GLFW_KEY_0));
  if (key == GLFW_KEY_ENTER) return ImGuiKey_Enter;
  if (key == GLFW_KEY_KP_ENTER) return ImGuiKey_KeypadEnter;
  if (key == GLFW_KEY_BACKSPACE) return ImGuiKey_Backspace;
  if (key == GLFW_KEY_ESCAPE) return ImGuiKey_Escape;
  if (key == GLFW_KEY_F1) return ImGuiKey_F1;
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
    return static_cast<ImGuiKey>(ImGuiKey_Keypad0 + (key - GLFW_KEY_KP_0));
  return ImGuiKey_None;
}
#else
int keyOf(int key) { return key; }
#endif

bool pressed(int key) { return ImGui::IsKeyPressed(keyOf(key), false); }
int held(int key) { return ImGui::IsKeyDown(keyOf(key)) ? 1 : 0; }

void readKeys(WindowInput& input) {
  input.frameAll = pressed(GLFW_KEY_F);
  input.front = pressed(GLFW_KEY_1) || pressed(GLFW_KEY_KP_1);
  input.side = pressed(GLFW_KEY_3) || pressed(GLFW_KEY_KP_3);
  input.top = pressed(GLFW_KEY_7) || pressed(GLFW_KEY_KP_7);
  input.orthographic = pressed(GLFW_KEY_O);
  input.keep = pressed(GLFW_KEY_ENTER) || pressed(GLFW_KEY_KP_ENTER);
  input.takeBack = pressed(GLFW_KEY_BACKSPACE);
  input.drop = pressed(GLFW_KEY_ESCAPE);
  input.save = ImGui::GetIO().KeyCtrl && pressed(GLFW_KEY_S);
  input.measure = pressed(GLFW_KEY_M);
  input.profile = pressed(GLFW_KEY_X);
  input.clipBox = pressed(GLFW_KEY_B);
  input.help = pressed(GLFW_KEY_H) || pressed(GLFW_KEY_F1);
  if (ImGui::GetIO().KeyCtrl) return;  // no flying with a shortcut
  input.fly.forward = held(GLFW_KEY_W) - held(GLFW_KEY_S);
  input.fly.right = held(GLFW_KEY_D) - held(GLFW_KEY_A);
  input.fly.up = held(GLFW_KEY_E) - held(GLFW_KEY_Q);
  input.fly.fast = ImGui::GetIO().KeyShift;
}

}  // namespace

struct Window::Parts {
  GLFWwindow* window = nullptr;

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
  input.seconds = std::min(static_cast<double>(io.DeltaTime), kLongestStep);
  input.cursor = glm::dvec2(io.MousePos.x * io.DisplayFramebufferScale.x, io.MousePos.y * io.DisplayFramebufferScale.y);
  input.dragging = io.MouseDown[0] || io.MouseDown[1];
  if (!io.WantCaptureMouse) {
    input.leftPressed = io.MouseClicked[0];
    input.rightPressed = io.MouseClicked[1];
    input.wheel = static_cast<double>(io.MouseWheel);
    input.doubleClicked = io.MouseDoubleClicked[0];
    input.clicked = io.MouseReleased[0] && io.MouseDragMaxDistanceSqr[0] < kClickPx * kClickPx;
  }
  if (!io.WantCaptureKeyboard) readKeys(input);
  if (io.KeyCtrl && pressed(GLFW_KEY_Q)) glfwSetWindowShouldClose(parts_->window, GLFW_TRUE);
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
