#pragma once
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lod/streamer.h"

namespace strata {

/// Several stores drawn as one picture: a streamer for each, their render lists one after the other. All members are
/// for the render thread.
class Layers {
 public:
  /// The cache's bytes and the point budget of `options` are shared out evenly.
  Layers(std::vector<std::shared_ptr<const Store>> stores, const StreamerOptions& options);

  /// Chooses the stores that are drawn; at first all are. A hidden store is not walked, read or drawn, and leaves its
  /// share of the point budget to the others. Its nodes stay in memory, so that it comes back at once.
  void setShown(const std::vector<bool>& shown);

  void setView(const View& view);
  /// `ahead` is the view that the camera will soon have.
  void setView(const View& view, const View& ahead);
  void setSelection(const SelectionOptions& selection);
  /// Valid until the next call of this or of waitUntilComplete().
  const RenderList& beginFrame();
  bool complete() const;
  bool waitUntilComplete(std::chrono::milliseconds timeout);

  const std::vector<std::shared_ptr<const Store>>& stores() const { return stores_; }
  /// The index in stores() of the store whose node is item number `item` of the newest list of beginFrame().
  std::size_t indexOfItem(std::size_t item) const;
  /// Summed over the layers; lodMs is the longest.
  StreamerStats stats() const;
  StreamerStats statsOf(std::size_t layer) const { return streamers_[layer]->stats(); }
  /// The coarse depth of the first layer that is shown; see Streamer::copyCoarseDepth().
  void coarseDepth(std::vector<float>& depths) const;

 private:
  std::vector<std::shared_ptr<const Store>> stores_;
  std::vector<bool> shown_;
  SelectionOptions selection_;
  std::optional<View> view_;  ///< none before the first setView()
  RenderList merged_;
  std::vector<std::size_t> itemEnds_;  ///< the end of each store's items in the newest list
  std::vector<std::unique_ptr<Streamer>> streamers_;
};

/// Puts the items of `list` behind those of `merged`.
void appendList(const RenderList& list, RenderList& merged);

}  // namespace strata
