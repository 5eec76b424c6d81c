#include "viewer/session/class_census.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

NodeData node(std::uint64_t key, std::vector<std::uint8_t> classes) {
  NodeData data;
  data.key.code = key;
  data.position[0].resize(classes.empty() ? 3 : classes.size());
  data.classification = std::move(classes);
  return data;
}

TEST(ClassCensus, GathersTheClassesOfAllNodesItMeets) {
  ClassCensus census;
  EXPECT_TRUE(census.add(0, node(1, {2, 2, 6})));
  EXPECT_FALSE(census.add(0, node(8, {6, 2})));
  EXPECT_TRUE(census.add(1, node(1, {255, 2, 2})));
  EXPECT_FALSE(census.add(0, node(9, {})));
  EXPECT_EQ(census.present().count(), 3u);
  EXPECT_TRUE(census.present()[2] && census.present()[6] && census.present()[255]);
}

TEST(ClassCensus, LooksThroughANodeOnce) {
  ClassCensus census;
  census.add(0, node(1, {2, 2, 2}));
  EXPECT_FALSE(census.add(0, node(1, {9, 9, 9})));
  EXPECT_FALSE(census.present()[9]);
}

TEST(ClassCensus, EveryClassHasANameOfItsOwn) {
  std::set<std::string> names;
  for (int c = 0; c < 256; ++c) names.insert(className(static_cast<std::uint8_t>(c)));
  EXPECT_EQ(names.size(), 256u);
  EXPECT_EQ(className(2), "ground");
  EXPECT_EQ(className(23), "reserved 23");
  EXPECT_EQ(className(64), "own 64");
}

}  // namespace
}  // namespace strata
