#include "viewer/window/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "viewer/window/input_queue.h"

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

/// The keys of one frame: those that go down in it, and those that are down and went down without Control: the keys of
/// a shortcut are none that fly, not even while the letter outlasts Control.
struct Keys {
  struct Press {
    int key = 0;
    bool control = false;
  };
  std::vector<Press> pressed;
  std::bitset<GLFW_KEY_LAST + 1> held;

  void take(const InputEvent& event) {
    const bool control = (event.modifiers & GLFW_MOD_CONTROL) != 0;
    if (event.down && !event.repeated) pressed.push_back({event.code, control});
    if (event.code >= 0 && !event.repeated) held.set(static_cast<std::size_t>(event.code), event.down && !control);
  }
  bool plain(int key) const { return has({key, false}); }
  bool withControl(int key) const { return has({key, true}); }

 private:
  bool has(const Press& wanted) const {
    return std::any_of(pressed.begin(), pressed.end(),
                       [&](const Press& p) { return p.key == wanted.key && p.control == wanted.control; });
  }
};

/// What the window system tells, frame by frame.
struct Hand {
  InputQueue queue;
  double askedAt = 0.0;  ///< seconds: when the window system was asked last
  // As of the present frame.
  Keys keys;
  glm::dvec2 cursor{0.0};
  std::bitset<3> down;
  bool leftDoubleClicked = false;
  InputCounts counts;

  void add(InputEvent event) {
    event.after = askedAt;
    event.before = glfwGetTime();
    queue.add(event);
  }
};

Hand& handOf(GLFWwindow* window) { return *static_cast<Hand*>(glfwGetWindowUserPointer(window)); }

void takeKey(GLFWwindow* window, int key, int scancode, int action, int modifiers) {
  handOf(window).add({.kind = InputEvent::Kind::key,
                      .code = key,
                      .scancode = scancode,
                      .down = action != GLFW_RELEASE,
                      .repeated = action == GLFW_REPEAT,
                      .modifiers = modifiers});
}

void takeLetter(GLFWwindow* window, unsigned letter) {
  handOf(window).add({.kind = InputEvent::Kind::letter, .code = static_cast<int>(letter)});
}

void takeCursor(GLFWwindow* window, double x, double y) { handOf(window).add({.place = {x, y}}); }

void takeButton(GLFWwindow* window, int button, int action, int) {
  if (button < 3) handOf(window).add({.kind = InputEvent::Kind::button, .code = button, .down = action == GLFW_PRESS});
}

void takeWheel(GLFWwindow* window, double x, double y) {
  handOf(window).add({.kind = InputEvent::Kind::wheel, .place = {x, y}});
}

/// The events of this frame, for us and for Dear ImGui.
void takeFrame(GLFWwindow* window, Hand& hand) {
  hand.keys.pressed.clear();
  hand.leftDoubleClicked = false;
  for (const InputEvent& event : hand.queue.takeFrame()) switch (event.kind) {
      case InputEvent::Kind::cursor:
        hand.cursor = event.place;
        break;
      case InputEvent::Kind::button:
        hand.down.set(static_cast<std::size_t>(event.code), event.down);
        hand.leftDoubleClicked = event.doubleClick && event.code == GLFW_MOUSE_BUTTON_LEFT;
        ++hand.counts.buttons;
        break;
      case InputEvent::Kind::wheel:
        ImGui_ImplGlfw_ScrollCallback(window, event.place.x, event.place.y);
        ++hand.counts.wheel;
        break;
      case InputEvent::Kind::key:
        hand.keys.take(event);
        ImGui_ImplGlfw_KeyCallback(window, event.code, event.scancode, event.down ? GLFW_PRESS : GLFW_RELEASE,
                                   event.modifiers);
        if (!event.repeated) ++hand.counts.keys;
        break;
      case InputEvent::Kind::letter:
        ImGui_ImplGlfw_CharCallback(window, static_cast<unsigned>(event.code));
        break;
    }
}

void readKeys(const Keys& keys, WindowInput& input) {
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
  Hand hand;
  ItemPositions places;

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
    ImGui::GetIO().UserData = &places;
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 6.0f;
    ImGui::GetStyle().FrameRounding = 3.0f;
    ImGui::GetStyle().Colors[ImGuiCol_PopupBg].w = 1.0f;  // a list's items are read, not what lies behind them
    const float scale = contentScale(window);
    ImGui::GetStyle().ScaleAllSizes(scale);
    ImFontConfig font;
    font.SizePixels = std::round(kTextHeight * scale);
    ImGui::GetIO().Fonts->AddFontDefault(&font);
    glfwSetWindowUserPointer(window, &hand);
    glfwGetCursorPos(window, &hand.cursor.x, &hand.cursor.y);
    glfwSetKeyCallback(window, takeKey);
    glfwSetCharCallback(window, takeLetter);
    glfwSetMouseButtonCallback(window, takeButton);
    glfwSetCursorPosCallback(window, takeCursor);
    glfwSetScrollCallback(window, takeWheel);
    ImGui_ImplGlfw_InitForOpenGL(window, false);
    glfwSetCursorEnterCallback(window, ImGui_ImplGlfw_CursorEnterCallback);
    glfwSetWindowFocusCallback(window, ImGui_ImplGlfw_WindowFocusCallback);
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
  Hand& hand = parts_->hand;
  if (waitSeconds > 0.0 && hand.queue.empty())
    glfwWaitEventsTimeout(waitSeconds);
  else
    glfwPollEvents();
  hand.askedAt = glfwGetTime();
  takeFrame(parts_->window, hand);
  parts_->places.clear();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  // Dear ImGui's own hand knows only how things stand by now.
  for (std::size_t i = 0; i < hand.down.size(); ++i) io.MouseDown[i] = hand.down[i];
  if (ImGui::IsMousePosValid(&io.MousePos) || hand.down.any())
    io.MousePos = {static_cast<float>(hand.cursor.x), static_cast<float>(hand.cursor.y)};
  ImGui::NewFrame();

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
    input.wheel = static_cast<double>(io.MouseWheel);
    input.doubleClicked = hand.leftDoubleClicked;
    input.clicked = io.MouseReleased[0] && io.MouseDragMaxDistanceSqr[0] < kClickPx * kClickPx;
  }
  if (!io.WantCaptureKeyboard) readKeys(hand.keys, input);
  if (hand.keys.withControl(GLFW_KEY_Q)) glfwSetWindowShouldClose(parts_->window, GLFW_TRUE);
  input.moreWaits = !hand.queue.empty();
  return input;
}

const InputCounts& Window::inputCounts() const { return parts_->hand.counts; }

glm::dvec2 Window::cursor() const { return parts_->hand.cursor; }

const ItemPositions& Window::itemPositions() const { return parts_->places; }

bool Window::focused() const { return glfwGetWindowAttrib(parts_->window, GLFW_FOCUSED) == GLFW_TRUE; }

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
