#include "io/store/store.h"

#include <cerrno>
#include <filesystem>
#include <limits>
#include <utility>

#include "core/error.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

std::unique_ptr<ByteSource> openPoints(const std::string& path) {
  if (!std::filesystem::exists(path)) throw posixError(path, "opening", ENOENT);
  if (!std::filesystem::exists(path + "/" + kInfoFile))
    throw Error(path, std::string("is no store: it has no ") + kInfoFile);
  return openFile(path + "/" + kPointsFile);
}

}  // namespace

Store::Store(const std::string& path) : Store(path, openPoints(path)) {}

Store::Store(const std::string& path, std::unique_ptr<ByteSource> points) : path_(path), points_(std::move(points)) {
  const std::string json = readBeginning(*openFile(path + "/" + kInfoFile), std::numeric_limits<std::uint64_t>::max());
  info_ = parseStoreInfo(path + "/" + kInfoFile, json);
  checkPointsHeader(*points_);
  hierarchy_ = readHierarchy(path, info_, json, points_->size());
}

Store::Store(StoreInfo info, Hierarchy hierarchy, std::unique_ptr<ByteSource> points)
    : path_("memory"), info_(std::move(info)), hierarchy_(std::move(hierarchy)), points_(std::move(points)) {}

}  // namespace strata
