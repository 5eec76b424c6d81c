#include "converter/journal/session.h"

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "converter/journal/records.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// A path in the folder for temporary points that no other conversion has; empty where no such folder is asked for.
std::string newSpillPath(const ConvertOptions& options) {
  if (options.tempFolder.empty()) return {};
  std::random_device random;
  const std::string name = fs::path(options.output).filename().string() + "-" + std::to_string(random()) + ".spill";
  return fs::absolute(fs::path(options.tempFolder) / name).string();
}

}  // namespace

Session::Session(const Sources& sources, const ConvertOptions& options)
    : folder_(options.output, options.force, options.resume) {
  folder_.keep(options.resume);  // until it is sure that the conversion can be resumed
  journal_.emplace(folder_.journalPath());
  JournalHead head{newSpillPath(options), termsOf(sources, options)};
  if (journal_->found().empty()) {
    appendHead(*journal_, head);
    headEnd_ = journal_->bytes();
  } else {
    const JournalHead begun = readHead(*journal_);
    checkSameTerms(folder_.path(), begun.terms, head.terms);
    head.spillPath = begun.spillPath;
    headEnd_ = journal_->found().front().offset + journal_->found().front().bytes;
  }
  const std::string path = head.spillPath.empty() ? folder_.spillPath() : head.spillPath;
  if (strata::isComplete(*journal_)) {
    std::error_code ignored;
    fs::remove(path, ignored);
    return;
  }
  folder_.putBackBuiltPoints();
  const bool begun = journal_->found().size() > 1 || fs::exists(path);
  spill_.emplace(path, begun ? Spill::Open::existing : Spill::Open::create);
  if (begun) dropStrays();
  folder_.keep(false);
}

void Session::keep() {
  spill_->keep();
  folder_.keep();
}

void Session::startAgain() {
  journal_->rewind(headEnd_);
  spill_->truncate(0);
}

/// Punches out and cuts off what was written to the spill without getting into the journal.
void Session::dropStrays() {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> known;  // [begin, end) of what the journal tells of
  for (const Journal::FoundRecord& found : journal_->found())
    if (found.kind == RecordKind::runs) {
      for (const WrittenRun& written : readRuns(*journal_, found).runs)
        known.emplace_back(written.run.offset, written.run.offset + written.run.points * written.run.shape.stride());
    } else if (found.kind == RecordKind::chunk) {
      const SpilledBytes top = readTopPoints(*journal_, found);
      known.emplace_back(top.offset, top.offset + top.bytes);
    }
  std::sort(known.begin(), known.end());
  std::uint64_t end = 0;
  for (const auto& [first, last] : known) {
    spill_->release(end, first);
    end = std::max(end, last);
  }
  spill_->truncate(end);
}

}  // namespace strata
