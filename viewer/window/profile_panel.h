#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/draw_options.h"
#include "core/picture.h"
#include "viewer/tools/measurement.h"
#include "viewer/tools/profile_picture.h"
#include "viewer/window/picture_texture.h"
#include "viewer/window/profile_reader.h"

namespace strata {

/// The window that shows one profile: its picture with scales, the point under the cursor, how deep the stores were
/// read and why not deeper. For the render thread, with the window's context current.
class ProfilePanel {
 public:
  explicit ProfilePanel(GlContext::GetProc getProc) : texture_(getProc) {}

  /// Opens the window for `profile`, one of the measurements.
  void show(const Measurement& profile);
  bool open() const { return !line_.empty(); }
  bool reading() const { return reader_.pending(); }

  struct Outcome {
    std::optional<glm::dvec3> pointed;  ///< the point under the cursor, in the world
    std::string csv;                    ///< text that the user wants to save; empty: none
    std::string name;                   ///< of the profile
    std::string failure;                ///< why reading failed, told once
  };
  /// Draws the window where it is open; between Window::beginFrame() and finishFrame(). Changes the profile's width in
  /// `kept`, and closes the window when the profile is no longer there. Begins to read again when `stores`, the width
  /// or the depth have changed.
  Outcome draw(std::vector<Measurement>& kept, const std::vector<std::shared_ptr<const Store>>& stores,
               const DrawOptions& options);

 private:
  /// Everything that decides which points a profile has.
  struct Question {
    double width = 0.0;
    int depth = ProfileOptions::kDeepest;
    std::uint64_t mostPoints = ProfileOptions{}.mostPoints;
    std::vector<std::shared_ptr<const Store>> stores;

    bool operator==(const Question&) const = default;
  };
  /// Everything that decides how the picture looks.
  struct Look {
    ProfileWindow window;
    ColourMode colour{};
    int pointSize = 0;
    glm::vec2 intensity{0.0f};
    glm::dvec2 elevation{0.0};
    glm::u8vec3 background{0};
    std::bitset<256> classes;
    std::uint64_t serial = 0;  ///< of the profile

    bool operator==(const Look&) const = default;
  };

  void drawControls(Measurement& profile, Outcome& outcome, const DrawOptions& options);
  void drawPicture(const DrawOptions& options, Outcome& outcome);
  void drawScales(const glm::vec2& corner) const;

  std::vector<glm::dvec3> line_;  ///< of the profile that is shown; empty: the window is closed
  Question wanted_, asked_;
  ProfileReader reader_;
  Profile profile_;
  std::uint64_t serial_ = 0;  ///< counts the profiles shown
  double stretch_ = 1.0;
  std::optional<ProfileWindow> window_;  ///< the part that is shown; none: all of it
  Look look_;
  Picture picture_;
  PictureTexture texture_;
};

}  // namespace strata
