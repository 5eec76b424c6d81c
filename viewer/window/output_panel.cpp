#include "viewer/window/output_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>

#include "core/readable.h"
#include "viewer/output/picture_taker.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/widgets.h"

namespace strata {
namespace {

constexpr float kWidth = 24.0f;    // of the panel, in letter heights
constexpr double kTellTime = 2.0;  // seconds before the panel says how long it will take
constexpr int kLargestFilmSide = 7680;

void inputSize(const char* name, int& width, int& height, int largest) {
  const float each = 0.5f * (ImGui::CalcItemWidth() - ImGui::GetStyle().ItemInnerSpacing.x);
  ImGui::PushID(name);
  ImGui::SetNextItemWidth(each);
  if (ImGui::InputInt("##width", &width, 0)) width = std::clamp(width, 1, largest);
  noteItem(std::string(name) + " width");
  ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
  ImGui::SetNextItemWidth(each);
  if (ImGui::InputInt("##height", &height, 0)) height = std::clamp(height, 1, largest);
  noteItem(std::string(name) + " height");
  ImGui::SameLine(0.0f, ImGui::GetStyle().ItemInnerSpacing.x);
  ImGui::TextUnformatted(name);
  ImGui::PopID();
}

void drawPictureSection(OutputState& state, const View& view, OutputRequest& request) {
  inputSize("size", state.pictureWidth, state.pictureHeight, PictureOrder::kLargestSide);
  for (const int times : {1, 2, 4, 8}) {
    char label[16];
    std::snprintf(label, sizeof label, "x %d", times);
    if (times > 1) ImGui::SameLine();
    if (ImGui::SmallButton(label)) {
      state.pictureWidth = std::min(view.width * times, PictureOrder::kLargestSide);
      state.pictureHeight = std::min(view.height * times, PictureOrder::kLargestSide);
    }
  }
  ImGui::SameLine();
  ImGui::TextDisabled("the window");
  ImGui::Checkbox("points as wide as on the screen", &state.scalePoints);
  inputText("file", state.pictureFile);
  if (ImGui::Button("take the picture")) request.takePicture = true;
}

void drawKeys(OutputState& state, const View& view, OutputRequest& request) {
  const std::vector<CameraKey>& keys = state.path.keys();
  if (keys.empty()) {
    ImGui::TextDisabled("No keys yet: K sets one here, R records.");
    return;
  }
  std::optional<std::size_t> removed;
  const float line = ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild(
      "keys",
      ImVec2(kWidth * ImGui::GetFontSize(), line * static_cast<float>(std::min<std::size_t>(keys.size(), 6) + 1)),
      true);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    ImGui::AlignTextToFramePadding();
    ImGui::Text("%2d", static_cast<int>(i) + 1);
    ImGui::SameLine();
    if (i > 0) {
      float step = static_cast<float>(keys[i].t - keys[i - 1].t);
      ImGui::SetNextItemWidth(5.0f * ImGui::GetFontSize());
      if (ImGui::DragFloat("##step", &step, 0.05f, 0.05f, 600.0f, "+ %.2f s"))
        state.path.setStep(i, static_cast<double>(step));
    } else {
      ImGui::Dummy(ImVec2(5.0f * ImGui::GetFontSize(), 1.0f));
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("go"))
      request.goTo = viewAt(state.path.path(view.fovY, state.fps), keys[i].t, view.width, view.height);
    ImGui::SameLine();
    if (ImGui::SmallButton("set here")) state.path.replaceKey(i, view);
    ImGui::SameLine();
    if (ImGui::SmallButton("remove")) removed = i;
    ImGui::PopID();
  }
  ImGui::EndChild();
  if (removed) state.path.removeKey(*removed);
}

void drawPathSection(OutputState& state, const View& view, OutputRequest& request) {
  if (ImGui::Button("set key (K)")) state.path.addKey(view);
  ImGui::SameLine();
  request.record = ImGui::Button(state.path.recording() ? "stop recording (R)" : "record (R)");
  ImGui::SameLine();
  request.play = ImGui::Button(state.playing ? "stop (space)" : "play (space)");
  drawKeys(state, view, request);
  if (const auto& keys = state.path.keys(); !keys.empty())
    ImGui::Text("%d keys, %.1f s", static_cast<int>(keys.size()), keys.back().t);
  ImGui::SameLine();
  if (ImGui::SmallButton("clear")) state.path.setKeys({});
  inputText("path", state.pathFile);
  request.savePath = ImGui::Button("save path");
  ImGui::SameLine();
  request.openPath = ImGui::Button("open path");
  if (!state.benchCommand.empty()) {
    ImGui::TextWrapped("%s", state.benchCommand.c_str());
    if (ImGui::SmallButton("copy the command")) ImGui::SetClipboardText(state.benchCommand.c_str());
  }
}

void drawFilmSection(OutputState& state, OutputRequest& request) {
  inputSize("film size", state.filmWidth, state.filmHeight, kLargestFilmSide);
  float fps = static_cast<float>(state.fps);
  if (ImGui::DragFloat("frames per second", &fps, 0.1f, 1.0f, 240.0f, "%.0f")) state.fps = static_cast<double>(fps);
  inputText("film", state.filmFile);
  request.takeFilm = ImGui::Button("make the film");
  noteItem("make the film");
}

}  // namespace

OutputRequest drawOutputPanel(OutputState& state, const View& view) {
  OutputRequest request;
  if (!state.open) return request;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * display.x, 0.12f * display.y), ImGuiCond_FirstUseEver, ImVec2(0.5f, 0.0f));
  if (ImGui::Begin("Pictures and paths", &state.open,
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::PushItemWidth(0.6f * kWidth * ImGui::GetFontSize());
    if (sectionHeader("Picture", true)) drawPictureSection(state, view, request);
    if (sectionHeader("Camera path", true)) drawPathSection(state, view, request);
    if (!state.path.keys().empty() && sectionHeader("Film of the path", false)) drawFilmSection(state, request);
    ImGui::PopItemWidth();
  }
  ImGui::End();
  return request;
}

bool drawWorkProgress(const std::string& what, double share, double seconds) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5f * display.x, 0.5f * display.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  bool cancelled = false;
  if (ImGui::Begin("At work", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse)) {
    ImGui::TextUnformatted(what.c_str());
    ImGui::ProgressBar(static_cast<float>(share), ImVec2(kWidth * ImGui::GetFontSize(), 0.0f));
    if (share > 0.0 && seconds > kTellTime)
      ImGui::Text("%s left", readableMs(1000.0 * seconds * (1.0 - share) / share).c_str());
    else
      ImGui::TextUnformatted(" ");
    cancelled = ImGui::Button("cancel (Escape)");
  }
  ImGui::End();
  return cancelled;
}

}  // namespace strata
