#include "converter/journal/build_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <span>

#include "converter/journal/records.h"
#include "core/error.h"
#include "io/file/output_file.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockFile = "lock";
constexpr const char* kJournalFile = "journal";
constexpr std::array<std::string_view, 4> kStoreFiles{kInfoFile, kHierarchyFile, kPointsFile, kNewPointsFile};
constexpr std::array<std::string_view, 4> kWorkFiles{kLockFile, kJournalFile, "spill", "points.built"};

/// Returns the name of an entry that neither a store nor a store being built has; empty where there is none.
std::string strangeEntry(const std::string& folder) {
  std::error_code failure;
  for (auto entry = fs::directory_iterator(folder, failure); !failure && entry != fs::directory_iterator();
       entry.increment(failure)) {
    const std::string name = entry->path().filename().string();
    if (std::find(kWorkFiles.begin(), kWorkFiles.end(), name) == kWorkFiles.end() &&
        std::find(kStoreFiles.begin(), kStoreFiles.end(), name) == kStoreFiles.end())
      return name;
  }
  if (failure) throw Error(folder, "reading the folder: " + failure.message());
  return {};
}

void removeFiles(const std::string& folder, std::span<const std::string_view> files) {
  std::error_code ignored;
  for (const std::string_view file : files) fs::remove(fs::path(folder) / file, ignored);
}

void removeStoreFolder(const std::string& folder) {
  std::error_code ignored;
  removeFiles(folder, kStoreFiles);
  removeFiles(folder, kWorkFiles);
  fs::remove(folder, ignored);  // fails, as it should, where anything else is in it
}

fs::path parentOf(const std::string& path) {
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// True where something, even a dangling link, has this name.
bool isTaken(const std::string& path) {
  std::error_code failure;
  const fs::file_status status = fs::symlink_status(path, failure);
  if (status.type() == fs::file_type::not_found) return false;
  if (failure) throw Error(path, failure.message());
  return true;
}

/// Removes the spill of an interrupted conversion, which may lie in a folder of its own.
void removeSpillOf(const std::string& journalPath) {
  try {
    const std::string spill = readHead(Journal(journalPath)).spillPath;
    std::error_code ignored;
    if (!spill.empty()) fs::remove(spill, ignored);
  } catch (const Error&) {  // the journal has no head, so there is no spill to find
  }
}

}  // namespace

void checkOutput(const std::string& output, bool force) {
  if (output.empty()) throw UsageError("--output", "found '' (expected NAME.strata)");
  std::error_code failure;
  const fs::path parent = parentOf(output);
  if (!fs::is_directory(parent, failure)) throw Error(parent.string(), "is no folder that the store could be made in");
  if (!isTaken(output)) return;
  if (!force) throw Error(output, "exists already; --force replaces it");
  if (!fs::is_directory(output, failure) || !fs::exists(output + "/" + kInfoFile, failure))
    throw Error(output, "is not a store, so --force does not replace it");
  if (const std::string strange = strangeEntry(output); !strange.empty())
    throw Error(output, "holds " + strange + ", which is no part of a store, so --force does not replace it");
}

BuildFolder::BuildFolder(const std::string& output, bool force, bool resume)
    : output_(output), path_(output + ".building"), force_(force) {
  std::error_code failure;
  fs::create_directory(path_, failure);
  if (failure) throw Error(path_, "creating: " + failure.message());
  if (const std::string strange = strangeEntry(path_); !strange.empty())
    throw Error(path_, "holds " + strange + ", which no conversion left there");
  lock_ = ::open((path_ + "/" + kLockFile).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) throw posixError(path_, "creating", errno);
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw Error(path_, "another conversion is writing this store");
  }
  const bool interrupted = fs::exists(journalPath(), failure);
  if (interrupted && resume) return;
  if (interrupted && !force) {
    ::close(lock_);
    throw Error(path_, "holds an interrupted conversion; --resume goes on with it, --force starts it again");
  }
  if (interrupted) removeSpillOf(journalPath());
  removeFiles(path_, kStoreFiles);
  removeFiles(path_, std::span(kWorkFiles).subspan(1));  // all but the lock
}

BuildFolder::~BuildFolder() {
  if (!kept_) removeStoreFolder(path_);  // after publish(): the store that was replaced, or nothing
  ::close(lock_);
}

void BuildFolder::putBackBuiltPoints() {
  std::error_code failure;
  if (fs::exists(builtPointsPath(), failure)) fs::rename(builtPointsPath(), path_ + "/" + kPointsFile);
}

void BuildFolder::publish() {
  removeFiles(path_, std::span(kWorkFiles).subspan(2));  // the journal stays until the name is there
  syncFolder(path_);
  if (isTaken(output_)) {
    try {
      checkOutput(output_, force_);
    } catch (const Error& taken) {
      throw Error(std::string(taken.what()) + "; the finished store waits in " + path_ + " for --resume");
    }
    if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, output_.c_str(), RENAME_EXCHANGE) != 0)
      throw posixError(output_, "replacing", errno);
  } else if (::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, output_.c_str(), RENAME_NOREPLACE) != 0) {
    // Some file systems know plain renames only; those do not replace a folder with anything in it either.
    if (errno != EINVAL || ::rename(path_.c_str(), output_.c_str()) != 0) throw posixError(output_, "renaming", errno);
  }
  kept_ = false;
  removeFiles(output_, std::span(kWorkFiles).first(2));
  syncFolder(output_);
  syncFolder(parentOf(output_).string());
}

}  // namespace strata
