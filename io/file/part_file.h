#pragma once
#include <optional>
#include <string>

#include "io/file/output_file.h"

namespace strata {

/// A file that is written as `PATH.part` and gets its name when it is complete. Unless keep() was called, the
/// destructor removes it.
class PartFile {
 public:
  explicit PartFile(const std::string& path);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  OutputFile& operator*() { return *file_; }
  OutputFile* operator->() { return &*file_; }
  /// Makes the file durable and gives it its name. Throws Error.
  void keep();

 private:
  std::string path_;
  std::string part_;
  std::optional<OutputFile> file_;
};

}  // namespace strata
