#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "render/gl/gl_objects.h"
#include "render/gl/shader_variant.h"
#include "render/plan/batch_plan.h"
#include "render/progressive/pool_manager.h"
#include "render/progressive/pool_schedule.h"
#include "render/shaders/shader_types.h"
#include "render/thread_pool.h"

namespace strata {

/// What one frame wants of the pool and what came of it.
struct PoolUpdate {
  std::uint32_t nodesMissing = 0;  ///< nodes of the list of which something is seen that is not in the pool
  std::uint64_t pointsWritten = 0;
  bool rewritten = false;  ///< pieces that pixels may show have been written again
};

/// Points of nodes at shuffled places of GPU memory (Rumpler 2019, 3.1 to 3.4). A node comes in pieces of one batch
/// each, so that no more of it has to be there than the prefix that is seen. A point is its node's words and the slot
/// of its piece; where the piece stands, and whether it is drawn, is in a table by slot that is made anew for each
/// frame. So points do not depend on an origin, and those of a freed piece are no longer drawn from that frame on. What
/// is left of them, his ghosts, is removed while the pool goes round once; only then is the slot used again.
class PointPool {
 public:
  static constexpr std::uint32_t kPiecePoints = 2560;  ///< a quarter of a batch

  /// Room for as many of `points` as the driver's storage blocks hold, four pages at most; a warning where that is
  /// less. Throws Error where there is no memory or a shader does not compile.
  PointPool(const GlFunctions& functions, std::uint64_t points, std::uint32_t key, std::uint32_t groupSize,
            const ThreadPool& threads);

  /// Takes what `plan` of `list` shows into the pool, at most `mostPoints` now (a first piece always passes), the first
  /// parts of all nodes before later ones. Where the view shows more than the pool holds, the last parts of all nodes
  /// stay out, as large a share of each: they give way to the first part of a node that comes into view, and are drawn
  /// as long as nothing does. `classes`: they are needed.
  PoolUpdate show(const RenderList& list, const DrawPlan& plan, bool classes, std::uint64_t mostPoints);
  /// Which places the fill pass meets next; of pages, see below.
  PoolSchedule& schedule() { return schedule_; }
  const PoolSchedule& schedule() const { return schedule_; }

  std::uint32_t size() const { return manager_.size(); }
  std::uint32_t pagePoints() const { return pagePoints_; }
  const PoolManager& manager() const { return manager_; }
  std::uint32_t ghostPieces() const { return static_cast<std::uint32_t>(schedule_.ghosts().size()); }
  std::uint64_t gpuBytes() const;

  void bindPage(std::uint32_t page, unsigned binding) const { pages_[page]->bindStorage(binding); }
  void bindPieces(unsigned binding) const { pieceBuffer_.bindStorage(binding); }
  /// After show() with `rewritten`: the points of `pixels` pixels are fetched anew where they have to be.
  void fetchAgain(const GlBuffer& kept, std::uint32_t pixels);

 private:
  static constexpr std::uint32_t kNoSlot = (1u << STRATA_SLOT_BITS) - 1u;

  struct Node {
    std::vector<std::uint32_t> firstPiece;  ///< of each batch
    std::vector<std::uint32_t> slots;       ///< of each piece; kNoSlot where it is not there
    std::uint32_t held = 0;
    std::uint64_t frame = 0;
  };
  struct Slot {
    Node* node = nullptr;  ///< null: free or dead
    std::uint32_t piece = 0;
    PoolManager::Block block{};
    int planes = 0;
    bool classes = false;
  };
  struct Known {
    std::weak_ptr<const NodeData> node;
    std::uint64_t fingerprint;
  };
  struct Wanted {
    Node* node;
    const PlannedBatch* batch;
    std::uint32_t piece;
    std::uint32_t first;   ///< within the batch
    std::uint32_t points;  ///< of the whole piece
    float share;           ///< of what is seen of the node, that comes before it
  };

  void beginFrame();
  void findWanted(const RenderList& list, const DrawPlan& plan);
  std::size_t fitting();
  void limitTo(std::size_t fits);
  bool isOld(const Wanted& wanted, bool classes) const;
  std::uint64_t fingerprint(const std::shared_ptr<const NodeData>& node);
  Node& nodeOf(const std::shared_ptr<const NodeData>& node);
  bool makeRoom(const Wanted& missing);
  void free(std::uint32_t slot);
  void stage(const PlannedBatch& batch, std::uint32_t first, std::uint32_t count, std::uint32_t slot);
  void setPiece(std::uint32_t slot, const PlannedBatch& batch, std::uint32_t first);
  void upload();
  void bindPool();

  const GlFunctions& gl_;
  const std::uint32_t groupSize_;
  std::uint32_t pagePoints_ = 0;
  PoolManager manager_;
  PoolSchedule schedule_;
  GlProgram insert_, fetch_;
  std::vector<std::unique_ptr<GlBuffer>> pages_;
  GlBuffer permutation_, staging_, insertBuffer_, pieceBuffer_;
  std::unordered_map<std::uint64_t, Node> nodes_;  ///< by fingerprint
  std::unordered_map<const NodeData*, Known> known_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> freeSlots_;
  std::vector<shader::PoolPiece> pieces_;
  std::vector<glm::uvec4> staged_;
  std::vector<shader::PoolInsert> inserts_;
  std::vector<Wanted> wanted_;
  std::uint64_t frame_ = 0;
};

}  // namespace strata
