#include "viewer/window/profile_panel.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/readable.h"
#include "viewer/session/class_census.h"
#include "viewer/tools/pick.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/overlay.h"

namespace strata {
namespace {

constexpr float kLeastPicture = 40.0f;  // pixels
constexpr float kTickGap = 70.0f;       // pixels between marks of the scales, at least
constexpr double kZoomPerNotch = 0.85;
constexpr int kReach = 6;  // pixels: a cursor this near to a point means it
constexpr float kFewestPoints = 1e4f, kMostPoints = 2e7f;
constexpr ImU32 kGridLine = IM_COL32(255, 255, 255, 28);
constexpr ImU32 kGridText = IM_COL32(255, 255, 255, 150);
constexpr ImU32 kMark = IM_COL32(64, 200, 255, 255);

std::string pointText(const Profile& profile, const ProfilePoint& p) {
  char text[120];
  std::snprintf(text, sizeof text, "%.3f m along, height %s", p.along,
                gridNumber(p.position.z, profile.step.z).c_str());
  std::string all = std::string(text) + "   |   " + gridNumber(p.position.x, profile.step.x) + " " +
                    gridNumber(p.position.y, profile.step.y) + "   |   " + std::to_string(p.classification) + " " +
                    className(p.classification) + ", intensity " + std::to_string(p.intensity);
  return all;
}

}  // namespace

void ProfilePanel::show(const Measurement& profile) {
  line_ = profile.points;
  asked_ = {};
  profile_ = {};
  window_.reset();
  ++serial_;
}

ProfilePanel::Outcome ProfilePanel::draw(std::vector<Measurement>& kept,
                                         const std::vector<std::shared_ptr<const Store>>& stores,
                                         const DrawOptions& options) {
  Outcome outcome;
  if (!open()) return outcome;
  const auto found = std::find_if(kept.begin(), kept.end(), [&](const Measurement& m) {
    return m.kind == MeasureKind::profile && m.points == line_;
  });
  bool stay = found != kept.end();
  if (stay) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float height = std::min(320.0f * uiScale(), 0.45f * size.y);
    ImGui::SetNextWindowPos(ImVec2(12.0f, size.y - height - 12.0f), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSize(ImVec2(size.x - 24.0f, height), ImGuiCond_FirstUseEver);
    if (ImGui::Begin((found->name + "###profile").c_str(), &stay, ImGuiWindowFlags_NoScrollbar)) {
      drawControls(*found, outcome, options);
      drawPicture(options, outcome);
    }
    ImGui::End();
    outcome.name = found->name;
    wanted_.width = found->width;
    wanted_.stores = stores;
  }
  if (!stay) {
    line_.clear();
    return outcome;
  }
  if (!(wanted_ == asked_)) {
    asked_ = wanted_;
    ProfileSlab slab;
    for (const glm::dvec3& p : line_) slab.line.emplace_back(p.x, p.y);
    slab.width = wanted_.width;
    reader_.ask(stores, slab, {wanted_.depth, wanted_.mostPoints});
  }
  if (std::optional<Profile> read = reader_.take()) {
    profile_ = std::move(*read);
    outcome.failure = profile_.failure;
    ++serial_;
  }
  return outcome;
}

void ProfilePanel::drawControls(Measurement& profile, Outcome& outcome, const DrawOptions& options) {
  ImGui::PushItemWidth(110.0f * uiScale());
  const double least = 1e-3, most = 1e6;
  ImGui::DragScalar("wide", ImGuiDataType_Double, &profile.width, static_cast<float>(0.01 * profile.width), &least,
                    &most, "%.3g m", ImGuiSliderFlags_AlwaysClamp);
  ImGui::SameLine();
  int levels = 1;
  for (const auto& store : wanted_.stores) levels = std::max(levels, store->info().levels);
  int depth = std::min(wanted_.depth, levels);
  if (ImGui::SliderInt("##depth", &depth, 0, levels, depth >= levels ? "all depths" : "to depth %d"))
    wanted_.depth = depth >= levels ? ProfileOptions::kDeepest : depth;
  ImGui::SameLine();
  float limit = static_cast<float>(wanted_.mostPoints);
  if (ImGui::SliderFloat("##limit", &limit, kFewestPoints, kMostPoints,
                         ("at most " + readableCount(static_cast<double>(limit))).c_str(),
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput))
    wanted_.mostPoints = static_cast<std::uint64_t>(std::llround(limit));
  ImGui::SameLine();
  float stretch = static_cast<float>(stretch_);
  if (ImGui::SliderFloat("##stretch", &stretch, 1.0f, 50.0f, "heights x %.1f", ImGuiSliderFlags_Logarithmic)) {
    stretch_ = static_cast<double>(stretch);
    window_.reset();
  }
  ImGui::PopItemWidth();
  ImGui::SameLine();
  if (ImGui::Button("all")) window_.reset();
  ImGui::SameLine();
  if (ImGui::Button("save CSV")) outcome.csv = profileCsv(profile_, options.classes);
  ImGui::SameLine();
  if (reader_.pending())
    ImGui::TextDisabled("reading ... %s points", readableCount(static_cast<double>(reader_.found())).c_str());
  else
    ImGui::TextDisabled("%s", profileText(profile_).c_str());
}

void ProfilePanel::drawPicture(const DrawOptions& options, Outcome& outcome) {
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float lineHeight = ImGui::GetTextLineHeightWithSpacing();
  const ImVec2 size(std::max(room.x, kLeastPicture), std::max(room.y - lineHeight, kLeastPicture));
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const int width = static_cast<int>(size.x), height = static_cast<int>(size.y);
  ProfileWindow window =
      window_ ? resizedProfile(*window_, width, height) : fitProfile(profile_, width, height, stretch_);
  ImGui::InvisibleButton("picture", size, ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
  noteItem("profile");
  const glm::dvec2 cursor(static_cast<double>(io.MousePos.x - corner.x), static_cast<double>(io.MousePos.y - corner.y));
  if (ImGui::IsItemActive() && (io.MouseDelta.x != 0.0f || io.MouseDelta.y != 0.0f))
    window_ = window = pannedProfile(window, {io.MouseDelta.x, io.MouseDelta.y});
  if (ImGui::IsItemHovered() && io.MouseWheel != 0.0f)
    window_ = window = zoomedProfile(window, cursor, std::pow(kZoomPerNotch, static_cast<double>(io.MouseWheel)));
  const Look look{window,
                  options.colour,
                  options.pointSize,
                  options.intensityRange,
                  options.elevationRange,
                  options.background,
                  options.classes,
                  serial_};
  if (!(look == look_)) {
    look_ = look;
    strata::drawProfile(profile_, window, options, picture_);
    texture_.upload(picture_);
  }
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  canvas->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture_.id())), corner,
                   ImVec2(corner.x + size.x, corner.y + size.y));
  drawScales({corner.x, corner.y});
  const auto id = ImGui::IsItemHovered() ? profilePointAt(picture_, cursor, kReach) : std::nullopt;
  if (!id) {
    ImGui::TextDisabled("move the cursor to a point to read it; the wheel zooms, a drag moves");
    return;
  }
  const ProfilePoint& point = profile_.points[*id];
  const glm::dvec2 at = pixelOfProfile(window, {point.along, point.position.z});
  canvas->AddCircle(ImVec2(corner.x + static_cast<float>(at.x), corner.y + static_cast<float>(at.y)), 6.0f, kMark, 0,
                    2.0f);
  outcome.pointed = point.position;
  ImGui::TextUnformatted(pointText(profile_, point).c_str());
}

