#pragma once
#include <map>
#include <string>

#include <glm/glm.hpp>

namespace strata {

/// Middles of the items of the panels that can be seen in this frame, window units, by name.
using ItemPositions = std::map<std::string, glm::dvec2>;

/// Notes where the item stands that Dear ImGui drew last.
void noteItem(const std::string& name);

}  // namespace strata
