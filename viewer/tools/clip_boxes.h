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
  bool cutout = false;  ///< true: points inside are hidden; false: points outside
  bool on = true;

  bool operator==(const ClipBox& other) const {
    return name == other.name && box.min == other.box.min && box.max == other.box.max && cutout == other.cutout &&
           on == other.on;
  }
};

/// The boxes that are on and `planes`, as drawing takes them. At most Clip::kMost boxes count.
Clip clipOf(const std::vector<ClipBox>& boxes, const std::vector<glm::dvec4>& planes);

/// A box in the middle of the part of `bounds` that `view` shows. It is as wide as a third of the picture's height, and
/// cut to the bounds.
Box boxInView(const View& view, const Box& bounds);

/// The twelve edges, as pairs of corners.
std::vector<std::pair<glm::dvec3, glm::dvec3>> edgesOf(const Box& box);

/// The places where the user takes hold of a box.
enum class ClipHandle { left, right, front, back, bottom, top, centre };
inline constexpr int kClipHandles = 7;
/// The middle of the handle's face (-x, +x, -y, +y, -z, +z), or of the box.
glm::dvec3 handlePlace(const Box& box, ClipHandle handle);

/// The box after its handle was dragged from one pixel to another. A face moves along its axis, by as much as the
/// nearest points of that axis to the lines of sight through the two pixels are apart; it stops a thousandth of the
/// box's size before the opposite one, and does not move where the axis is seen end-on. The centre takes the box along
/// in parallel to the picture.
Box draggedBox(const Box& box, ClipHandle handle, const View& view, const glm::dvec2& from, const glm::dvec2& to);

/// The boxes of a session and the handle that is dragged now.
class ClipTool {
 public:
  static constexpr double kReachPx = 9.0;  ///< how far from a handle a click may be, pixels

  std::vector<ClipBox>& boxes() { return boxes_; }
  const std::vector<ClipBox>& boxes() const { return boxes_; }
  /// Adds a box with the name "box 1" and so on. Returns false when there are Clip::kMost boxes already.
  bool add(const Box& box);
  void remove(std::size_t index);

  struct Grip {
    std::size_t box;
    ClipHandle handle;

    bool operator==(const Grip&) const = default;
  };
  /// The handle nearest to the cursor among the boxes that are on, if it is within kReachPx.
  std::optional<Grip> gripAt(const View& view, const glm::dvec2& cursor) const;

  /// Takes hold of the handle at the cursor. Returns false when there is none, so that the press means something else.
  bool press(const View& view, const glm::dvec2& cursor);
  /// Drags the held handle to the cursor. Returns true when the box has changed.
  bool move(const View& view, const glm::dvec2& cursor);
  void release() { held_.reset(); }
  /// The handle that is held, if any.
  const std::optional<Grip>& held() const { return held_; }

 private:
  std::vector<ClipBox> boxes_;
  std::optional<Grip> held_;
  Box start_;                ///< the box when the handle was taken
  glm::dvec2 pressed_{0.0};  ///< the cursor at that moment
};

}  // namespace strata
