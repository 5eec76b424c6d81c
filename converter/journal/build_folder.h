#pragma once
#include <string>

namespace strata {

/// points.bin with normals, beside the one without normals until it takes that one's name.
inline constexpr const char* kNewPointsFile = "points-normals.bin";

/// Throws Error when a store cannot be made at `output`: when something lies there that may not be replaced, or the
/// parent folder is missing. With `force` a store may be replaced, but only a folder that holds the three files of a
/// store and nothing else.
void checkOutput(const std::string& output, bool force);

/// The folder that a store is built in, `OUTPUT.building`, locked against other conversions. The destructor removes it
/// unless it has become the store or keep() was called. Failures throw Error.
class BuildFolder {
 public:
  /// Takes over what an interrupted conversion left there with `resume`, removes it with `force`, and throws Error
  /// about it otherwise.
  BuildFolder(const std::string& output, bool force, bool resume);
  ~BuildFolder();
  BuildFolder(const BuildFolder&) = delete;
  BuildFolder& operator=(const BuildFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string journalPath() const { return path_ + "/journal"; }
  std::string spillPath() const { return path_ + "/spill"; }
  /// The name that points.bin waits under while the one with normals has its name and the store is not complete.
  std::string builtPointsPath() const { return path_ + "/points.built"; }
  /// Renames the file at builtPointsPath(), if there is one, back to points.bin.
  void putBackBuiltPoints();
  /// From now on the destructor leaves the folder for another conversion to resume.
  void keep(bool kept = true) { kept_ = kept; }
  /// Gives the folder its final name in one step, and ends keep(). Throws Error, and leaves everything alone, when
  /// something that may not be replaced has appeared under that name.
  void publish();

 private:
  const std::string output_;
  const std::string path_;
  const bool force_;
  bool kept_ = false;
  int lock_ = -1;
};

}  // namespace strata
