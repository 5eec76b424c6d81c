#include <cstdio>
#include <ctime>

#include "tests/bench/other_samplings.h"
#include "tests/support/evenness.h"

/// How even the prefixes of each sampling are on a dense plane, and what they cost.
int main() {
  using namespace strata;
  using namespace strata::test;
  std::printf("1 M random points of a square, 65 536 kept, 3 rotations\n");
  std::printf("%-10s %12s %12s %14s\n", "sampling", "full levels", "anywhere", "CPU ns/point");
  struct Way {
    const char* name;
    LevelOrder (*order)(const LocalPoints&, std::size_t, TreeScratch&);
  };
  for (const Way& way : {Way{"ntree", levelOrder}, Way{"poisson", poissonOrder}, Way{"random", randomOrder}}) {
    std::mt19937_64 random(1);
    TreeScratch scratch;
    Evenness worst;
    double seconds = 0.0;
    for (int turn = 0; turn < 3; ++turn) {
      const Cloud cloud = turnedBox(random, {150.0, 150.0, 0.01}, 1000000, anyTurn(random));
      const std::clock_t begin = std::clock();
      const LevelOrder levels = way.order(cloud.local(), 65536, scratch);
      seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      const Evenness one = evennessOf(cloud, levels.order, levels.prefix);
      worst.fullLevels = std::max(worst.fullLevels, one.fullLevels);
      worst.anywhere = std::max(worst.anywhere, one.anywhere);
    }
    std::printf("%-10s %12.2f %12.2f %14.1f\n", way.name, worst.fullLevels, worst.anywhere, seconds / 3e6 * 1e9);
  }
  return 0;
}
