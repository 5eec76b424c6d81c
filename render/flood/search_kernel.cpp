#include "render/flood/search_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/flood/search_kernel.cpp"  // compiled once for each instruction set
#include <hwy/foreach_target.h>
// These come behind foreach_target.h, because they are compiled for one target at a time.
#include <hwy/highway.h>
// This one comes last, because it uses the types of highway.h.
#include "render/flood/flood_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace strata {
namespace HWY_NAMESPACE {
namespace {

/// A vector of seeds. Lanes without a seed hold undefined values.
struct Seeds {
  Floats x, y, z, reach, normalX, normalY, normalZ;
};

/// Looks up the seeds of one half picture.
class SeedTable {
 public:
  explicit SeedTable(const FloodSeeds& seeds)
      : width_(static_cast<std::uint32_t>(seeds.width)),
        lens_(seeds.lens),
        points_(&seeds.points.data()->depth),
        normal_(seeds.normals.empty() ? nullptr : reinterpret_cast<const std::int32_t*>(seeds.normals.data())) {}

  bool hasNormals() const { return normal_ != nullptr; }

  Floats metres(Floats depth) const {
    const auto perPixel = hn::Set(kFloat, lens_.perPixel);
    return lens_.perspective ? perPixel * depth : perPixel;
  }

  HWY_INLINE Seeds gather(Words seed, Mask some) const {
    Seeds out;
    const auto safe = hn::IfThenElseZero(toWord(some), seed);
    const auto index =
        hn::BitCast(kInteger, hn::ShiftRight<17>(safe) * hn::Set(kWord, width_) + hn::ShiftRight<1>(column(safe)));
    out.z = hn::GatherIndex(kFloat, points_, index + index);
    out.reach = hn::GatherIndex(kFloat, points_ + 1, index + index);
    const auto size = metres(out.z);
    out.x = (toFloat(column(safe)) - hn::Set(kFloat, lens_.middleX - 0.5f)) * size;
    out.y = (hn::Set(kFloat, lens_.middleY - 0.5f) - toFloat(row(safe))) * size;
    out.normalX = out.normalY = out.normalZ = hn::Zero(kFloat);
    if (normal_ == nullptr) return out;
    const auto packed = hn::BitCast(kWord, hn::GatherIndex(kInteger, normal_, index));
    const auto known = toMask(hn::Ne(packed, hn::Zero(kWord)));
    const auto part = [known](Words bits) {
      const auto value = toFloat(hn::And(bits, hn::Set(kWord, 1023u))) - hn::Set(kFloat, 512.0f);
      return hn::IfThenElseZero(known, value * hn::Set(kFloat, 1.0f / 511.0f));
    };
    out.normalX = part(packed);
    out.normalY = part(hn::ShiftRight<10>(packed));
    out.normalZ = part(hn::ShiftRight<20>(packed));
    return out;
  }

