#include "io/file/part_file.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace strata {

PartFile::PartFile(const std::string& path) : path_(path), part_(path + ".part"), file_(std::in_place, part_) {}

PartFile::~PartFile() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void PartFile::keep() {
  file_->finish();
  std::error_code failure;
  std::filesystem::rename(part_, path_, failure);
  if (failure) throw Error(path_, "renaming " + part_ + ": " + failure.message());
  file_.reset();
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  syncFolder(folder.empty() ? "." : folder.string());
}

}  // namespace strata
