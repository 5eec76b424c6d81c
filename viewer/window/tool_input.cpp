#include "viewer/window/tool_input.h"

#include "viewer/tools/pick.h"

namespace strata {
namespace {

constexpr int kClickReach = 6;  // pixels: a click this near to a point means it

/// The world point under the cursor; where there is none, the nearest that a click would reach.
std::optional<glm::dvec3> pointUnder(const View& view, const Picture& picture, const glm::dvec2& cursor) {
  const auto pixel = drawnPixelAt(picture, cursor, kClickReach);
  if (!pixel) return std::nullopt;
  const glm::dvec2 place = glm::ivec2(glm::floor(cursor)) == *pixel ? cursor : glm::dvec2(*pixel) + 0.5;
  const float depth = picture.depth[static_cast<std::size_t>(pixel->y) * static_cast<std::size_t>(picture.width) +
                                    static_cast<std::size_t>(pixel->x)];
  return worldPoint(view, place, static_cast<double>(depth));
}

void moveByHand(CameraControl& control, ClipTool& clip, const WindowInput& input, const Picture& picture) {
  const auto under = [&] { return pointUnder(control.view(), picture, input.cursor); };
  const MouseInput& mouse = input.mouse;
  if (mouse.leftPressed && clip.press(control.view(), input.cursor))
    control.release();
  else if (mouse.leftPressed)
    control.pressLeft(input.cursor, under());
  if (mouse.rightPressed) control.pressRight(input.cursor, under());
  if (mouse.dragging && clip.held())
    clip.move(control.view(), input.cursor);
  else if (mouse.dragging)
    control.move(input.cursor);
  if (!mouse.dragging) control.release();
  if (mouse.wheel != 0.0) control.wheel(mouse.wheel, input.cursor, under());
  if (!input.fly.still()) control.fly(input.fly, input.seconds);
}

}  // namespace

void steer(CameraControl& control, ToolsState& tools, const WindowInput& input, const ScreenContent& seen) {
  control.resize(input.width, input.height);
  control.advance(input.seconds);
  moveByHand(control, tools.clip, input, seen.picture);
  const View& view = control.view();
  if (input.has(Command::showAll)) control.glideTo(framed(view, seen.bounds));
  if (input.has(Command::viewFront)) control.glideTo(standardView(view, seen.bounds, StandardView::front));
  if (input.has(Command::viewSide)) control.glideTo(standardView(view, seen.bounds, StandardView::side));
  if (input.has(Command::viewTop)) control.glideTo(standardView(view, seen.bounds, StandardView::top));
  if (input.has(Command::nextMoveMode)) control.setMode(nextMode(control.mode()));
  if (input.has(Command::togglePerspective)) control.setView(withOrthographic(view, !view.orthographic));
  if (input.mouse.doubleClicked && !tools.measure.active())
    if (const auto point = pointUnder(view, seen.picture, input.cursor)) control.glideTo(approached(view, *point));
}

std::string ToolInput::use(ToolsState& tools, const WindowInput& input, const View& view, const ScreenContent& seen) {
  if (input.has(Command::measureDistance)) tools.measure.begin(MeasureKind::distance);
  if (input.has(Command::measureProfile)) tools.measure.begin(MeasureKind::profile);
  if (input.has(Command::addClipBox)) tools.clip.add(boxInView(view, seen.bounds));
  if (input.has(Command::takeBack)) tools.measure.undo();
  if (input.has(Command::cancel)) tools.measure.cancel();
  const bool onHandle = tools.clip.held().has_value();
  if (!input.mouse.dragging) tools.clip.release();
  if (input.mouse.clicked && !onHandle && seen.list != nullptr) {
    if (const auto point = drawnPointAt(*seen.list, seen.picture, input.cursor, kClickReach)) {
      lookup_.ask(seen.layers.stores()[seen.layers.indexOfItem(point->item)], seen.list->items[point->item].index,
                  point->point);
    }
  }
  std::string error;
  if (const auto answer = lookup_.take()) {
    error = answer->error;
    if (error.empty()) {
      tools.picked = answer->point;
      tools.measure.add(answer->point.position);
    }
  }
  if (input.has(Command::finish) ||
      (input.mouse.doubleClicked && tools.measure.active() && isOpenEnded(tools.measure.current()->kind)))
    endMeasuring_ = true;
  if (endMeasuring_ && !lookup_.pending()) {
    tools.measure.finish();
    endMeasuring_ = false;
  }
  tools.lookingUp = lookup_.pending();
  return error;
}

}  // namespace strata