 private:
  const std::uint32_t width_;
  const FloodLens& lens_;
  const float* points_;
  const std::int32_t* normal_;
};

struct Triple {
  Floats x, y, z;
};

HWY_INLINE Floats dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

HWY_INLINE Triple normalOf(const Seeds& seeds) { return {seeds.normalX, seeds.normalY, seeds.normalZ}; }

HWY_INLINE Triple difference(const Seeds& a, const Seeds& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

HWY_INLINE Floats distance2(const Seeds& a, const Seeds& b) {
  const Triple apart = difference(a, b);
  return dot(apart, apart);
}

/// sameLayer() for seeds whose squared distance is known.
HWY_INLINE Mask same(const Seeds& a, const Seeds& b, Floats distance2, bool normals, const FloodSettings& settings) {
  const auto reach = hn::Min(a.reach, b.reach);
  const auto near = hn::Le(distance2, reach * reach);
  if (!normals || hn::AllFalse(kFloat, near)) return near;
  const auto isNone = [](const Seeds& s) { return hn::Eq(dot(normalOf(s), normalOf(s)), hn::Zero(kFloat)); };
  const Triple apart = difference(a, b);
  const auto off = [&](const Seeds& s) { return hn::Abs(dot(apart, normalOf(s))); };
  const auto cosine = hn::Abs(dot(normalOf(a), normalOf(b)));
  const auto alike = hn::And(hn::Ge(cosine, hn::Set(kFloat, settings.angle)),
                             hn::Lt(hn::Max(off(a), off(b)), hn::Set(kFloat, settings.continuity) * reach));
  return hn::And(near, hn::Or(hn::Or(isNone(a), isNone(b)), alike));
}

/// What a vector of pixels holds in one of its layers. It lies in memory, because the layers do not fit the registers.
struct Held {
  HWY_ALIGN FloodPixel seed[kFloodTile];
  HWY_ALIGN float distance2[kFloodTile];  ///< squared pixels of the half picture
  HWY_ALIGN float parts[7][kFloodTile];   ///< of Seeds, in its order
};

/// Searches the layers of a vector of pixels. A candidate replaces the seed of its own layer if it is closer in the
/// picture, fills an empty layer, or replaces the farthest seed of all.
class LayerSearch {
 public:
  LayerSearch(const LayerRound& round, const SeedTable& table, int x, int y)
      : round_(round),
        table_(table),
        inside_(hn::FirstN(kFloat, static_cast<std::size_t>(std::max(round.seeds.width - x, 0)))),
        x_(hn::Iota(kFloat, static_cast<float>(x))),
        y_(hn::Set(kFloat, static_cast<float>(y))),
        here_(round.from.index(x, y)) {
    for (int k = 0; k < kFloodLayers; ++k)
      hn::Store(hn::LoadU(kWord, &round.from.layers[k][here_]), kWord, held_[k].seed);
  }

  /// Considers the candidates that the pixels at `from` hold.
  HWY_INLINE void look(std::size_t from) {
    for (const auto& layer : round_.from.layers) {
      const auto seed = hn::LoadU(kWord, &layer[from]);
      const auto some = hn::And(inside_, toMask(hn::Ne(seed, hn::Set(kWord, kNoPixel))));
      if (hn::AllFalse(kFloat, some)) return;
      auto known = hn::Eq(seed, heldSeed(0));
      for (int k = 1; k < kFloodLayers; ++k) known = hn::Or(known, hn::Eq(seed, heldSeed(k)));
      const auto fresh = hn::AndNot(toMask(known), some);
      if (!hn::AllFalse(kFloat, fresh)) consider(seed, fresh);
    }
  }

  void store() const {
    for (int k = 0; k < kFloodLayers; ++k) hn::StoreU(heldSeed(k), kWord, &round_.to.layers[k][here_]);
  }

 private:
  HWY_INLINE Words heldSeed(int k) const { return hn::Load(kWord, held_[k].seed); }

  HWY_INLINE Floats pixels2(Words seed) const {
    const auto dx = toFloat(hn::ShiftRight<1>(column(seed))) - x_, dy = toFloat(hn::ShiftRight<17>(seed)) - y_;
    return dx * dx + dy * dy;
  }

  HWY_INLINE void put(int k, Mask where, Words seed, Floats distance2, const Seeds& seeds) {
    Held& held = held_[k];
    hn::BlendedStore(seed, toWord(where), kWord, held.seed);
    hn::BlendedStore(distance2, where, kFloat, held.distance2);
    const auto set = [&](int i, Floats value) { hn::BlendedStore(value, where, kFloat, held.parts[i]); };
    set(0, seeds.x);
    set(1, seeds.y);
    set(2, seeds.z);
    set(3, seeds.reach);
    if (!table_.hasNormals()) return;
    set(4, seeds.normalX);
    set(5, seeds.normalY);
    set(6, seeds.normalZ);
  }

  HWY_INLINE Seeds get(int k) const {
    const auto part = [&](int i) { return hn::Load(kFloat, held_[k].parts[i]); };
    Seeds out{part(0), part(1), part(2), part(3), hn::Zero(kFloat), hn::Zero(kFloat), hn::Zero(kFloat)};
    if (!table_.hasNormals()) return out;
    out.normalX = part(4);
    out.normalY = part(5);
    out.normalZ = part(6);
    return out;
  }

  /// Looks up what the pixels held before this round. Most vectors meet no new candidate and never need this.
  HWY_NOINLINE void lookUpHeld() {
    lookedUp_ = true;
    for (int k = 0; k < kFloodLayers; ++k) {
      const auto some = toMask(hn::Ne(heldSeed(k), hn::Set(kWord, kNoPixel)));
      const auto all = hn::FirstN(kFloat, hn::Lanes(kFloat));
      put(k, all, heldSeed(k), pixels2(heldSeed(k)), table_.gather(heldSeed(k), some));
    }
  }

  /// The lanes in which a candidate is closer to its pixel than another; of equally close ones the smaller pixel wins.
  HWY_INLINE static Mask closer(Words seed, Floats distance2, Words otherSeed, Floats otherDistance2) {
    return hn::Or(hn::Lt(distance2, otherDistance2),
                  hn::And(hn::Eq(distance2, otherDistance2), toMask(hn::Lt(seed, otherSeed))));
  }

  HWY_NOINLINE void consider(Words seed, Mask fresh) {
    if (!lookedUp_) lookUpHeld();
    const Seeds seeds = table_.gather(seed, fresh);
    const auto pixels = pixels2(seed);
    const auto reachPx = hn::Set(kFloat, 0.5f) * seeds.reach / table_.metres(seeds.z) + hn::Set(kFloat, 1.0f);
    auto open = hn::And(fresh, hn::Le(pixels, reachPx * reachPx));
    if (hn::AllFalse(kFloat, open)) return;
    auto farthest = hn::Load(kFloat, held_[0].distance2);
    auto farthestSeed = heldSeed(0);
    auto farthestLayer = hn::Zero(kWord);
    for (int k = 0; k < kFloodLayers; ++k) {
      const auto otherSeed = heldSeed(k);
      const auto other = hn::Load(kFloat, held_[k].distance2);
      const auto empty = hn::And(open, toMask(hn::Eq(otherSeed, hn::Set(kWord, kNoPixel))));
      const Seeds held = get(k);
      const auto alike = hn::AndNot(
          empty, hn::And(open, same(seeds, held, distance2(seeds, held), table_.hasNormals(), round_.settings)));
      const auto here = hn::Or(empty, hn::And(alike, closer(seed, pixels, otherSeed, other)));
      if (!hn::AllFalse(kFloat, here)) put(k, here, seed, pixels, seeds);
      open = hn::AndNot(hn::Or(empty, alike), open);
      if (hn::AllFalse(kFloat, open)) return;
      const auto farther =
          hn::Or(hn::Gt(other, farthest), hn::And(hn::Eq(other, farthest), toMask(hn::Gt(otherSeed, farthestSeed))));
      farthest = hn::IfThenElse(farther, other, farthest);
      farthestSeed = hn::IfThenElse(toWord(farther), otherSeed, farthestSeed);
      farthestLayer = hn::IfThenElse(toWord(farther), hn::Set(kWord, static_cast<std::uint32_t>(k)), farthestLayer);
    }
    const auto replace = hn::And(open, closer(seed, pixels, farthestSeed, farthest));
    if (hn::AllFalse(kFloat, replace)) return;
    for (int k = 0; k < kFloodLayers; ++k)
      put(k, hn::And(replace, toMask(hn::Eq(farthestLayer, hn::Set(kWord, static_cast<std::uint32_t>(k))))), seed,
          pixels, seeds);
  }

  const LayerRound& round_;
  const SeedTable& table_;
  const Mask inside_;
  const Floats x_, y_;
  const std::size_t here_;
  bool lookedUp_ = false;
  Held held_[kFloodLayers];
};

void searchLayersHere(const LayerRound& round, int x, int y) {
  const SeedTable table(round.seeds);
  for (int end = x + kFloodTile; x < std::min(end, round.seeds.width); x += static_cast<int>(hn::Lanes(kFloat))) {
    LayerSearch search(round, table, x, y);
    for (int v = y - round.step; v <= y + round.step; v += round.step)
      if (v >= 0 && v < round.seeds.height)
        for (int u = x - round.step; u <= x + round.step; u += round.step)
          if (u != x || v != y) search.look(round.from.index(x, v) + static_cast<std::size_t>(u - x));
    search.store();
  }
}

/// Looks up entries of a table of kFloodNeighbours values, which are repeated up to kFloodTile.
template <typename Tag, typename T>
HWY_INLINE hn::Vec<Tag> lookUp(Tag tag, const T* table, Words index) {
  if (hn::Lanes(tag) < kFloodNeighbours) return hn::GatherIndex(tag, table, hn::BitCast(kInteger, index));
  return hn::TableLookupLanes(hn::Load(tag, table), hn::IndicesFromVec(tag, index));
}

void distancesToHere(const FloodSeeds& seeds, FloodPixel seed, const FloodNeighbours& others, float* out) {
  const SeedTable table(seeds);
  const auto all = hn::FirstN(kFloat, hn::Lanes(kFloat));
  const Seeds one = table.gather(hn::Set(kWord, seed), all);
  HWY_ALIGN FloodPixel padded[kFloodTile];
  HWY_ALIGN float distances[kFloodTile];
  std::copy(others.begin(), others.end(), padded);
  std::fill(padded + others.size(), padded + kFloodTile, kNoPixel);
  for (std::size_t i = 0; i < others.size(); i += hn::Lanes(kFloat)) {
    const auto other = hn::Load(kWord, padded + i);
    const auto some = toMask(hn::Ne(other, hn::Set(kWord, kNoPixel)));
    const auto far = hn::Set(kFloat, std::numeric_limits<float>::infinity());
    hn::Store(hn::IfThenElse(some, distance2(one, table.gather(other, some)), far), kFloat, distances + i);
  }
  std::copy_n(distances, others.size(), out);
}

std::size_t keepCloseHere(const FloodSeeds& seeds, const FloodSettings& settings, const NeighbourBounds& bounds,
                          std::span<const FloodPixel> candidates, const CloseCandidates& kept) {
  HWY_ALIGN FloodPixel held[kFloodTile];
  HWY_ALIGN float farthest2[kFloodTile];
  for (std::size_t i = 0; i < kFloodTile; ++i) {
    held[i] = bounds.held[i % kFloodNeighbours];
    farthest2[i] = bounds.farthest2[i % kFloodNeighbours];
  }
  const SeedTable table(seeds);
  const Seeds one = table.gather(hn::Set(kWord, bounds.seed), hn::FirstN(kFloat, hn::Lanes(kFloat)));
  const auto x = hn::Set(kFloat, static_cast<float>(pixelColumn(bounds.seed)));
  const auto y = hn::Set(kFloat, static_cast<float>(pixelRow(bounds.seed)));
  std::size_t out = 0;
  for (std::size_t i = 0; i < candidates.size(); i += hn::Lanes(kFloat)) {
    const auto seed = hn::LoadU(kWord, candidates.data() + i);
    const auto dx = toFloat(column(seed)) - x, dy = toFloat(row(seed)) - y;
    const auto which = sector(dx, dy);
    const auto most = lookUp(kFloat, farthest2, which);
    const auto fresh =
        hn::And(hn::And(hn::FirstN(kWord, candidates.size() - i), hn::Ne(seed, hn::Set(kWord, kNoPixel))),
                hn::And(hn::Ne(seed, hn::Set(kWord, bounds.seed)), hn::Ne(seed, lookUp(kWord, held, which))));
    // The distance in the picture bounds that in space from below, and rules most candidates out without a look-up.
    auto close = hn::And(toMask(fresh), hn::Le(hn::Set(kFloat, bounds.leastPerPixel2) * (dx * dx + dy * dy), most));
    if (hn::AllFalse(kFloat, close)) continue;
    const Seeds others = table.gather(seed, close);
    const auto distance = distance2(one, others);
    close = hn::And(hn::And(close, hn::Le(distance, most)), same(one, others, distance, table.hasNormals(), settings));
    // Whole vectors are stored, because compressing straight into memory takes some processors a hundred cycles.
    hn::StoreU(hn::Compress(distance, close), kFloat, kept.distance2 + out);
    hn::StoreU(hn::Compress(seed, toWord(close)), kWord, kept.seeds + out);
    out += hn::CountTrue(kFloat, close);
  }
  return out;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace strata
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata {

HWY_EXPORT(searchLayersHere);
HWY_EXPORT(distancesToHere);
HWY_EXPORT(keepCloseHere);

void searchLayers(const LayerRound& round, int x, int y) { HWY_DYNAMIC_DISPATCH(searchLayersHere)(round, x, y); }

void distancesTo(const FloodSeeds& seeds, FloodPixel seed, const FloodNeighbours& others, float* out) {
  HWY_DYNAMIC_DISPATCH(distancesToHere)(seeds, seed, others, out);
}

std::size_t keepClose(const FloodSeeds& seeds, const FloodSettings& settings, const NeighbourBounds& bounds,
                      std::span<const FloodPixel> candidates, const CloseCandidates& kept) {
  return HWY_DYNAMIC_DISPATCH(keepCloseHere)(seeds, settings, bounds, candidates, kept);
}

}  // namespace strata
#endif
