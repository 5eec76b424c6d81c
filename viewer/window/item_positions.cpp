#include "viewer/window/item_positions.h"

#include <imgui.h>

namespace strata {

void noteItem(const std::string& name) {
  auto* places = static_cast<ItemPositions*>(ImGui::GetIO().UserData);
  if (places == nullptr || !ImGui::IsItemVisible()) return;
  const ImVec2 a = ImGui::GetItemRectMin(), b = ImGui::GetItemRectMax();
  (*places)[name] = {0.5 * static_cast<double>(a.x + b.x), 0.5 * static_cast<double>(a.y + b.y)};
}

}  // namespace strata
