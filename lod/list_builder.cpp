#include "lod/list_builder.h"

#include <algorithm>
#include <utility>

#include "io/store/node_codec.h"
#include "lod/node_decoder.h"

namespace strata {
namespace {

/// A richer version of a node that is drawn already waits behind nodes that are missing and about as urgent.
constexpr float kUpgradeWeight = 0.25f;
/// A request for a node of unknown planes asks for this many times the bytes that learnShare() expects.
constexpr double kShareMargin = 1.02;

/// The end of the plane that is shown in the payload; 0 when positions alone are shown.
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

ListBuilder::ListBuilder(const Store& store, std::span<const std::uint32_t> parents, Precision leastPrecision,
                         NodeCache& cache)
    : store_(store),
      parents_(parents),
      leastPrecision_(leastPrecision),
      bytesAPoint_(bytesAPointBound(store.info())),
      cache_(cache),
      marks_(parents.size()) {}

/// Puts the most urgent nodes that fit the cache together into `wanted_`. Returns how many do not.
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
  // By index, parents come before their children, which build() relies on, and NodeCache::pin() too.
  std::sort(wanted_.begin(), wanted_.end(),
            [](const SelectedNode& a, const SelectedNode& b) { return a.node < b.node; });
  indices_.clear();
  for (const SelectedNode& wanted : wanted_) indices_.push_back(wanted.node);
  return static_cast<std::uint32_t>(left);
}

/// The leading bytes of the payload of a resident node that the view needs; its head has told where its planes end.
std::uint32_t ListBuilder::bytesNeeded(const NodeRecord& record, const StreamedNode& present,
                                       Precision precision) const {
  const std::uint32_t normals = normals_ ? present.ends.normal : 0;
  if (!shown_) return std::max(drawBytes(record, precision), normals);
  const auto plane = static_cast<std::size_t>(precision) - 1;
  return std::max({present.ends.position[plane], shownEnd(present.ends, *shown_), normals});
}

/// The most that bytesNeeded() can come to for a node whose head has not been read.
std::uint32_t ListBuilder::bytesAtMost(const NodeRecord& record, Precision precision) const {
  // Return numbers and normals lie behind all positions.
  const bool isLate = normals_ || shown_ == ColourMode::returnNumber || shown_ == ColourMode::normal;
  return isLate ? record.payloadBytes : drawBytes(record, precision);
}

/// Sets `share_`, the largest share of bytesAtMost() that a wanted node in memory needed. The planes' ends are in the
/// node's head, which is not known before the node is read. But nodes of one scan are alike, so this share of a new
/// node is asked for first; what that leaves out is asked for once its head is there.
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

/// The request for what `present`, the node as it is or null, lacks; empty when it lacks nothing.
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
    needed = std::min(needed, static_cast<std::uint32_t>(kShareMargin * share_ * needed) + record.headBytes);
  }
  request.bytes = needed - request.from;
  return request;
}

void ListBuilder::lookAhead(const Selection& selection, const FailedNodes::ByNode& failed,
                            std::vector<LoadRequest>& requests) {
  std::uint64_t bytes = wantedBytes_;
  for (const SelectedNode& selected : selection.nodes) {
    if (marks_[selected.node].isOf(pass_)) continue;  // wanted now
    bytes += nodeBytesBound(store_.hierarchy().nodes[selected.node], bytesAPoint_);
    if (bytes > cache_.capacityBytes()) return;
    if (failed.contains(selected.node)) continue;
    std::optional<LoadRequest> request = requestFor(selected, cache_.peek(selected.node).get());
    if (!request) continue;
    request->ahead = true;
    requests.push_back(*request);
  }
}

