#pragma once
#include <string>

namespace strata {

// What several panels draw alike; between Window::beginFrame() and finishFrame().

/// A field for one line of text, at most 4095 bytes. True when the text was changed.
bool inputText(const char* label, std::string& text);

/// A section that opens and closes with a click on its name, which noteItem() gets too. True while it is open.
bool sectionHeader(const char* name, bool openAtFirst);

/// A name and, `column` to the right of the panel's left edge, its value.
void namedValue(const char* name, const std::string& value, float column);

}  // namespace strata
