#include "io/table/header_lines.h"

#include "core/error.h"
#include "io/table/text_lines.h"

namespace strata {

bool HeaderLines::next() {
  const std::size_t end = head_.find('\n', bytes_);
  if (end == std::string_view::npos) return false;
  splitColumns(head_.substr(bytes_, end - bytes_), words_);
  bytes_ = end + 1;
  ++lines_;
  return true;
}

void HeaderLines::fail(const std::string& what) const {
  throw Error(file_, "line " + std::to_string(lines_) + ": " + what);
}

}  // namespace strata
