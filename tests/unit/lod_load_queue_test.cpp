#include "lod/load_queue.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace strata {
namespace {

using namespace std::chrono_literals;

void fill(LoadQueue& queue, std::vector<LoadRequest> requests) { queue.replace(requests); }

LoadRequest request(std::uint32_t node, float priority) { return {node, Precision::full30, priority}; }

TEST(LoadQueue, GivesTheMostUrgentFirstAndParentsOnTies) {
  LoadQueue queue;
  fill(queue, {request(5, 1.0f), request(7, 3.0f), request(6, 2.0f), request(2, 2.0f)});
  EXPECT_EQ(queue.size(), 4u);
  for (const std::uint32_t expected : {7u, 2u, 6u, 5u}) EXPECT_EQ(queue.pop({})->node, expected);
  EXPECT_EQ(queue.size(), 0u);
  EXPECT_EQ(queue.inFlight(), 4u);
}

TEST(LoadQueue, ForgetsWhatANewListDoesNotNameAndKeepsTheMemory) {
  LoadQueue queue;
  fill(queue, {request(1, 1.0f), request(2, 2.0f)});
  std::vector<LoadRequest> next{request(3, 1.0f)};
  queue.replace(next);
  EXPECT_TRUE(next.empty());
  EXPECT_GE(next.capacity(), 2u);
  EXPECT_EQ(queue.pop({})->node, 3u);
}

TEST(LoadQueue, DoesNotHandOutANodeThatIsInFlight) {
  LoadQueue queue;
  fill(queue, {request(1, 9.0f), request(2, 1.0f)});
  EXPECT_EQ(queue.pop({})->node, 1u);
  fill(queue, {request(1, 9.0f), request(2, 1.0f)});
  EXPECT_EQ(queue.pop({})->node, 2u);
}

TEST(LoadQueue, KeepsARequestForANodeThatIsGivenUpUnread) {
  LoadQueue queue;
  fill(queue, {request(1, 9.0f)});
  EXPECT_EQ(queue.pop({})->node, 1u);
  fill(queue, {request(1, 9.0f)});
  queue.release(1);
  EXPECT_EQ(queue.pop({})->node, 1u);
}

TEST(LoadQueue, DropsARequestForANodeThatHasJustBeenLoaded) {
  LoadQueue queue;
  fill(queue, {request(1, 9.0f)});
  EXPECT_EQ(queue.pop({})->node, 1u);
  fill(queue, {request(1, 9.0f), request(2, 1.0f)});
  queue.finish(1);
  EXPECT_EQ(queue.inFlight(), 0u);
  EXPECT_EQ(queue.pop({})->node, 2u);
}

TEST(LoadQueue, WakesAWaitingLoaderForANewListAndForAReleasedNode) {
  LoadQueue queue;
  std::vector<std::uint32_t> taken;
  {
    std::jthread loader([&](std::stop_token stop) {
      for (int i = 0; i < 2; ++i)
        if (const auto got = queue.pop(stop)) taken.push_back(got->node);
    });
    fill(queue, {request(4, 1.0f)});
    while (queue.inFlight() == 0) std::this_thread::yield();
    fill(queue, {request(4, 1.0f)});
    queue.release(4);
    while (queue.size() > 0) std::this_thread::yield();
  }
  EXPECT_EQ(taken, (std::vector<std::uint32_t>{4, 4}));
}

LoadRequest placed(std::uint32_t node, float priority, std::uint64_t offset, std::uint32_t bytes = 100) {
  LoadRequest r = request(node, priority);
  r.offset = offset;
  r.bytes = bytes;
  return r;
}

std::vector<std::uint32_t> popTogether(LoadQueue& queue, const ReadLimits& limits) {
  std::vector<LoadRequest> out;
  queue.pop({}, limits, out);
  std::vector<std::uint32_t> nodes;
  for (const LoadRequest& r : out) nodes.push_back(r.node);
  return nodes;
}

TEST(LoadQueue, GivesNeighboursInTheFileTogetherByOffset) {
  LoadQueue queue;
  fill(queue, {placed(1, 9.0f, 200), placed(2, 8.0f, 100), placed(3, 7.0f, 310), placed(4, 6.0f, 500)});
  EXPECT_EQ(popTogether(queue, {.nodes = 8, .gap = 10}), (std::vector<std::uint32_t>{2, 1, 3}));
  EXPECT_EQ(popTogether(queue, {.nodes = 8, .gap = 10}), (std::vector<std::uint32_t>{4}));
}

TEST(LoadQueue, JoinsNeitherTheLessUrgentNorTheFarNorTooMany) {
  const std::vector<LoadRequest> requests = {placed(1, 9.0f, 0), placed(2, 8.0f, 100), placed(3, 7.0f, 200)};
  for (const auto& [limits, expected] :
       std::vector<std::pair<ReadLimits, std::size_t>>{{{.nodes = 1}, 1},
                                                       {{.nodes = 2}, 2},
                                                       {{.nodes = 8}, 3},
                                                       {{.nodes = 8, .bytes = 200}, 2},
                                                       {{.nodes = 8, .leastPriority = 0.85f}, 2},
                                                       {{.nodes = 8, .bytes = 0}, 1}}) {
    LoadQueue queue;
    fill(queue, requests);
    EXPECT_EQ(popTogether(queue, limits).size(), expected);
  }
  LoadQueue queue;
  std::vector<LoadRequest> alone = requests;
  alone[1].alone = true;
  fill(queue, alone);
  EXPECT_EQ(popTogether(queue, {.nodes = 8, .gap = 0}), (std::vector<std::uint32_t>{1}));
}

TEST(LoadQueue, GivesWhatIsAheadAfterEverythingElse) {
  LoadQueue queue;
  LoadRequest ahead = request(1, 1e9f);
  ahead.ahead = true;
  fill(queue, {ahead, request(2, 1.0f)});
  EXPECT_EQ(queue.pop({})->node, 2u);
  EXPECT_EQ(queue.pop({})->node, 1u);
}

TEST(LoadQueue, StopsAllThatWaitAndAllThatComeLater) {
  LoadQueue queue;
  std::jthread waiting([&] { EXPECT_FALSE(queue.pop({}).has_value()); });
  queue.stop();
  waiting.join();
  fill(queue, {request(1, 1.0f)});
  EXPECT_FALSE(queue.pop({}).has_value());
}

TEST(LoadQueue, StopsAWaitingLoaderByItsToken) {
  LoadQueue queue;
  const auto start = std::chrono::steady_clock::now();
  {
    std::jthread waiting([&](std::stop_token stop) { EXPECT_FALSE(queue.pop(stop).has_value()); });
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 10s) << "or rather: it ends";
}

}  // namespace
}  // namespace strata
