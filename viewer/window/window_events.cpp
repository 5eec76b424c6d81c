#include "viewer/window/window_events.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui/backends/imgui_impl_glfw.h>

namespace strata {

using Kind = InputEvent::Kind;

WindowEvents::WindowEvents(GLFWwindow* window) : window_(window) {
  glfwSetWindowUserPointer(window, this);
  glfwGetCursorPos(window, &cursor_.x, &cursor_.y);
  setCallbacks();
}

WindowEvents& WindowEvents::of(GLFWwindow* window) {
  return *static_cast<WindowEvents*>(glfwGetWindowUserPointer(window));
}

void WindowEvents::setCallbacks() {
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int modifiers) {
    of(window).add({.kind = Kind::key,
                    .code = key,
                    .scancode = scancode,
                    .down = action != GLFW_RELEASE,
                    .repeated = action == GLFW_REPEAT,
                    .modifiers = modifiers});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned letter) {
    of(window).add({.kind = Kind::letter, .code = static_cast<int>(letter)});
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
    if (button < 3) of(window).add({.kind = Kind::button, .code = button, .down = action == GLFW_PRESS});
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    of(window).add({.kind = Kind::cursor, .place = {x, y}});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) {
    of(window).add({.kind = Kind::wheel, .place = {x, y}});
  });
  glfwSetCursorEnterCallback(window_, ImGui_ImplGlfw_CursorEnterCallback);
  glfwSetWindowFocusCallback(window_, ImGui_ImplGlfw_WindowFocusCallback);
}

void WindowEvents::add(InputEvent event) {
  event.after = askedAt_;
  event.before = glfwGetTime();
  queue_.add(event);
}

void WindowEvents::beginFrame(double waitSeconds) {
  if (waitSeconds > 0.0 && queue_.empty())
    glfwWaitEventsTimeout(waitSeconds);
  else
    glfwPollEvents();
  askedAt_ = glfwGetTime();
  keyboard_.beginFrame();
  leftDoubleClicked_ = false;
  for (const InputEvent& event : queue_.takeFrame()) take(event);
}

void WindowEvents::take(const InputEvent& event) {
  switch (event.kind) {
    case Kind::cursor:
      cursor_ = event.place;
      break;
    case Kind::button:
      buttonsDown_.set(static_cast<std::size_t>(event.code), event.down);
      leftDoubleClicked_ = event.doubleClick && event.code == GLFW_MOUSE_BUTTON_LEFT;
      ++counts_.buttons;
      break;
    case Kind::wheel:
      ImGui_ImplGlfw_ScrollCallback(window_, event.place.x, event.place.y);
      ++counts_.wheel;
      break;
    case Kind::key:
      keyboard_.take(event);
      ImGui_ImplGlfw_KeyCallback(window_, event.code, event.scancode, event.down ? GLFW_PRESS : GLFW_RELEASE,
                                 event.modifiers);
      if (!event.repeated) ++counts_.keys;
      break;
    case Kind::letter:
      ImGui_ImplGlfw_CharCallback(window_, static_cast<unsigned>(event.code));
      break;
  }
}

void WindowEvents::placeMouse() const {
  ImGuiIO& io = ImGui::GetIO();
  // Dear ImGui's backend has asked GLFW for the newest state of the mouse, which later frames are still to see.
  for (std::size_t i = 0; i < buttonsDown_.size(); ++i) io.MouseDown[i] = buttonsDown_[i];
  if (ImGui::IsMousePosValid(&io.MousePos) || buttonsDown_.any())
    io.MousePos = {static_cast<float>(cursor_.x), static_cast<float>(cursor_.y)};
}

}  // namespace strata
