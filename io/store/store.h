#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "core/node_key.h"
#include "io/file/byte_source.h"
#include "io/store/hierarchy.h"
#include "io/store/store_info.h"

namespace strata {

/// A converted scan, opened for reading. It never changes after its constructor, so any thread may use any member.
///
/// The bytes of a store are defined by four headers and described in docs/format.md: store_info.h (store.json),
/// hierarchy.h (hierarchy.bin), store_files.h (the headers of the files) and node_payload.h (points.bin).
class Store {
 public:
  /// `path` is NAME.strata. Throws Error when it is no store, has another version, or its files do not fit together.
  explicit Store(const std::string& path);
  /// The same, with `points` in the place of the file points.bin; for tests.
  Store(const std::string& path, std::unique_ptr<ByteSource> points);
  /// A store whose parts are in memory already. Nothing is checked.
  Store(StoreInfo info, Hierarchy hierarchy, std::unique_ptr<ByteSource> points);

  const std::string& path() const { return path_; }
  const StoreInfo& info() const { return info_; }
  const Hierarchy& hierarchy() const { return hierarchy_; }
  const ByteSource& points() const { return *points_; }

 private:
  std::string path_;
  StoreInfo info_;
  Hierarchy hierarchy_;
  std::unique_ptr<ByteSource> points_;
};

}  // namespace strata
