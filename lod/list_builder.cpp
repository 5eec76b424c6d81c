#include "lod/list_builder.h"

#include <algorithm>
#include <utility>

#include "lod/failed_nodes.h"
#include "lod/node_loader.h"

namespace strata {
namespace {

/// A richer version of a node that is drawn already waits behind nodes that are missing and about as urgent.
constexpr float kUpgradeWeight = 0.25f;
/// A node that failed goes behind the others before it is tried again.
constexpr float kRetryWeight = 1e-3f;

}  // namespace

ListBuilder::ListBuilder(const Store& store, std::span<const std::uint32_t> parents, NodeCache& cache)
    : store_(store), parents_(parents), cache_(cache), marks_(parents.size(), 0) {}

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

void ListBuilder::request(const SelectedNode& wanted, bool resident, const Attempts& attempts,
                          std::vector<LoadRequest>& requests) const {
  const NodeRecord& record = store_.hierarchy().nodes[wanted.node];
  LoadRequest request{wanted.node, usefulPrecision(record, wanted.precision), wanted.priority};
  if (resident) request.priority *= kUpgradeWeight;
  const auto failed = attempts.find(wanted.node);
  for (int i = failed == attempts.end() ? 0 : failed->second; i > 0; --i) request.priority *= kRetryWeight;
  requests.push_back(request);
}

ListBuilder::Result ListBuilder::build(const Selection& selection, const Attempts& attempts, PinnedList& out,
                                       std::vector<LoadRequest>& requests) {
  Result result;
  requests.clear();
  result.overCapacity = takeWhatFits(selection);
  cache_.pin(indices_, found_, out.pins);

  ++pass_;
  const std::uint32_t drawn = pass_ * 2 + kDrawn;
  const std::uint32_t blocked = pass_ * 2 + kBlocked;
  const auto outOfTries = [&attempts](std::uint32_t node) {
    const auto failed = attempts.find(node);
    return failed != attempts.end() && failed->second >= FailedNodes::kMaxAttempts;
  };
  out.list.pointCount = 0;
  out.list.missingNodes = result.overCapacity;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const SelectedNode& wanted = wanted_[i];
    const std::uint32_t parent = parents_[wanted.node];
    const std::uint32_t above = parent < marks_.size() ? marks_[parent] : drawn;
    const bool resident = found_[i] != nullptr;
    ++(resident ? result.resident : result.absent);

    if (above == blocked || (!resident && outOfTries(wanted.node))) {
      marks_[wanted.node] = blocked;
      ++out.list.missingNodes;
      continue;
    }
    const NodeRecord& record = store_.hierarchy().nodes[wanted.node];
    const int planes = static_cast<int>(usefulPrecision(record, wanted.precision));
    const bool poor = resident && wanted.pointCount > 0 && found_[i]->loadedPlanes() < planes;
    // While both versions of a node are held there has to be room for both.
    const bool roomForBoth = poor && wantedBytes_ + nodeBytesBound(record, store_.info()) <= cache_.capacityBytes();
    if (!resident || (roomForBoth && !outOfTries(wanted.node))) request(wanted, resident, attempts, requests);

    if (!resident || above != drawn) {
      ++out.list.missingNodes;
      continue;
    }
    marks_[wanted.node] = drawn;
    const std::uint32_t points = std::min(wanted.pointCount, found_[i]->pointCount());
    out.list.items.push_back({std::move(found_[i]), points});
    out.list.pointCount += points;
  }
  found_.clear();
  return result;
}

}  // namespace strata
