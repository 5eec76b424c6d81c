#include "lod/list_builder.h"

#include <algorithm>
#include <utility>

#include "io/store/node_codec.h"
#include "lod/node_loader.h"

namespace strata {
namespace {

/// A richer version of a node that is drawn already waits behind nodes that are missing and about as urgent.
constexpr float kUpgradeWeight = 0.25f;

}  // namespace

ListBuilder::ListBuilder(const Store& store, std::span<const std::uint32_t> parents, Precision leastPrecision,
                         NodeCache& cache)
    : store_(store),
      parents_(parents),
      leastPrecision_(leastPrecision),
      bytesAPoint_(bytesAPointBound(store.info())),
      cache_(cache),
      marks_(parents.size(), 0) {}

std::uint32_t ListBuilder::takeWhatFits(const Selection& selection) {
  wanted_.clear();
  wantedBytes_ = 0;
  std::uint64_t largest = 0;  // room for one node to be there in two versions while it is replaced
  for (const SelectedNode& selected : selection.nodes) {
    const std::uint64_t bytes = nodeBytesBound(store_.hierarchy().nodes[selected.node], bytesAPoint_);
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

namespace {

/// Where the plane that is shown ends; 0 where none is.
std::uint32_t shownEnd(const PlaneEnds& ends, ColourMode shown) {
  switch (shown) {
    case ColourMode::rgb:
      return ends.colour;
    case ColourMode::intensity:
      return ends.intensity;
    case ColourMode::classification:
      return ends.classification;
    case ColourMode::returnNumber:
      return ends.returnNumber;
    case ColourMode::normal:
      return ends.normal;
    default:
      return 0;
  }
}

}  // namespace

std::uint32_t ListBuilder::bytesNeeded(const NodeRecord& record, const StreamedNode& present,
                                       Precision precision) const {
  const std::uint32_t normals = normals_ ? present.ends.normal : 0;
  if (!shown_) return std::max(drawBytes(record, precision), normals);
  const auto plane = static_cast<std::size_t>(precision) - 1;
  return std::max({present.ends.position[plane], shownEnd(present.ends, *shown_), normals});
}

std::uint32_t ListBuilder::bytesAtMost(const NodeRecord& record, Precision precision) const {
  // After all positions.
  const bool isLate = normals_ || shown_ == ColourMode::returnNumber || shown_ == ColourMode::normal;
  return isLate ? record.payloadBytes : drawBytes(record, precision);
}

/// Where planes end stands in a node's head, which is not known before the node is read. Nodes of a scan are alike: so
/// much of it is asked for as has been enough for all that are here; what that leaves out is read when it shows.
void ListBuilder::learnShare() {
  share_ = 0.0;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    if (found_[i] == nullptr) continue;
    const NodeRecord& record = store_.hierarchy().nodes[wanted_[i].node];
    share_ = std::max(share_, static_cast<double>(bytesNeeded(record, *found_[i], Precision::low10)) /
                                  std::max(bytesAtMost(record, Precision::low10), 1u));
  }
  if (share_ == 0.0) share_ = 1.0;
}

std::optional<LoadRequest> ListBuilder::requestFor(const SelectedNode& wanted, const StreamedNode* present) const {
  const NodeRecord& record = store_.hierarchy().nodes[wanted.node];
  LoadRequest request;
  request.node = wanted.node;
  request.precision = usefulPrecision(record, std::max(wanted.precision, leastPrecision_));
  request.priority = wanted.priority;
  request.offset = record.offset;
  std::uint32_t needed = bytesAtMost(record, request.precision);
  if (present != nullptr) {
    needed = bytesNeeded(record, *present, request.precision);
    if (needed <= present->leadingBytes) return std::nullopt;
    request.from = present->leadingBytes;
    request.offset += request.from;
  } else if (request.precision == Precision::low10) {
    constexpr double kMargin = 1.02;
    needed = std::min(needed, static_cast<std::uint32_t>(kMargin * share_ * needed) + record.headBytes);
  }
  request.bytes = needed - request.from;
  return request;
}

void ListBuilder::lookAhead(const Selection& selection, const FailedNodes::ByNode& failed,
                            std::vector<LoadRequest>& requests) {
  std::uint64_t bytes = wantedBytes_;
  for (const SelectedNode& selected : selection.nodes) {
    const std::uint32_t mark = marks_[selected.node];
    if (mark / kMarks == pass_) continue;  // wanted now
    bytes += nodeBytesBound(store_.hierarchy().nodes[selected.node], bytesAPoint_);
    if (bytes > cache_.capacityBytes()) return;
    if (failed.contains(selected.node)) continue;
    std::optional<LoadRequest> request = requestFor(selected, cache_.peek(selected.node).get());
    if (!request) continue;
    request->ahead = true;
    requests.push_back(*request);
  }
}

ListBuilder::Result ListBuilder::build(const Selection& selection, const SelectionOptions& options,
                                       const FailedNodes::ByNode& failed, Fade& fade, PinnedList& out,
                                       std::vector<LoadRequest>& requests) {
  Result result;
  shown_ = options.shown;
  const PointLayout& layout = store_.info().layout;
  normals_ =
      options.normals && (layout.find(attribute::kNormal) >= 0 || layout.find(attribute::kNormalOctahedral) >= 0);
  requests.clear();
  drawn_.clear();
  result.overCapacity = takeWhatFits(selection);
  cache_.pin(indices_, found_, out.pins);
  learnShare();
  const auto now = FailedNodes::Clock::now();

  ++pass_;
  const std::uint32_t drawn = pass_ * kMarks + kDrawn;
  const std::uint32_t blocked = pass_ * kMarks + kBlocked;
  const std::uint32_t missing = pass_ * kMarks + kMissing;
  const std::uint32_t missingLast = missing - kMarks, blockedLast = blocked - kMarks;
  out.list.pointCount = 0;
  out.list.missingNodes = result.overCapacity;
  out.list.coarseNodes = 0;
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
    std::optional<LoadRequest> request = requestFor(wanted, found_[i].get());
    const bool poor = resident && request.has_value() && wanted.pointCount > 0;
    if (request) request->alone = hasFailed;
    if (poor) request->priority *= kUpgradeWeight;
    // While both versions of a node are held there has to be room for both.
    const bool roomForBoth = poor && wantedBytes_ + nodeBytesBound(record, bytesAPoint_) <= cache_.capacityBytes();
    if (!resident || roomForBoth) {
      if (!hasFailed || !failure->second.mustWait(now)) {
        requests.push_back(*request);
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
    const std::uint32_t lastMark = std::exchange(marks_[wanted.node], drawn);
    drawn_.push_back(wanted.node);
    out.list.coarseNodes += poor ? 1 : 0;
    const std::uint32_t points = fade.allow(wanted.node, std::min(wanted.pointCount, found_[i]->pointCount()),
                                            lastMark == missingLast || lastMark == blockedLast);
    out.list.items.push_back({std::move(found_[i]), points, wanted.node});
    out.list.pointCount += points;
  }
  found_.clear();
  result.requests = static_cast<std::uint32_t>(requests.size());
  return result;
}

}  // namespace strata
