#include "render/progressive/point_pool.h"

#include <algorithm>

#include "core/error.h"
#include "core/fingerprint.h"
#include "core/log.h"
#include "render/progressive/shuffle.h"

namespace strata {
namespace {

constexpr std::uint32_t kMostGroups = 65535;  ///< the work-groups that OpenGL guarantees in one dispatch
constexpr std::uint32_t kSlack = 32;          ///< a 32nd of a pool that is too small stays free, so that blocks fit
constexpr std::uint32_t kCached = 4;       ///< room for a quarter more than what is shown keeps what was shown before
constexpr std::uint32_t kPrintEvery = 16;  ///< the fingerprint takes in the first word of every 16th point

/// The number of points, `wanted` at most, that four of the driver's storage blocks hold.
std::uint32_t roomFor(const GlFunctions& gl, std::uint64_t wanted) {
  const std::uint64_t block = std::min(largestStorageBlock(gl), std::uint64_t{1} << 33);
  const std::uint64_t room = std::min({wanted, STRATA_POOL_PAGES * (block / sizeof(glm::uvec4)), block / 4});
  if (room < wanted)
    logWarning("OpenGL: the point pool holds " + std::to_string(room) + " points, not " + std::to_string(wanted) +
               ": the driver's storage blocks are no larger");
  return static_cast<std::uint32_t>(room);
}

std::vector<ShaderStage> poolStages(std::string_view file, std::uint32_t groupSize) {
  return {{gl::kComputeShader,
           {"shader_types.h", "pool.glsl", file},
           define("STRATA_GROUP_SIZE", std::to_string(groupSize))}};
}

std::uint32_t piecesOf(const Batch& batch) {
  return (batch.pointCount + PointPool::kPiecePoints - 1) / PointPool::kPiecePoints;
}

std::size_t batchIndex(const NodeData& node, std::uint32_t firstPoint) {
  const auto after = std::upper_bound(node.batches.begin(), node.batches.end(), firstPoint,
                                      [](std::uint32_t point, const Batch& batch) { return point < batch.firstPoint; });
  return static_cast<std::size_t>(after - node.batches.begin()) - 1;
}

/// The place of each index of the pool. It lies in the same band as the index.
std::vector<std::uint32_t> permutation(const std::vector<PoolSchedule::Band>& bands, std::uint32_t key,
                                       const ThreadPool& threads) {
  std::vector<std::uint32_t> places(bands.back().end);
  for (const PoolSchedule::Band& band : bands) {
    const std::uint32_t size = band.end - band.first;
    const KeyedShuffle shuffled(size, key++);
    threads.parallelFor(size, 1u << 16, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i)
        places[band.first + i] = band.first + shuffled(static_cast<std::uint32_t>(i));
    });
  }
  return places;
}

}  // namespace

PointPool::PointPool(const GlFunctions& functions, std::uint64_t points, std::uint32_t key, std::uint32_t groupSize,
                     const ThreadPool& threads)
    : gl_(functions),
      groupSize_(groupSize),
      manager_(roomFor(functions, points)),
      schedule_(size()),
      insert_(functions, poolStages("pool_insert.comp", groupSize)),
      fetch_(functions, poolStages("pool_fetch.comp", groupSize)),
      permutation_(functions, std::uint64_t{size()} * 4, gl::kStaticDraw),
      staging_(functions, 0, gl::kStreamDraw),
      insertBuffer_(functions, 0, gl::kStreamDraw),
      pieceBuffer_(functions, sizeof(shader::PoolPiece), gl::kStreamDraw) {
  if (size() == 0) throw Error("OpenGL", "a point pool needs room for a point, found none");
  pagePoints_ =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(size(), largestStorageBlock(gl_) / sizeof(glm::uvec4)));
  for (std::uint32_t first = 0; first < size(); first += pagePoints_) {
    const std::uint64_t room = std::min(pagePoints_, size() - first);
    pages_.push_back(std::make_unique<GlBuffer>(gl_, room * sizeof(glm::uvec4), gl::kDynamicCopy));
    pages_.back()->fill(STRATA_NO_POINT);
  }
  const std::vector<std::uint32_t> places = permutation(schedule_.bands(), key, threads);
  permutation_.write(0, places.data(), places.size() * 4);
  if (gl_.GetError() != 0)
    throw Error("OpenGL", "no memory for a point pool of " + std::to_string(size()) + " points, " +
                              std::to_string(gpuBytes() >> 20) + " MiB");
}

