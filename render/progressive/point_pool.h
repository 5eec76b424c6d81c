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

/// What one call of PointPool::show() did.
struct PoolUpdate {
  std::uint32_t nodesMissing = 0;  ///< nodes of the list with visible points that are not in the pool
  std::uint64_t pointsWritten = 0;
  bool rewritten = false;  ///< true when pieces that pixels may show have been written again
};

/// Keeps points of nodes at shuffled places of GPU memory (Rumpler 2019, 3.1 to 3.4). A node comes in pieces, each a
/// quarter of a batch at most, so that little more of it is in the pool than the prefix that is seen. A point consists
/// of the node's words and the slot of its piece. A table by slot, which is made anew for each frame, tells where the
/// piece lies in space and how much of it is drawn. So points do not depend on an origin, and a freed piece is not
/// drawn from the same frame on. What is left of its points in the pool (Rumpler's ghosts) is removed during one turn
/// of the schedule, and only then the slot is used again.
class PointPool {
 public:
  static constexpr std::uint32_t kPiecePoints = 2560;  ///< a quarter of a batch

  /// Makes room for `points` points, or for as many as four of the driver's storage blocks hold, with a warning. `key`
  /// selects the shuffle. Throws Error where memory is missing or a shader does not compile.
  PointPool(const GlFunctions& functions, std::uint64_t points, std::uint32_t key, std::uint32_t groupSize,
            const ThreadPool& threads);

  /// Takes the points that `plan` of `list` shows into the pool, but at most `mostPoints` in this frame; a first piece
  /// always passes. The first pieces of all nodes come before later ones. Where the view shows more than the pool
  /// holds, the same share of each node's last pieces stays out. Such pieces are drawn as long as they are there, and
  /// give way to the first pieces of a node that comes into view. `classes` says whether points need their classes.
  PoolUpdate show(const RenderList& list, const DrawPlan& plan, bool classes, std::uint64_t mostPoints);
  /// The schedule of the fill pass. Its places lie in pages of pagePoints() each.
  PoolSchedule& schedule() { return schedule_; }
  const PoolSchedule& schedule() const { return schedule_; }

  std::uint32_t size() const { return manager_.size(); }
  std::uint32_t pagePoints() const { return pagePoints_; }
  const PoolManager& manager() const { return manager_; }
  std::uint32_t ghostPieces() const { return static_cast<std::uint32_t>(schedule_.ghosts().size()); }
  std::uint64_t gpuBytes() const;

  void bindPage(std::uint32_t page, unsigned binding) const { pages_[page]->bindStorage(binding); }
  void bindPieces(unsigned binding) const { pieceBuffer_.bindStorage(binding); }
  /// After show() has set PoolUpdate::rewritten: fetches the points that `pixels` pixels of `kept` show once more,
  /// where their pieces were written again.
  void fetchAgain(const GlBuffer& kept, std::uint32_t pixels);

 private:
  static constexpr std::uint32_t kNoSlot = (1u << STRATA_SLOT_BITS) - 1u;

  struct Node {
    std::vector<std::uint32_t> firstPiece;  ///< the number of each batch's first piece
    std::vector<std::uint32_t> slots;       ///< the slot of each piece; kNoSlot where it is not in the pool
    std::uint32_t held = 0;                 ///< pieces in the pool
    std::uint64_t frame = 0;                ///< the last frame that listed the node
  };
  struct Slot {
    Node* node = nullptr;  ///< null: the slot is free or a ghost
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
    float share;           ///< the share of the node's visible points that come before it
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
