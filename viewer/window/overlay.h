#pragma once
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "core/view.h"

namespace strata {

// Lines, dots and texts over the picture and below the panels, at places of the scan; between Window::beginFrame() and
// finishFrame(). Colours are R | G<<8 | B<<16 | A<<24. What lies behind the eye is not drawn. Widths and radii are
// pixels on an ordinary screen.

/// How much larger letters are than on an ordinary screen; sizes of panels go with it.
float uiScale();

inline constexpr std::uint32_t kOverlayShade = 0xaa000000u;

void overlayLine(const View& view, const glm::dvec3& a, const glm::dvec3& b, std::uint32_t colour, float widthPx);
/// The same with a dark rim.
void overlayRimmedLine(const View& view, const glm::dvec3& a, const glm::dvec3& b, std::uint32_t colour);
void overlayDot(const View& view, const glm::dvec3& place, std::uint32_t colour, float radiusPx);
void overlayRing(const View& view, const glm::dvec3& place, std::uint32_t colour, float radiusPx);
/// Above the place, on a dark ground; nothing where the text is empty.
void overlayText(const View& view, const glm::dvec3& place, const std::string& text, std::uint32_t colour);

}  // namespace strata
