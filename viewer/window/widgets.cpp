#include "viewer/window/widgets.h"

#include <imgui.h>

#include <cstdio>

#include "viewer/window/item_positions.h"

namespace strata {

bool inputText(const char* label, std::string& text) {
  char buffer[4096];
  std::snprintf(buffer, sizeof buffer, "%s", text.c_str());
  if (!ImGui::InputText(label, buffer, sizeof buffer)) return false;
  text = buffer;
  return true;
}

bool sectionHeader(const char* name, bool openAtFirst) {
  const bool open = ImGui::CollapsingHeader(name, openAtFirst ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  noteItem(name);
  return open;
}

void namedValue(const char* name, const std::string& value, float column) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(column);
  ImGui::TextUnformatted(value.c_str());
}

}  // namespace strata
