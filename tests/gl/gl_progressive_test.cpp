// Progressive drawing, compared with a plain rasterizer, which draws every point in every frame.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <random>

#include "core/image.h"
#include "render/create_rasterizer.h"
#include "render/progressive/progressive_rasterizer.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/paths.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

using test::ContextKind;

const glm::dvec3 kUtm(456789.123, 5412345.678, 312.5);
const glm::dvec3 kDirection(1.0, 0.83, -0.71);

class Progressive : public testing::Test {
 protected:
  void create(const ProgressiveOptions& options) {
    std::string reason;
    auto context = test::tryContext(ContextKind::egl, reason);
    if (context == nullptr) GTEST_SKIP() << reason;
    progressive_ = createProgressiveRasterizer(std::move(context), options, 2);
    plain_ = createRasterizer(Backend::compute32, {}, createEglContext());
  }

  /// Draws until the picture does not change any more. Returns the number of frames.
  int converge(const RenderList& list, const View& view, const DrawOptions& options = {}) {
    for (int frames = 1; frames < 2000; ++frames)
      if (isFinished(progressive_->draw(list, view, options, picture_))) return frames;
    ADD_FAILURE() << "no end";
    return 0;
  }

  void expectPlainPicture(const RenderList& list, const View& view, const DrawOptions& options = {}) {
    plain_->draw(list, view, options, expected_);
    EXPECT_EQ(picture_.width, expected_.width);
    EXPECT_EQ(differentIds(), 0u);
    EXPECT_TRUE(picture_.depth == expected_.depth);
    EXPECT_TRUE(picture_.colour == expected_.colour);
  }

  std::size_t differentIds() const {
    std::size_t different = 0;
    for (std::size_t i = 0; i < expected_.pointId.size(); ++i) different += picture_.pointId[i] != expected_.pointId[i];
    return different;
  }

  static std::size_t covered(const Picture& picture) {
    return picture.pointId.size() -
           static_cast<std::size_t>(std::count(picture.pointId.begin(), picture.pointId.end(), Picture::kNoPoint));
  }

  std::unique_ptr<ProgressiveRasterizer> progressive_;
  std::unique_ptr<Rasterizer> plain_;
  Picture picture_, expected_;
};

#define STRATA_CREATE(...) \
  create(__VA_ARGS__);     \
  if (progressive_ == nullptr) return

RenderList prefixes(RenderList list, std::uint32_t divisor) {
  list.pointCount = 0;
  for (RenderItem& item : list.items) list.pointCount += item.pointCount /= divisor;
  return list;
}

