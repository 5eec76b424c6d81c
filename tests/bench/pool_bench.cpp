// What the point pool is made of, without OpenGL, as tables of docs/benchmarks/progressive.md: the permutations
// (Rumpler 2019, 4.2.2) and the memory that fragments (4.1.5). --small: a hundredth.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <list>
#include <random>
#include <string>
#include <vector>

#include "render/progressive/point_pool.h"
#include "render/progressive/pool_manager.h"
#include "render/progressive/shuffle.h"
#include "tests/support/perfect_shuffle.h"

namespace strata::bench {
namespace {

/// The fraction of the points in one frame's share of the pool whose next point of the same node lies there too.
void shuffleTable(std::uint32_t part) {
  constexpr std::uint32_t kShares = 32;
  std::printf("Points whose successor is drawn in the same frame, of a pool that is drawn in %u (4.2.2):\n\n", kShares);
  std::printf("| pool | perfect shuffle | keyed |\n|---|---|---|\n");
  for (const std::uint32_t full : {1u << 25, 1u << 24, 30'000'000u, 25'000'000u, 20'000'000u}) {
    const std::uint32_t size = full / part / 2 * 2;
    const KeyedShuffle keyed(size, 1);
    double together[2] = {};
    for (const int way : {0, 1}) {
      std::vector<std::uint32_t> points(kShares), pairs(kShares);
      std::uint64_t last = kShares;
      for (std::uint32_t i = 0; i < size; ++i) {
        const std::uint32_t place = way == 0 ? test::perfectShuffle(i, size, test::perfectShuffles(size)) : keyed(i);
        const std::uint64_t share = std::uint64_t{place} * kShares / size;
        ++points[share];
        pairs[share] += share == last;
        last = share;
      }
      for (std::uint32_t s = 0; s < kShares; ++s)
        together[way] = std::max(together[way], static_cast<double>(pairs[s]) / std::max(points[s], 1u));
    }
    std::printf("| %u%s | %.1f %% | %.1f %% |\n", size, std::has_single_bit(size) ? ", a power of two" : "",
                100.0 * together[0], 100.0 * together[1]);
    std::fflush(stdout);
  }
}

/// A plane of square nodes with random numbers of points.
struct Ground {
  static constexpr int kSide = 96;  ///< nodes
  std::vector<std::uint32_t> points;

  explicit Ground(std::uint32_t most) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> magnitude(std::log(0.01), 0.0);
    for (int i = 0; i < kSide * kSide; ++i)
      points.push_back(static_cast<std::uint32_t>(most * std::exp(magnitude(random))) + 1);
  }
};

/// What the manager is asked for: whole nodes, as in the paper, or pieces of their visible points.
struct Way {
  const char* name;
  bool pieces;
};

/// A camera that wanders over the ground. A view shows the nodes next to it, up to a budget, and the far ones in part.
class Wanderer {
 public:
  Wanderer(const Ground& ground, Way way, std::uint32_t pool, std::uint64_t budget)
      : ground_(ground), way_(way), budget_(budget), manager_(pool), held_(ground.points.size()) {}

  void step() {
    std::normal_distribution<double> turn(0.0, 0.5);
    heading_ += turn(random_);
    const double most = Ground::kSide - 1.0;
    x_ += std::cos(heading_);
    y_ += std::sin(heading_);
    if (x_ < 0.0 || x_ > most || y_ < 0.0 || y_ > most) heading_ += 3.0;
    x_ = std::clamp(x_, 0.0, most);
    y_ = std::clamp(y_, 0.0, most);
    show();
  }

  std::uint32_t shownPlaces() const { return shown_; }
  std::uint64_t leftOut() const { return leftOut_; }
  const PoolManager& manager() const { return manager_; }

 private:
  struct Block {
    bool held = false;
    PoolManager::Block block;
  };
  struct Wanted {
    std::uint32_t node, piece, size;
  };

