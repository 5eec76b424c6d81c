#include "io/open_scans.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>

#include "core/error.h"
#include "core/text.h"
#include "io/file/byte_source.h"
#include "io/las/las_source.h"
#include "io/scan/point_source.h"
#include "io/synthetic/shape_source.h"
#include "io/table/pcd_source.h"
#include "io/table/ply_source.h"
#include "io/table/text_source.h"

namespace strata {
namespace {

namespace fs = std::filesystem;
using OpenFunction = std::unique_ptr<PointSource> (*)(const std::string& path, const SourceOptions& options);

/// A format of scans that can be read. A new one is a row of kFormats, and its extension a word of kKnownExtensions.
struct ScanFormat {
  std::string_view extension;  ///< lower case
  std::string_view magic;      ///< first bytes of such a file; empty when they may be any
  OpenFunction open;
};
constexpr std::string_view kLasMagic = "LASF";
constexpr std::array<ScanFormat, 10> kFormats{{{".las", kLasMagic, openLas},
                                               {".laz", kLasMagic, openLas},
                                               {".ply", "ply", openPly},
                                               {".pcd", "", openPcd},
                                               {".xyz", "", openText},
                                               {".pts", "", openText},
                                               {".csv", "", openText},
                                               {".txt", "", openText},
                                               {".asc", "", openText},
                                               {".3d", "", openText}}};
constexpr std::string_view kKnownExtensions = "las, laz, ply, pcd, xyz, pts, csv, txt, asc, 3d";

/// A format of scans that is known by its extension only, and the message for the user.
struct UnreadFormat {
  std::string_view extension;
  std::string_view message;
};
constexpr std::array<UnreadFormat, 3> kUnread{
    {{".e57", "E57 is not read yet; export it as LAS or LAZ"},
     {".ptx", "PTX is not read yet; export it as LAS, LAZ or PTS"},
     {".wdp", "this is the waveform data of a LAS file, which holds no points; name the LAS file"}}};

const ScanFormat* findFormat(const fs::path& path) {
  const std::string extension = scanExtension(path.string());
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const ScanFormat& format) { return format.extension == extension; });
  return found == kFormats.end() ? nullptr : &*found;
}

const UnreadFormat* findUnread(const fs::path& path) {
  const std::string extension = scanExtension(path.string());
  const auto found = std::find_if(kUnread.begin(), kUnread.end(),
                                  [&](const UnreadFormat& format) { return format.extension == extension; });
  return found == kUnread.end() ? nullptr : &*found;
}

/// The first four bytes of the file, fewer if it is shorter. Throws when it is missing, empty or no regular file.
std::string firstBytes(const std::string& path) {
  std::error_code failure;
  const fs::file_status status = fs::status(path, failure);
  if (fs::exists(status) && !fs::is_regular_file(status)) throw Error(path, "is no regular file");
  const std::unique_ptr<ByteSource> bytes = openFile(path);
  if (bytes->size() == 0) throw Error(path, "the file is empty, found 0 bytes");
  return readBeginning(*bytes, 4);
}

std::unique_ptr<PointSource> openOne(const std::string& path, const SourceOptions& options) {
  const ScanFormat* format = findFormat(path);
  if (format == nullptr) {
    if (const UnreadFormat* unread = findUnread(path)) throw Error(path, std::string(unread->message));
    std::error_code failure;
    if (!fs::exists(path, failure)) firstBytes(path);  // says why it cannot be opened
    const std::string extension = scanExtension(path);
    throw Error(path, "unknown kind of scan, found extension '" + extension + "' (expected " +
                          std::string(kKnownExtensions) + ")");
  }
  const std::string start = firstBytes(path);
  if (!start.starts_with(format->magic))
    throw Error(path, "this is no " + std::string(format->extension.substr(1)) + " file, its first bytes are not '" +
                          std::string(format->magic) + "'");
  if (format->magic.empty() && start == kLasMagic)
    throw Error(path, "found a LAS or LAZ file (expected what its extension says); rename it to .las or .laz");
  return format->open(path, options);
}

/// All scans below the folder, sorted by path. A file that several links lead to is there once.
std::vector<std::string> scansBelow(const std::string& folder) {
  std::vector<std::string> scans;
  std::error_code failure;
  std::set<std::string> seen;
  for (auto entry = fs::recursive_directory_iterator(folder, failure);
       !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure)) {
    std::error_code ignored;
    if (findFormat(entry->path()) == nullptr || !entry->is_regular_file(ignored)) continue;
    scans.push_back(entry->path().string());
  }
  if (failure) throw Error(folder, "reading the folder: " + failure.message());
  std::sort(scans.begin(), scans.end());
  std::erase_if(scans, [&](const std::string& scan) {
    std::error_code ignored;
    return !seen.insert(fs::canonical(scan, ignored).string()).second;
  });
  if (scans.empty())
    throw Error(folder, "found no scan in the folder (expected files " + std::string(kKnownExtensions) + ")");
  return scans;
}

}  // namespace

std::string scanExtension(const std::string& path) { return lowerCase(fs::path(path).extension().string()); }

std::vector<std::unique_ptr<PointSource>> openScans(const std::vector<std::string>& inputs,
                                                    const SourceOptions& options) {
  std::vector<std::unique_ptr<PointSource>> sources;
  const auto openNext = [&](const std::string& path) {
    if (options.stop != nullptr && *options.stop) throw Stopped();
    sources.push_back(openOne(path, options));
  };
  for (const std::string& input : inputs) {
    std::error_code ignored;
    if (input.starts_with("synthetic:")) {
      sources.push_back(synthetic::openScan(input));
    } else if (fs::is_directory(input, ignored)) {
      for (const std::string& scan : scansBelow(input)) openNext(scan);
    } else {
      openNext(input);
    }
  }
  return sources;
}

}  // namespace strata