ListBuilder::WantedNode ListBuilder::wantedNode(std::size_t i, const FailedNodes::ByNode& failed) const {
  const SelectedNode& selected = wanted_[i];
  const std::uint32_t parent = parents_[selected.node];
  Fate parentFate = Fate::drawn;  // nothing above the root stops it
  if (parent < marks_.size()) parentFate = marks_[parent].isOf(pass_) ? marks_[parent].fate() : Fate::missing;
  const auto failure = failed.find(selected.node);
  return {selected, found_[i].get(), failure != failed.end() ? &failure->second : nullptr, parentFate};
}

ListBuilder::Fate ListBuilder::fateOf(const WantedNode& node) {
  const bool isLost = node.present == nullptr && node.failure != nullptr && node.failure->outOfTries();
  if (node.parentFate == Fate::givenUp || isLost) return Fate::givenUp;
  return node.present != nullptr ? node.parentFate : Fate::missing;
}

/// Adds the request, or notes when it may be made.
void ListBuilder::ask(const WantedNode& node, LoadRequest request, Result& result,
                      std::vector<LoadRequest>& requests) const {
  request.alone = node.failure != nullptr;
  if (node.present != nullptr) {
    request.priority *= kUpgradeWeight;
    // Both versions of a node are held until the poorer one is drawn no longer, so there has to be room for both.
    const std::uint64_t bytes = nodeBytesBound(store_.hierarchy().nodes[request.node], bytesAPoint_);
    if (wantedBytes_ + bytes > cache_.capacityBytes()) return;
  }
  if (node.failure == nullptr || !node.failure->mustWait(now_)) {
    requests.push_back(request);
  } else if (!node.failure->outOfTries()) {
    ++result.waiting;
    result.retryAt = std::min(result.retryAt, node.failure->retryAt);
  }
}

void ListBuilder::draw(std::size_t i, bool wasMissing, Fade& fade, RenderList& list) {
  const SelectedNode& selected = wanted_[i];
  const std::uint32_t wanted = std::min(selected.pointCount, found_[i]->pointCount());
  const std::uint32_t points = fade.allow(selected.node, wanted, wasMissing);
  list.items.push_back({std::move(found_[i]), points, selected.node});
  list.pointCount += points;
  drawn_.push_back(selected.node);
}

ListBuilder::Result ListBuilder::build(const Selection& selection, const SelectionOptions& options,
                                       const FailedNodes::ByNode& failed, Fade& fade, LodOutput& out) {
  const PointLayout& layout = store_.info().layout;
  shown_ = options.shown.colour;
  normals_ =
      options.shown.normals && (layout.find(attribute::kNormal) >= 0 || layout.find(attribute::kNormalOctahedral) >= 0);
  ++pass_;
  now_ = FailedNodes::Clock::now();
  drawn_.clear();
  out.requests.clear();

  Result result;
  result.overCapacity = takeWhatFits(selection);
  cache_.pin(indices_, found_, out.pinned.pins);
  learnShare();

  RenderList& list = out.pinned.list;
  list.pointCount = 0;
  list.missingNodes = result.overCapacity;
  list.coarseNodes = 0;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const WantedNode node = wantedNode(i, failed);
    const Fate fate = fateOf(node);
    const Mark lastMark = std::exchange(marks_[node.selected.node], Mark(pass_, fate));
    ++(node.present != nullptr ? result.resident : result.absent);
    bool isCoarse = false;
    if (fate != Fate::givenUp) {
      const std::optional<LoadRequest> request = requestFor(node.selected, node.present);
      isCoarse = node.present != nullptr && request && node.selected.pointCount > 0;
      if (node.present == nullptr || isCoarse) ask(node, *request, result, out.requests);
    }
    if (fate == Fate::drawn) {
      draw(i, lastMark.isOf(pass_ - 1) && lastMark.fate() != Fate::drawn, fade, list);
      list.coarseNodes += isCoarse ? 1 : 0;
    } else {
      ++list.missingNodes;
    }
  }
  found_.clear();
  result.requests = static_cast<std::uint32_t>(out.requests.size());
  return result;
}

}  // namespace strata
