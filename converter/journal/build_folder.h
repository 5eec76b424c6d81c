#pragma once
#include <string>

namespace strata {

/// points.bin with normals, beside the one without until it takes that one's name.
inline constexpr const char* kNewPointsFile = "points-normals.bin";

/// Throws Error when a store cannot be made at `output`: something is there that may not be replaced, or no folder
/// holds it. With `force` a store is replaced, but only a folder that holds the three files of a store and nothing
/// else.
void checkOutput(const std::string& output, bool force);

/// The folder that a store is built in, `OUTPUT.building`, locked against other conversions. Removed by the destructor
/// unless it has become the store or keep() was called.
class BuildFolder {
 public:
  /// What an interrupted conversion left there is taken over by `resume`, removed by `force`; without either, Error
  /// tells of it.
  BuildFolder(const std::string& output, bool force, bool resume);
  ~BuildFolder();
  BuildFolder(const BuildFolder&) = delete;
  BuildFolder& operator=(const BuildFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string journalPath() const { return path_ + "/journal"; }
  std::string spillPath() const { return path_ + "/spill"; }
  /// Where points.bin waits while another stands in its place until the store is complete.
  std::string builtPointsPath() const { return path_ + "/points.built"; }
  void putBackBuiltPoints();
  /// From now on the destructor leaves the folder for another conversion to resume.
  void keep(bool kept = true) { kept_ = kept; }
  /// Gives the folder its final name in one step, and ends keep(). Throws, and leaves what is there alone, when
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