std::uint64_t PointPool::gpuBytes() const {
  return std::uint64_t{size()} * (sizeof(glm::uvec4) + 4) + staging_.bytes() + pieceBuffer_.bytes();
}

/// Identifies a node by its points: the fingerprint stays the same when the node leaves the host's memory and comes
/// back, and when more of its planes are loaded.
std::uint64_t PointPool::fingerprint(const std::shared_ptr<const NodeData>& node) {
  const auto found = known_.find(node.get());
  if (found != known_.end() && !found->second.node.expired()) return found->second.fingerprint;
  Fingerprint print;
  print.add(node->key.code);
  print.add(node->origin);
  print.add(node->pointCount());
  for (const Batch& batch : node->batches) {
    print.add(batch.firstPoint);
    print.add(batch.boxMin);
    print.add(batch.bits);
  }
  for (std::size_t i = 0; i < node->position[0].size(); i += kPrintEvery) print.add(node->position[0][i]);
  known_[node.get()] = {node, print.value()};
  return print.value();
}

/// The pool's node for `data`. A list may name a node twice, or a node and its copy; the second gets the next free
/// fingerprint, so that each has pieces of its own.
PointPool::Node& PointPool::nodeOf(const std::shared_ptr<const NodeData>& data) {
  std::uint64_t print = fingerprint(data);
  for (;; ++print) {
    Node& node = nodes_[print];
    if (node.frame == frame_) continue;
    node.frame = frame_;
    if (node.firstPiece.empty()) {
      std::uint32_t pieces = 0;
      for (const Batch& batch : data->batches) {
        node.firstPiece.push_back(pieces);
        pieces += piecesOf(batch);
      }
      node.slots.assign(pieces, kNoSlot);
    }
    return node;
  }
}

void PointPool::beginFrame() {
  ++frame_;
  manager_.beginFrame();
  schedule_.beginFrame(freeSlots_);
  std::erase_if(known_, [](const auto& entry) { return entry.second.node.expired(); });
  std::erase_if(nodes_, [](const auto& entry) { return entry.second.held == 0; });
  pieces_.assign(std::max<std::size_t>(slots_.size(), 1), {});
  for (const auto& [slot, bands] : schedule_.ghosts()) pieces_[slot].flags = STRATA_PIECE_DEAD;
  staged_.clear();
  inserts_.clear();
  wanted_.clear();
}

void PointPool::findWanted(const RenderList& list, const DrawPlan& plan) {
  Node* node = nullptr;
  for (std::size_t b = 0; b < plan.batches.size(); ++b) {
    const PlannedBatch& batch = plan.batches[b];
    if (b == 0 || batch.item != plan.batches[b - 1].item) node = &nodeOf(list.items[batch.item].node);
    const std::size_t index = batchIndex(*batch.node, batch.firstPoint);
    const std::uint32_t whole = batch.node->batches[index].pointCount;
    std::uint32_t piece = node->firstPiece[index];
    const auto seen = static_cast<float>(list.items[batch.item].pointCount);
    for (std::uint32_t first = 0; first < batch.pointCount; first += kPiecePoints, ++piece)
      wanted_.push_back({node, &batch, piece, first, std::min(kPiecePoints, whole - first),
                         static_cast<float>(batch.firstPoint + first) / seen});
  }
}

/// Moves the pieces that the pool has room for to the front of wanted_, and returns how many they are. The pieces are
/// ordered by their share, so that the same share of every node stays out.
std::size_t PointPool::fitting() {
  std::uint64_t points = 0;
  for (const Wanted& wanted : wanted_) points += wanted.points;
  if (points <= size()) return wanted_.size();
  std::stable_sort(wanted_.begin(), wanted_.end(), [](const Wanted& a, const Wanted& b) { return a.share < b.share; });
  std::uint64_t left = size() - size() / kSlack;
  const auto end = std::find_if(wanted_.begin(), wanted_.end(), [&left](const Wanted& wanted) {
    if (wanted.points > left) return true;
    left -= wanted.points;
    return false;
  });
  return static_cast<std::size_t>(end - wanted_.begin());
}

