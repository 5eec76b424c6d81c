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
