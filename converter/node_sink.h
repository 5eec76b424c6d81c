#pragma once
#include <string>
#include <vector>

#include "converter/node_builder.h"
#include "io/output_file.h"

namespace strata {

/// points.bin and the records of what is in it. Used by one thread at a time; the order of the calls is the order of
/// the file.
class NodeSink {
 public:
  explicit NodeSink(const std::string& folder);
  void write(std::vector<BuiltNode> nodes);
  /// Completes points.bin and returns the records linked in breadth-first order.
  Hierarchy finish();
  std::uint64_t bytes() const { return file_.size() + buffer_.size(); }

 private:
  OutputFile file_;
  std::vector<std::byte> buffer_;
  std::vector<NodeRecord> records_;
};

}  // namespace strata
