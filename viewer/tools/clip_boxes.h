#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "core/box.h"
#include "core/draw_options.h"
#include "core/view.h"

namespace strata {

/// A box that the user cuts the scan with.
struct ClipBox {
  std::string name;
  Box box;
  bool cutout = false;  ///< hides what is inside; else what is outside
  bool on = true;

  bool operator==(const ClipBox& other) const {
    return name == other.name && box.min == other.box.min && box.max == other.box.max && cutout == other.cutout &&
           on == other.on;
  }
};

/// What of the boxes is on, for drawing, with `planes` beside it. At most Clip::kMost boxes count.
Clip clipOf(const std::vector<ClipBox>& boxes, const std::vector<glm::dvec4>& planes);

/// A box in the middle of what `view` shows of `bounds`: a third of the picture's height wide, cut to the bounds.
Box boxInView(const View& view, const Box& bounds);

/// The twelve edges, as pairs of corners.
std::vector<std::pair<glm::dvec3, glm::dvec3>> edgesOf(const Box& box);

/// Where a box is taken hold of.
enum class ClipHandle { left, right, front, back, bottom, top, centre };
inline constexpr int kClipHandles = 7;
/// In the middle of the face (-x, +x, -y, +y, -z, +z) or of the box.
glm::dvec3 handlePlace(const Box& box, ClipHandle handle);

/// The box after its handle was dragged from one pixel to another. A face moves along its axis, by as much as the
/// nearest points of that axis to the lines of sight through the two pixels are apart; it stops a thousandth of the
/// box's size before the opposite one, and does not move where the axis is seen end-on. The centre takes the box along
/// in parallel to the picture.
Box draggedBox(const Box& box, ClipHandle handle, const View& view, const glm::dvec2& from, const glm::dvec2& to);

/// The boxes of a session and the handle that is dragged now.
class ClipTool {
 public:
  static constexpr double kReachPx = 9.0;  ///< from a handle that still means it

  std::vector<ClipBox>& boxes() { return boxes_; }
  const std::vector<ClipBox>& boxes() const { return boxes_; }
  /// Named "box 1" and so on. False where there are Clip::kMost already.
  bool add(const Box& box);
  void remove(std::size_t index);

  struct Grip {
    std::size_t box;
    ClipHandle handle;

    bool operator==(const Grip&) const = default;
  };
  /// The handle of a box that is on within kReachPx of the cursor; of several the nearest to the cursor.
  std::optional<Grip> gripAt(const View& view, const glm::dvec2& cursor) const;

  /// Takes hold of the handle there. False where there is none: the press is for somebody else.
  bool press(const View& view, const glm::dvec2& cursor);
  /// True when the box has changed.
  bool move(const View& view, const glm::dvec2& cursor);
  void release() { held_.reset(); }
  /// The handle that is held; nothing where none is.
  const std::optional<Grip>& held() const { return held_; }

 private:
  std::vector<ClipBox> boxes_;
  std::optional<Grip> held_;
  Box start_;                ///< the box when the handle was taken
  glm::dvec2 pressed_{0.0};  ///< where
};

}  // namespace strata