/// Limits new pieces to a part of the pool not much larger than the first `fits` of wanted_ need, so that a turn is
/// short.
void PointPool::limitTo(std::size_t fits) {
  std::uint64_t points = 0;
  for (std::size_t w = 0; w < fits; ++w) points += wanted_[w].points;
  const std::uint64_t band = schedule_.bandPlaces(), bands = (points + points / kCached + band - 1) / band;
  manager_.setLimit(static_cast<std::uint32_t>(std::min<std::uint64_t>(bands * band, size())));
}

/// True when a piece in the pool lacks planes or classes that are needed and that its node has by now.
bool PointPool::isOld(const Wanted& wanted, bool classes) const {
  const Slot& slot = slots_[wanted.node->slots[wanted.piece]];
  return slot.planes < static_cast<int>(wanted.batch->precision) ||
         (classes && !slot.classes && !wanted.batch->node->classification.empty());
}

PoolUpdate PointPool::show(const RenderList& list, const DrawPlan& plan, bool classes, std::uint64_t mostPoints) {
  beginFrame();
  PoolUpdate result;
  std::vector<bool> incomplete(list.items.size());
  findWanted(list, plan);
  const std::size_t fits = fitting();
  std::vector<const Wanted*> missing;
  for (std::size_t w = 0; w < wanted_.size(); ++w) {
    const Wanted& wanted = wanted_[w];
    const std::uint32_t slot = wanted.node->slots[wanted.piece];
    if (slot != kNoSlot) {
      setPiece(slot, *wanted.batch, wanted.first);
      if (w < fits) manager_.shown(slots_[slot].block);
    }
    if (w >= fits) {
      incomplete[wanted.batch->item] = true;
    } else if (slot == kNoSlot || isOld(wanted, classes)) {
      missing.push_back(&wanted);
    }
  }
  limitTo(fits);
  std::stable_sort(missing.begin(), missing.end(),
                   [](const Wanted* a, const Wanted* b) { return a->share < b->share; });
  // Once the pool is full or the frame's budget is used up, pieces that are only rewritten may still pass.
  bool full = false;
  for (const Wanted* piece : missing) {
    const bool within = staged_.empty() || staged_.size() + piece->points <= mostPoints;
    const bool isNew = piece->node->slots[piece->piece] == kNoSlot;
    if (!within || (isNew && (full || !makeRoom(*piece)))) {
      full = full || within;
      incomplete[piece->batch->item] = true;
      continue;
    }
    const std::uint32_t slot = piece->node->slots[piece->piece];
    stage(*piece->batch, piece->first, piece->points, slot);
    setPiece(slot, *piece->batch, piece->first);
    if (isNew) continue;
    pieces_[slot].flags |= STRATA_PIECE_WRITTEN;
    result.rewritten = true;
  }
  result.nodesMissing = static_cast<std::uint32_t>(std::count(incomplete.begin(), incomplete.end(), true));
  result.pointsWritten = staged_.size();
  upload();
  return result;
}

/// Finds a slot and a block for a piece. False where there is none.
bool PointPool::makeRoom(const Wanted& missing) {
  if (freeSlots_.empty()) {
    if (slots_.size() >= kNoSlot) return false;
    freeSlots_.push_back(static_cast<std::uint32_t>(slots_.size()));
    slots_.emplace_back();
    pieces_.resize(slots_.size());
  }
  const std::uint32_t slot = freeSlots_.back();
  const auto block = manager_.allocate(missing.points, slot, [this](std::uint32_t gone) { free(gone); });
  if (!block) return false;
  freeSlots_.pop_back();
  slots_[slot] = {missing.node, missing.piece, *block, 0, false};
  missing.node->slots[missing.piece] = slot;
  ++missing.node->held;
  return true;
}

void PointPool::free(std::uint32_t slot) {
  const PoolBlock& block = *slots_[slot].block;
  schedule_.freed(slot, block.first, block.size);
  Node& node = *slots_[slot].node;
  node.slots[slots_[slot].piece] = kNoSlot;
  --node.held;
  slots_[slot] = {};
  pieces_[slot] = {};
  pieces_[slot].flags = STRATA_PIECE_DEAD;
}