  std::vector<Wanted> wanted() const {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t node = 0; node < ground_.points.size(); ++node)
      near.emplace_back(std::hypot(node % Ground::kSide - x_, static_cast<int>(node / Ground::kSide) - y_), node);
    std::sort(near.begin(), near.end());
    std::vector<Wanted> all;
    std::uint64_t left = budget_;
    for (const auto& [distance, node] : near) {
      const std::uint32_t whole = ground_.points[node];
      const auto seen = static_cast<std::uint32_t>(whole / (1.0 + 0.02 * distance * distance)) + 1;
      const std::uint32_t size = way_.pieces ? PointPool::kPiecePoints : whole;
      for (std::uint32_t first = 0, piece = 0; first < (way_.pieces ? seen : 1); first += size, ++piece) {
        const std::uint32_t points = std::min(size, whole - first);
        if (points > left) return all;
        left -= points;
        all.push_back({node, piece, points});
      }
    }
    return all;
  }

  void show() {
    manager_.beginFrame();
    const std::vector<Wanted> all = wanted();
    shown_ = 0;
    std::vector<Wanted> missing;
    for (const Wanted& w : all) {
      std::vector<Block>& blocks = held_[w.node];
      if (blocks.size() <= w.piece) blocks.resize(w.piece + 1);
      shown_ += w.size;
      if (blocks[w.piece].held)
        manager_.shown(blocks[w.piece].block);
      else
        missing.push_back(w);
    }
    for (const Wanted& w : missing) {
      const auto owner = static_cast<std::uint32_t>(owners_.size());
      const auto block = manager_.allocate(
          w.size, owner, [this](std::uint32_t gone) { held_[owners_[gone].node][owners_[gone].piece].held = false; });
      if (!block) {
        shown_ -= w.size;
        ++leftOut_;
        continue;
      }
      owners_.push_back(w);
      held_[w.node][w.piece] = {true, *block};
    }
  }

  const Ground& ground_;
  const Way way_;
  const std::uint64_t budget_;
  PoolManager manager_;
  std::vector<std::vector<Block>> held_;
  std::vector<Wanted> owners_;
  std::mt19937 random_{2};
  double x_ = Ground::kSide / 2.0, y_ = x_, heading_ = 0.0;
  std::uint32_t shown_ = 0;
  std::uint64_t leftOut_ = 0;
};

void fragmentationRow(const Way& way, const Ground& ground, std::uint32_t pool, std::uint64_t budget, int steps) {
  Wanderer wanderer(ground, way, pool, budget);
  for (int phase = 1; phase <= 2; ++phase) {
    for (int i = 0; i < steps; ++i) wanderer.step();
    std::uint32_t pieces = 0, largest = 0;
    for (const PoolBlock& block : wanderer.manager().blocks()) {
      if (!block.free) continue;
      ++pieces;
      largest = std::max(largest, block.size);
    }
    const auto share = [pool](std::uint32_t places) { return 100.0 * places / pool; };
    std::printf("| %s | %.1f M | %d | %.2f %% | %.2f %% | %u | %u | %llu |\n", way.name, 1e-6 * pool, phase * steps,
                share(pool - wanderer.manager().freePoints()), share(wanderer.shownPlaces()), pieces, largest,
                static_cast<unsigned long long>(wanderer.leftOut()));
    std::fflush(stdout);
  }
}

/// The setting of the paper: 25 and 100 million places, a budget of 20 million points, nodes of up to 100 000 points.
void fragmentationTable(std::uint32_t part) {
  const std::uint32_t pool = 25'000'000 / part, large = 100'000'000 / part, most = std::max(100'000 / part, 10'000u);
  const std::uint64_t budget = 20'000'000 / part;
  const int steps = part > 1 ? 50 : 800;
  const Ground ground(most);
  std::printf("\nMemory in use after a walk of so many views (4.1.5), budget %.1f M points:\n\n",
              1e-6 * static_cast<double>(budget));
  std::printf(
      "| blocks | pool | views | taken | shown | free blocks | largest of them | not placed |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const Way& way : {Way{"whole nodes", false}, Way{"pieces", true}})
    for (const std::uint32_t size : {pool, large}) fragmentationRow(way, ground, size, budget, steps);
}

}  // namespace
}  // namespace strata::bench

int main(int argc, char** argv) {
  const bool small = argc == 2 && std::string(argv[1]) == "--small";
  if (argc > 1 && !small) {
    std::fprintf(stderr, "usage: pool_bench [--small]\n");
    return 2;
  }
  strata::bench::shuffleTable(small ? 64 : 1);
  strata::bench::fragmentationTable(small ? 100 : 1);
}