void ProfilePanel::drawScales(const glm::vec2& corner) const {
  const ProfileWindow& window = look_.window;
  ImDrawList* canvas = ImGui::GetWindowDrawList();
  const float right = corner.x + static_cast<float>(window.width), below = corner.y + static_cast<float>(window.height);
  char text[32];
  const glm::dvec2 first = metresAt(window, {0.0, window.height}), last = metresAt(window, {window.width, 0.0});
  const auto label = [&](double value, double step) {
    if (std::abs(value) < 1e-6 * step) value = 0.0;  // no "-0"
    std::snprintf(text, sizeof text, step < 0.01 ? "%.3f" : step < 1.0 ? "%.2f" : "%.0f", value);
  };
  const double step = niceStep(static_cast<double>(kTickGap * uiScale()) * window.metresPerPixel.x);
  for (double x = std::ceil(first.x / step) * step; x < last.x; x += step) {
    const float at = corner.x + static_cast<float>(pixelOfProfile(window, {x, 0.0}).x);
    canvas->AddLine({at, corner.y}, {at, below}, kGridLine);
    label(x, step);
    canvas->AddText({at + 3.0f, below - 16.0f * uiScale()}, kGridText, text);
  }
  const double rise = niceStep(0.6 * static_cast<double>(kTickGap * uiScale()) * window.metresPerPixel.y);
  for (double z = std::ceil(first.y / rise) * rise; z < last.y; z += rise) {
    const float at = corner.y + static_cast<float>(pixelOfProfile(window, {0.0, z}).y);
    canvas->AddLine({corner.x, at}, {right, at}, kGridLine);
    label(z, rise);
    canvas->AddText({corner.x + 3.0f, at - 15.0f * uiScale()}, kGridText, text);
  }
}

}  // namespace strata
