#pragma once
#include <map>
#include <string>

#include <glm/glm.hpp>

namespace strata {

/// The centres of the panels' items that are visible in this frame, window units, by name. Scripts find the items by
/// them (`--state`).
using ItemPositions = std::map<std::string, glm::dvec2>;

/// Notes the position of the item that Dear ImGui drew last, where it is visible. Needs a Window.
void noteItem(const std::string& name);

}  // namespace strata