TEST_F(Progressive, OfAStillCameraBecomesExactlyThePlainPicture) {
  STRATA_CREATE({20'000, 30'000, 300'000});
  const RenderList list = test::makeTown(kUtm, 200.0, 150'000, 1);
  for (const View& view : test::viewsAround(test::boundsOf(list), 9, 400, 300)) {
    converge(list, view);
    expectPlainPicture(list, view);
  }
}

TEST_F(Progressive, DrawsAPartOfALargerPicture) {
  STRATA_CREATE({20'000, 30'000, 100'000});
  const RenderList list = test::makeTown(kUtm, 200.0, 60'000, 16);
  const View view = tileOfPicture(viewOfBox(test::boundsOf(list), kDirection, 600, 500, 1.0), 130, 90, 320, 251);
  converge(list, view);
  expectPlainPicture(list, view);
  EXPECT_GT(covered(picture_), 10'000u);
}

TEST_F(Progressive, ConvergesWithinOneTurnOnceAllIsInThePool) {
  STRATA_CREATE({30'000, 1'000'000, 300'001});
  const RenderList list = test::makeTown(kUtm, 200.0, 150'000, 2);
  const std::vector<View> views = test::viewsAround(test::boundsOf(list), 4, 400, 300);
  const int frames = converge(list, views[0]);
  EXPECT_EQ(frames, static_cast<int>((progressive_->progress().turnPlaces + 29'999) / 30'000));
  EXPECT_LE(frames, 8) << "of 11, for a pool of which the view takes two thirds";
  const DrawStats more = progressive_->draw(list, views[0], {}, picture_);
  EXPECT_EQ(more.pointsDrawn, covered(picture_)) << "a finished picture needs no more of the pool";
  EXPECT_LE(converge(list, views[1]), frames + 1);
  expectPlainPicture(list, views[1]);
}

TEST_F(Progressive, DrawsAnyPoolSize) {
  const RenderList list = test::makeTown(kUtm, 200.0, 20'000, 3);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 200, 150, 1.0);
  for (const std::uint64_t size : {26'001u, 32'768u, 50'000u, 65'537u}) {
    STRATA_CREATE({7'001, 9'000, size, 17});
    converge(list, view);
    expectPlainPicture(list, view);
  }
}

TEST_F(Progressive, KeepsToPrefixesClipClassesAndColours) {
  STRATA_CREATE({20'000, 30'000, 300'000});
  const RenderList all = test::makeTown(kUtm, 200.0, 100'000, 4);
  const View view = viewOfBox(test::boundsOf(all), kDirection, 400, 300, 1.0);
  for (const std::uint32_t divisor : {1u, 7u, 2u}) {
    const RenderList list = prefixes(all, divisor);
    DrawOptions options;
    converge(list, view, options);
    expectPlainPicture(list, view, options);
    options.clip.boxes = {{kUtm - 40.0, kUtm + 40.0}};
    options.clip.planes = {{1.0, 0.0, 0.0, -kUtm.x}};
    converge(list, view, options);
    expectPlainPicture(list, view, options);
    EXPECT_GT(covered(picture_), 100u);
    options.clip = {};
    options.classes.reset();
    for (const std::size_t kind : {0u, 3u, 6u, 12u, 17u}) options.classes.set(kind);
    options.colour = ColourMode::classification;
    options.pointSize = 2;
    options.edl = true;
    converge(list, view, options);
    expectPlainPicture(list, view, options);
  }
}

/// Each frame's picture of a moving camera: a point that all frames of a turn had in front is shown, and what the frame
/// before showed and what is drawn in this frame is shown at once. So what is late is late by a turn at most, and of
/// what came into view k frames ago at most the places that k frames have not gone over.
/// After half a turn. STRATA_ACCEPT_GOLDEN=1 replaces the picture in the repository; look at it before you commit.
TEST_F(Progressive, ShowsAnEvenHalfAfterHalfATurn) {
  STRATA_CREATE({100'000, 1'000'000, 200'000});
  const RenderList list = test::makeTown(kUtm, 100.0, 150'000, 1, 4);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 320, 240, 1.0);
  progressive_->draw(list, view, {}, picture_);
  const Image half{picture_.width, picture_.height, picture_.colour};
  const std::string path = (test::sourceFolder() / "tests/golden/town_progressive_half.png").string();
  if (std::getenv("STRATA_ACCEPT_GOLDEN") != nullptr) writePng(path, half);
  const Image golden = readPng(path);
  ASSERT_EQ(half.pixels.size(), golden.pixels.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < half.pixels.size(); ++i) different += half.pixels[i] != golden.pixels[i];
  EXPECT_LE(different, half.pixels.size() / 500) << "points on the edge of their pixel fall to either side";
  converge(list, view);
  expectPlainPicture(list, view);
}

TEST_F(Progressive, OfAMovingCameraIsLateByNoMoreThanTheFramesShares) {
  constexpr int kTurn = 8;
  STRATA_CREATE({25'000, 1'000'000, 25'000 * kTurn});
  const RenderList list = test::makeTown(kUtm, 200.0, 150'000, 5);
  View view = viewOfBox(test::boundsOf(list), kDirection, 300, 200, 1.0);
  converge(list, view);
  std::map<std::uint32_t, int> age;  // frames in a row that a point has been in front
  std::vector<std::uint32_t> seen(kTurn + 1), late(kTurn + 1);
  std::map<std::uint32_t, bool> shownBefore;
  for (int step = 0; step < 40; ++step) {
    view.eye += glm::dvec3(-1.3, 0.9, -0.2);
    view.target += glm::dvec3(-0.4, 1.1, 0.1);
    progressive_->draw(list, view, {}, picture_);
    plain_->draw(list, view, {}, expected_);
    std::map<std::uint32_t, int> now;
    std::map<std::uint32_t, bool> shownNow;
    for (std::size_t i = 0; i < expected_.pointId.size(); ++i) {
      const std::uint32_t front = expected_.pointId[i];
      if (front == Picture::kNoPoint) {
        EXPECT_EQ(picture_.pointId[i], Picture::kNoPoint);
        continue;
      }
      const bool shown = picture_.pointId[i] == front;
      shownNow[front] = shown;
      now[front] = std::min(step == 0 ? 1 : age[front] + 1, kTurn);
      if (shownBefore[front]) {
        ASSERT_TRUE(shown) << "a point that is still in front was lost";
      }
      ++seen[static_cast<std::size_t>(now[front])];
      late[static_cast<std::size_t>(now[front])] += !shown;
      ASSERT_GE(expected_.depth[i], 0.0f);
      ASSERT_GE(picture_.depth[i], expected_.depth[i]) << "nothing stands before the front";
    }
    age = std::move(now);
    shownBefore = std::move(shownNow);
  }
  EXPECT_EQ(late[kTurn], 0u) << "in front for a turn and not shown";
  for (std::size_t k = 1; k < kTurn; ++k) {
    ASSERT_GT(seen[k], 1000u);
    EXPECT_LE(static_cast<double>(late[k]) / seen[k], 1.0 - static_cast<double>(k) / kTurn + 0.03) << k << " frames";
  }
  EXPECT_GT(late[1], 100u) << "the camera moves too slowly to see anything";
}

TEST_F(Progressive, ShowsNothingOfAFreedNodeAndClearsItWithinATurn) {
  STRATA_CREATE({20'000, 1'000'000, 100'000});
  const RenderList first = test::makeTown(kUtm, 200.0, 60'000, 6), second = test::makeTown(kUtm, 200.0, 60'000, 7);
  const View view = viewOfBox(test::boundsOf(first), kDirection, 300, 200, 1.0);
  converge(first, view);
  const std::size_t before = covered(picture_);
  progressive_->draw(second, view, {}, picture_);  // 75 000 points each: the first has to go
  EXPECT_GT(progressive_->progress().ghostPieces, 0u);
  EXPECT_LT(covered(picture_), before) << "the ids of what is gone mean other points now";
  for (int i = 0; i < 5; ++i) progressive_->draw(second, view, {}, picture_);
  EXPECT_EQ(progressive_->progress().ghostPieces, 0u) << "after a turn";
  converge(second, view);
  expectPlainPicture(second, view);
}

TEST_F(Progressive, NeverFreesWhatTheViewShows) {
  STRATA_CREATE({20'000, 1'000'000, 40'000});
  const RenderList list = test::makeTown(kUtm, 200.0, 60'000, 8, 4);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 300, 200, 1.0);
  DrawStats stats = progressive_->draw(list, view, {}, picture_);
  EXPECT_GT(stats.nodesNotUploaded, 0u);
  EXPECT_GT(stats.bytesUploaded, 0u);
  stats = progressive_->draw(list, view, {}, picture_);
  EXPECT_EQ(stats.bytesUploaded, 0u) << "nothing takes the place of what is shown";
  EXPECT_EQ(progressive_->progress().ghostPieces, 0u);
}

/// At first one half of the nodes has the pool to itself, then all have to share it.
TEST_F(Progressive, GivesEveryNodeAPartOfAPoolThatIsTooSmall) {
  STRATA_CREATE({20'000, 5'000, 60'000});
  const RenderList all = test::makeTown(kUtm, 200.0, 150'000, 16, 3);
  const View view = viewOfBox(test::boundsOf(all), kDirection, 300, 200, 1.0);
  const std::vector<RenderItem> half(all.items.begin(), all.items.begin() + all.items.size() / 2);
  RenderList list;
  for (const RenderItem& item : half) {
    list.items.push_back(item);
    list.pointCount += item.pointCount;
  }
  ASSERT_GT(list.pointCount, 60'000u);
  converge(list, view);
  converge(all, view);
  plain_->draw(all, view, {}, expected_);
  std::vector<std::uint32_t> ends;
  for (const RenderItem& item : all.items) ends.push_back((ends.empty() ? 0 : ends.back()) + item.pointCount);
  std::vector<std::size_t> shown(ends.size()), wanted(ends.size());
  const auto count = [&ends](const Picture& picture, std::vector<std::size_t>& pixels) {
    for (const std::uint32_t id : picture.pointId)
      if (id != Picture::kNoPoint)
        ++pixels[static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), id) - ends.begin())];
  };
  count(picture_, shown);
  count(expected_, wanted);
  for (std::size_t item = 0; item < ends.size(); ++item) EXPECT_GE(shown[item], wanted[item] / 8) << "node " << item;
  EXPECT_GT(covered(picture_), covered(expected_) / 4);
  const DrawStats more = progressive_->draw(all, view, {}, picture_);
  EXPECT_EQ(more.bytesUploaded, 0u) << "and then it rests";
  EXPECT_EQ(progressive_->progress().ghostPieces, 0u);
}

/// The scenes lie far apart, and three of them are in view at a time.
TEST_F(Progressive, MakesRoomForWhatComesIntoViewAndKeepsWhatJustLeftIt) {
  STRATA_CREATE({50'000, 20'000, 100'000});
  std::vector<std::shared_ptr<const NodeData>> nodes;
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int place = 0; place < 12; ++place) {
    std::vector<glm::dvec3> points(20'000);
    for (glm::dvec3& p : points) p = kUtm + glm::dvec3(unit(random), unit(random), unit(random));
    nodes.push_back(test::makeNode(NodeKey{}.child(place % 8), points, 0.001));
  }
  const View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 200, 150, 1.0);
  const auto uploadedAt = [&](int place) {
    const RenderList list = test::makeList({nodes.begin() + place, nodes.begin() + place + 3});
    std::uint64_t bytes = 0;
    for (DrawStats stats;;) {
      stats = progressive_->draw(list, view, {}, picture_);
      EXPECT_LE(stats.bytesUploaded, 20'000u * 16);
      bytes += stats.bytesUploaded;
      if (isFinished(stats)) break;
    }
    expectPlainPicture(list, view);
    return bytes / 16;
  };
  EXPECT_EQ(uploadedAt(0), 60'000u);
  for (int place = 1; place <= 9; ++place) EXPECT_EQ(uploadedAt(place), 20'000u) << "the one that came into view";
  EXPECT_LE(uploadedAt(8), 5'000u) << "left the view last; a quarter of what is shown is kept";
  EXPECT_EQ(uploadedAt(0), 60'000u) << "left it long ago";
}

TEST_F(Progressive, OfASmallViewIsFinishedSoonInALargePool) {
  STRATA_CREATE({20'000, 1'000'000, 2'000'000});
  const RenderList list = test::makeTown(kUtm, 200.0, 60'000, 18);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 300, 200, 1.0);
  EXPECT_LE(converge(list, view), 7);
  EXPECT_LE(progressive_->progress().turnPlaces, 125'000u) << "two of 32 parts of the pool";
  expectPlainPicture(list, view);
}

TEST_F(Progressive, UploadsNoMoreThanItMayInAFrame) {
  STRATA_CREATE({20'000, 10'000, 200'000});
  const RenderList list = test::makeTown(kUtm, 200.0, 100'000, 9);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 300, 200, 1.0);
  for (bool all = false; !all;) {
    const DrawStats stats = progressive_->draw(list, view, {}, picture_);
    all = stats.nodesNotUploaded == 0;
    EXPECT_LE(stats.bytesUploaded, 10'000u * 16);
    EXPECT_TRUE(all || stats.bytesUploaded > 0);
  }
  converge(list, view);
  expectPlainPicture(list, view);
}

/// Nodes come, go and come back in a pool that holds only some of them. Slots and places are used many times over.
TEST_F(Progressive, StaysRightWhileNodesComeAndGo) {
  STRATA_CREATE({9'000, 12'000, 60'000});
  const RenderList town = test::makeTown(kUtm, 200.0, 100'000, 10, 5);
  std::mt19937 random(10);
  View view = viewOfBox(test::boundsOf(town), kDirection, 250, 180, 1.0);
  for (int round = 0; round < 25; ++round) {
    std::vector<std::shared_ptr<const NodeData>> nodes;
    std::uint32_t points = 0;
    for (const RenderItem& item : town.items)
      if (random() % 3 == 0 && points + item.pointCount < 45'000) {
        nodes.push_back(item.node);
        points += item.pointCount;
      }
    std::shuffle(nodes.begin(), nodes.end(), random);
    RenderList list = prefixes(test::makeList(nodes), 1 + static_cast<std::uint32_t>(random()) % 3);
    view.eye += glm::dvec3(1.0, -2.0, 0.3);
    for (int frames = static_cast<int>(random() % 4); frames > 0; --frames)
      progressive_->draw(list, view, {}, picture_);
    if (round % 3 != 0) continue;
    converge(list, view);
    expectPlainPicture(list, view);
  }
}

TEST_F(Progressive, DrawsNodesThatGetMorePlanesWithoutLosingTheirPoints) {
  STRATA_CREATE({10'000, 1'000'000, 100'000});
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points(40'000);
  for (glm::dvec3& p : points) p = kUtm + glm::dvec3(unit(random), unit(random), 0.1 * unit(random));
  const auto coarse = test::makeNode({}, points, 1e-6, 10'240, 1), fine = test::makeNode({}, points, 1e-6, 10'240, 2);
  View view;
  view.width = 500;
  view.height = 400;
  view.eye = kUtm + glm::dvec3(0.5, 0.4, 0.35);
  view.target = kUtm + glm::dvec3(0.5, 0.5, 0.0);
  converge(test::makeList({coarse}), view);
  expectPlainPicture(test::makeList({coarse}), view);
  const std::size_t before = covered(picture_);
  const DrawStats stats = progressive_->draw(test::makeList({fine}), view, {}, picture_);
  EXPECT_GT(stats.bytesUploaded, 0u) << "the view wants more bits";
  EXPECT_GT(covered(picture_), before * 95 / 100) << "what was shown stays";
  EXPECT_EQ(progressive_->progress().ghostPieces, 0u) << "in the places it had";
  converge(test::makeList({fine}), view);
  expectPlainPicture(test::makeList({fine}), view);
}

TEST_F(Progressive, TakesANodeThatCameBackForTheOneItHas) {
  STRATA_CREATE({20'000, 1'000'000, 100'000});
  RenderList list = test::makeTown(kUtm, 200.0, 60'000, 12);
  const View view = viewOfBox(test::boundsOf(list), kDirection, 300, 200, 1.0);
  converge(list, view);
  list = test::makeTown(kUtm, 200.0, 60'000, 12);  // the same points, read again
  const DrawStats stats = progressive_->draw(list, view, {}, picture_);
  EXPECT_EQ(stats.bytesUploaded, 0u);
  expectPlainPicture(list, view);
}

TEST_F(Progressive, NeverDrawsAFreedNodeInPlaceOfAnother) {
  STRATA_CREATE({20'000, 1'000'000, 50'000});
  const View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 256, 256, 1.0);
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 20; ++round) {  // the allocator likes to give the same address again
    std::vector<glm::dvec3> points(20'000);
    for (glm::dvec3& p : points) p = kUtm + glm::dvec3(unit(random), unit(random), unit(random));
    auto* copy = new NodeData(*test::makeNode({}, points, 0.001));
    const RenderList list = test::makeList({std::shared_ptr<const NodeData>(copy)});
    converge(list, view);
    expectPlainPicture(list, view);
  }
}

/// The eye travels thousands of kilometres between scenes with fine steps. Nothing is cleared, and nothing jumps.
TEST_F(Progressive, ShowsNoShiftOfItsOriginAtAnyDistance) {
  STRATA_CREATE({30'000, 1'000'000, 300'000});
  std::vector<std::shared_ptr<const NodeData>> nodes;
  std::mt19937 random(14);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int place = 0; place < 5; ++place) {
    std::vector<glm::dvec3> points(30'000);
    const glm::dvec3 far = static_cast<double>(place) * glm::dvec3(9e5, -4e5, 1e3);
    for (glm::dvec3& p : points) p = kUtm + far + 20.0 * glm::dvec3(unit(random), unit(random), 0.2 * unit(random));
    nodes.push_back(test::makeNode(NodeKey{}.child(place), points, 0.001));
  }
  const RenderList list = test::makeList(nodes);
  std::uint64_t written = 0;
  for (int round = 0; round < 2; ++round)
    for (int place = 0; place < 5; ++place) {
      const glm::dvec3 centre = kUtm + static_cast<double>(place) * glm::dvec3(9e5, -4e5, 1e3) + 10.0;
      View view = viewOfBox({centre - 10.0, centre + 10.0}, kDirection, 300, 200, 1.0);
      for (int step = 0; step < 3; ++step, view.eye += glm::dvec3(0.37, 0.21, -0.05)) {
        converge(list, view);
        expectPlainPicture(list, view);
        EXPECT_GT(covered(picture_), 1000u);
      }
      written += progressive_->progress().written;
    }
  EXPECT_EQ(written, 0u);
  EXPECT_EQ(progressive_->progress().ghostPieces, 0u);
}

TEST_F(Progressive, DrawsNothingOfNothingAndFollowsTheWindow) {
  STRATA_CREATE({20'000, 1'000'000, 100'000});
  View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 301, 201, 1.0);
  progressive_->draw({}, view, {}, picture_);
  EXPECT_EQ(covered(picture_), 0u);
  view.width = 0;
  EXPECT_TRUE(isFinished(progressive_->draw({}, view, {}, picture_)));
  EXPECT_TRUE(picture_.colour.empty());
  const RenderList list = test::makeTown(kUtm, 200.0, 30'000, 15);
  for (const int width : {400, 123, 1, 401}) {
    view = viewOfBox(test::boundsOf(list), kDirection, width, 200, 1.0);
    converge(list, view);
    expectPlainPicture(list, view);
  }
}

}  // namespace
}  // namespace strata