void PointPool::stage(const PlannedBatch& batch, std::uint32_t first, std::uint32_t count, std::uint32_t slot) {
  const NodeData& data = *batch.node;
  const std::uint32_t firstPoint = batch.firstPoint + first;
  slots_[slot].planes = data.loadedPlanes();
  slots_[slot].classes = !data.classification.empty();
  inserts_.push_back({slots_[slot].block->first, count, static_cast<std::uint32_t>(staged_.size()), 0});
  for (std::uint32_t i = 0; i < count; ++i) {
    glm::uvec4 point(0, 0, 0, slot << STRATA_PIECE_BITS | i);
    for (int plane = 0; plane < slots_[slot].planes; ++plane) point[plane] = data.position[plane][firstPoint + i];
    const std::uint32_t kind = slots_[slot].classes ? data.classification[firstPoint + i] : 0u;
    for (int word = 0; word < 4; ++word) point[word] |= (kind >> (2 * word) & 3u) << 30;
    staged_.push_back(point);
  }
}

/// Enters in the table by slot how the view sees the piece that begins `first` points into the batch. The pool may have
/// fewer planes of it than the plan counts on; then each coordinate covers 10 bits more of the grid.
void PointPool::setPiece(std::uint32_t slot, const PlannedBatch& batch, std::uint32_t first) {
  const int wanted = static_cast<int>(batch.precision), planes = std::min(wanted, slots_[slot].planes);
  shader::PoolPiece& piece = pieces_[slot];
  piece.count = std::min(kPiecePoints, batch.pointCount - first);
  piece.first = slots_[slot].block->first;
  piece.flags = static_cast<std::uint32_t>(planes) | (batch.clipped ? STRATA_PIECE_CLIPPED : 0u) |
                (slots_[slot].classes ? STRATA_PIECE_CLASSES : 0u) | batch.mapping.grid << STRATA_PIECE_GRID;
  const auto half = [](int shift) { return shift > 0 ? 1 << (shift - 1) : 0; };
  piece.shifts = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int shift = batch.mapping.shift[axis] + 10 * (wanted - planes);
    piece.offset[axis] = batch.mapping.offset[axis] - half(batch.mapping.shift[axis]) + half(shift);
    piece.shifts |= static_cast<std::uint32_t>(shift + 128) << (8 * axis);
  }
  piece.offset.w = static_cast<int>(batch.firstId + first);
  schedule_.shown(piece.first, slots_[slot].block->size);
}

void PointPool::bindPool() {
  for (std::uint32_t page = 0; page < STRATA_POOL_PAGES; ++page)
    pages_[std::min<std::size_t>(page, pages_.size() - 1)]->bindStorage(page);
  permutation_.bindStorage(STRATA_BINDING_PERMUTATION);
  gl_.Uniform1ui(STRATA_UNIFORM_PAGE_POINTS, pagePoints_);
}

void PointPool::upload() {
  pieceBuffer_.assign(pieces_.data(), pieces_.size() * sizeof(shader::PoolPiece));
  if (staged_.empty()) return;
  insert_.use();
  bindPool();
  staging_.assign(staged_.data(), staged_.size() * sizeof(glm::uvec4));
  insertBuffer_.assign(inserts_.data(), inserts_.size() * sizeof(shader::PoolInsert));
  staging_.bindStorage(STRATA_BINDING_STAGED);
  insertBuffer_.bindStorage(STRATA_BINDING_INSERTS);
  gl_.DispatchCompute(static_cast<unsigned>(inserts_.size()), 1, 1);
  gl_.MemoryBarrier(gl::kShaderStorageBarrier);
}

void PointPool::fetchAgain(const GlBuffer& kept, std::uint32_t pixels) {
  fetch_.use();
  bindPool();
  kept.bindStorage(STRATA_BINDING_STAGED);
  bindPieces(STRATA_BINDING_INSERTS);
  gl_.Uniform3ui(STRATA_UNIFORM_RANGE, 0, pixels, 0);
  gl_.DispatchCompute(std::min((pixels + groupSize_ - 1) / groupSize_, kMostGroups), 1, 1);
  gl_.MemoryBarrier(gl::kShaderStorageBarrier);
}

}  // namespace strata
