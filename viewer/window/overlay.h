#pragma once
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "core/view.h"

namespace strata {

// Lines, dots and texts at places of the scan, over the picture and below the panels; between Window::beginFrame() and
// finishFrame(). Places are world coordinates, colours R | G<<8 | B<<16 | A<<24, widths and radii pixels of an ordinary
// screen. Whatever lies behind the eye is left out.

/// How much larger letters are than on an ordinary screen. Sizes of panels are multiplied by it.
float uiScale();

void overlayLine(const View& view, const glm::dvec3& a, const glm::dvec3& b, std::uint32_t colour, float widthPx);
/// The same line with a dark rim.
void overlayRimmedLine(const View& view, const glm::dvec3& a, const glm::dvec3& b, std::uint32_t colour);
void overlayDot(const View& view, const glm::dvec3& place, std::uint32_t colour, float radiusPx);
void overlayRing(const View& view, const glm::dvec3& place, std::uint32_t colour, float radiusPx);
/// A text above the place, on a dark ground. Draws nothing where it is empty.
void overlayText(const View& view, const glm::dvec3& place, const std::string& text, std::uint32_t colour);

}  // namespace strata
