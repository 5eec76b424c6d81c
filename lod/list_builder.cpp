#include "lod/list_builder.h"

#include <algorithm>
#include <utility>

#include "io/node_codec.h"
#include "lod/node_loader.h"

namespace strata {
namespace {

/// A richer version of a node that is drawn already waits behind nodes that are missing and about as urgent.
constexpr float kUpgradeWeight = 0.25f;

}  // namespace

ListBuilder::ListBuilder(const Store& store, std::span<const std::uint32_t> parents, Precision leastPrecision,
                         NodeCache& cache)
    : store_(store), parents_(parents), leastPrecision_(leastPrecision), cache_(cache), marks_(parents.size(), 0) {}

std::uint32_t ListBuilder::takeWhatFits(const Selection& selection) {
  wanted_.clear();
  wantedBytes_ = 0;
  std::uint64_t largest = 0;  // room for one node to be there in two versions while it is replaced
  for (const SelectedNode& selected : selection.nodes) {
    const std::uint64_t bytes = nodeBytesBound(store_.hierarchy().nodes[selected.node], store_.info());
    const std::uint64_t reserve = wanted_.empty() ? 0 : std::max(largest, bytes);
    if (wantedBytes_ + bytes + reserve > cache_.capacityBytes()) break;
    wantedBytes_ += bytes;
    largest = std::max(largest, bytes);
    wanted_.push_back(selected);
  }
  const std::size_t left = selection.nodes.size() - wanted_.size();
  std::sort(wanted_.begin(), wanted_.end(),
            [](const SelectedNode& a, const SelectedNode& b) { return a.node < b.node; });
  indices_.clear();
  for (const SelectedNode& wanted : wanted_) indices_.push_back(wanted.node);
  return static_cast<std::uint32_t>(left);
}

LoadRequest ListBuilder::requestFor(const SelectedNode& wanted) const {
  const NodeRecord& record = store_.hierarchy().nodes[wanted.node];
  LoadRequest request;
  request.node = wanted.node;
  request.precision = usefulPrecision(record, std::max(wanted.precision, leastPrecision_));
  request.priority = wanted.priority;
  request.bytes = drawBytes(record, request.precision);
  request.offset = record.offset;
  return request;
}

void ListBuilder::lookAhead(const Selection& selection, const FailedNodes::ByNode& failed,
                            std::vector<LoadRequest>& requests) {
  std::uint64_t bytes = wantedBytes_;
  for (const SelectedNode& selected : selection.nodes) {
    const std::uint32_t mark = marks_[selected.node];
    if (mark / kMarks == pass_) continue;  // wanted now
    bytes += nodeBytesBound(store_.hierarchy().nodes[selected.node], store_.info());
    if (bytes > cache_.capacityBytes()) return;
    LoadRequest request = requestFor(selected);
    if (cache_.loadedPlanes(selected.node) >= static_cast<int>(request.precision) || failed.contains(selected.node))
      continue;
    request.ahead = true;
    requests.push_back(request);
  }
}

ListBuilder::Result ListBuilder::build(const Selection& selection, const FailedNodes::ByNode& failed, PinnedList& out,
                                       std::vector<LoadRequest>& requests) {
  Result result;
  requests.clear();
  drawn_.clear();
  result.overCapacity = takeWhatFits(selection);
  cache_.pin(indices_, found_, out.pins);
  const auto now = FailedNodes::Clock::now();

  ++pass_;
  const std::uint32_t drawn = pass_ * kMarks + kDrawn;
  const std::uint32_t blocked = pass_ * kMarks + kBlocked;
  const std::uint32_t missing = pass_ * kMarks + kMissing;
  out.list.pointCount = 0;
  out.list.missingNodes = result.overCapacity;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const SelectedNode& wanted = wanted_[i];
    const std::uint32_t parent = parents_[wanted.node];
    const std::uint32_t above = parent < marks_.size() ? marks_[parent] : drawn;
    const bool resident = found_[i] != nullptr;
    ++(resident ? result.resident : result.absent);

    const auto failure = failed.find(wanted.node);
    const bool hasFailed = failure != failed.end();
    if (above == blocked || (!resident && hasFailed && failure->second.outOfTries())) {
      marks_[wanted.node] = blocked;
      ++out.list.missingNodes;
      continue;
    }
    const NodeRecord& record = store_.hierarchy().nodes[wanted.node];
    LoadRequest request = requestFor(wanted);
    request.alone = hasFailed;
    const bool poor =
        resident && wanted.pointCount > 0 && found_[i]->loadedPlanes() < static_cast<int>(request.precision);
    if (poor) request.priority *= kUpgradeWeight;
    // While both versions of a node are held there has to be room for both.
    const bool roomForBoth = poor && wantedBytes_ + nodeBytesBound(record, store_.info()) <= cache_.capacityBytes();
    if (!resident || roomForBoth) {
      if (!hasFailed || !failure->second.mustWait(now)) {
        requests.push_back(request);
      } else if (!failure->second.outOfTries()) {
        ++result.waiting;
        result.retryAt = std::min(result.retryAt, failure->second.retryAt);
      }
    }

    if (!resident || above != drawn) {
      marks_[wanted.node] = missing;
      ++out.list.missingNodes;
      continue;
    }
    marks_[wanted.node] = drawn;
    drawn_.push_back(wanted.node);
    const std::uint32_t points = std::min(wanted.pointCount, found_[i]->pointCount());
    out.list.items.push_back({std::move(found_[i]), points});
    out.list.pointCount += points;
  }
  found_.clear();
  return result;
}

}  // namespace strata
