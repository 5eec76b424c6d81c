// More points in one place, or in one cell of the deepest level, than a node holds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "converter/build/slices.h"
#include "converter/convert.h"
#include "core/error.h"
#include "io/store/node_codec.h"
#include "io/store/store_files.h"
#include "io/store/verify.h"
#include "lod/hierarchy_index.h"
#include "lod/selection.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

/// Random points of a box, and `copies` of one in its middle; each with a number of its own.
class Copies final : public PointSource {
 public:
  Copies(std::uint64_t copies, std::uint64_t others) : copies_(copies) {
    info_.path = "copies";
    info_.format = "copies";
    info_.pointCount = copies + others;
    info_.boundsExact = true;
    info_.bounds = Box{glm::dvec3(0.0), glm::dvec3(100.0)};
    info_.step = glm::dvec3(0.001);
    info_.gridExact = true;
    info_.layout = PointLayout({{"extra:number", ScalarType::u32, 1, "", 1.0, 0.0}});
  }
  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override { return 1; }
  std::unique_ptr<PointReader> openPart(std::size_t) const override { return std::make_unique<Reader>(*this); }

 private:
  class Reader final : public PointReader {
   public:
    explicit Reader(const Copies& source) : source_(source) {}
    bool read(PointBlock& block, std::size_t most) override {
      const std::size_t count = std::min<std::size_t>(most, source_.info_.pointCount - next_);
      block.positions.resize(count);
      block.attributes.resize(count * 4);
      for (std::size_t i = 0; i < count; ++i, ++next_) {
        const auto number = static_cast<std::uint32_t>(next_);
        const auto at = [&] { return 0.001 * static_cast<double>(random_() % 100001); };
        block.positions[i] = next_ < source_.copies_ ? glm::dvec3(50.0, 50.001, 50.002) : glm::dvec3(at(), at(), at());
        std::memcpy(&block.attributes[4 * i], &number, 4);
      }
      return count > 0;
    }

   private:
    const Copies& source_;
    std::uint64_t next_ = 0;
    std::mt19937_64 random_{1};
  };

  std::uint64_t copies_;
  SourceInfo info_;
};

/// Converts, and checks that the store is sound and holds every number once.
void expectWhole(std::uint64_t copies, std::uint64_t others, std::uint64_t memory, const std::string& output) {
  std::vector<std::unique_ptr<PointSource>> sources;
  sources.push_back(std::make_unique<Copies>(copies, others));
  ConvertOptions options;
  options.output = output;
  options.threads = 2;
  options.memoryBytes = memory;
  convert(sources, options, ConvertControl{});

  const Store store(output);
  const VerifyReport report = verifyStore(store);
  ASSERT_TRUE(report.problems.empty()) << report.problems.front();
  std::vector<bool> seen(copies + others);
  for (std::uint32_t n = 0; n < store.hierarchy().nodes.size(); ++n) {
    const NodePoints points = readAll(store, n);
    EXPECT_LE(points.count(), SliceBuilder::kMostSlicePoints);
    for (std::size_t i = 0; i < points.count(); ++i) {
      std::uint32_t number;
      std::memcpy(&number, &points.attributes[4 * i], 4);
      ASSERT_LT(number, seen.size());
      ASSERT_FALSE(seen[number]);
      seen[number] = true;
      if (number < copies) {
        const glm::dvec3 p =
            store.info().grid.offset +
            store.info().grid.scale * glm::dvec3(points.grid[0][i], points.grid[1][i], points.grid[2][i]);
        ASSERT_LT(glm::length(p - glm::dvec3(50.0, 50.001, 50.002)), 1e-6);
      }
    }
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), static_cast<std::ptrdiff_t>(seen.size()));
}

/// One store for all tests: three places in its hierarchy are worth a look.
class Slices : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TempFolder;
    expectWhole(2'000'000, 60'000, std::uint64_t{4} << 30, (*folder_ / "a.strata").string());
  }
  static void TearDownTestSuite() { delete folder_; }
  static test::TempFolder* folder_;
  const Store store_{(*folder_ / "a.strata").string()};
};
test::TempFolder* Slices::folder_ = nullptr;

TEST_F(Slices, HoldWhatANodeCannot) {
  const std::vector<NodeRecord>& nodes = store_.hierarchy().nodes;
  std::size_t slices = 0;
  int levels = 0;
  for (const NodeRecord& node : nodes) {
    levels = std::max(levels, NodeKey{node.key}.level() + 1);
    if (node.sliced == 0) continue;
    ++slices;
    EXPECT_EQ(node.childMask, 1);
    EXPECT_EQ(nodes[node.firstChild].key, node.key);
    EXPECT_EQ(nodes[node.firstChild].pointCount, SliceBuilder::kMostSlicePoints);
  }
  EXPECT_GE(slices, 1u);
  EXPECT_EQ(store_.info().levels, levels);
}

TEST_F(Slices, AreSelectedOnlyWithWhatTheyContinue) {
  const HierarchyIndex index = indexHierarchy(store_.hierarchy());
  std::mt19937_64 random(3);
  for (int round = 0; round < 50; ++round) {
    View view;
    view.eye = glm::dvec3(50.0) + 60.0 * glm::dvec3(random() % 1000, random() % 1000, random() % 1000) / 1000.0;
    view.target = glm::dvec3(50.0, 50.001, 50.002);
    Selection selection;
    selectNodes({store_.hierarchy(), index.reach}, view, {}, selection);
    std::vector<bool> chosen(store_.hierarchy().nodes.size());
    for (const SelectedNode& selected : selection.nodes) {
      const std::uint32_t parent = index.parent[selected.node];
      EXPECT_TRUE(parent == HierarchyIndex::kNoParent || chosen[parent]);
      chosen[selected.node] = true;
    }
  }
}

TEST_F(Slices, AParentThatSaysOtherwiseIsRefused) {
  Hierarchy broken = store_.hierarchy();
  const auto sliced =
      std::find_if(broken.nodes.begin(), broken.nodes.end(), [](const NodeRecord& n) { return n.sliced == 1; });
  ASSERT_NE(sliced, broken.nodes.end());
  EXPECT_NO_THROW(checkHierarchy("hierarchy.bin", broken, store_.points().size()));
  sliced->sliced = 0;
  EXPECT_THROW(checkHierarchy("hierarchy.bin", broken, store_.points().size()), Error);
  sliced->sliced = 2;
  EXPECT_THROW(checkHierarchy("hierarchy.bin", broken, store_.points().size()), Error);
}

}  // namespace
}  // namespace strata
