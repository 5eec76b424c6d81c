#include "core/node_key.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "core/error.h"

namespace strata {
namespace {

NodeKey randomKey(std::mt19937& random, int level) {
  std::uniform_int_distribution<int> octant(0, 7);
  NodeKey key;
  for (int l = 0; l < level; ++l) key = key.child(octant(random));
  return key;
}

TEST(NodeKey, TheRootIsOneAndReadsR) {
  EXPECT_EQ(NodeKey().code, 1u);
  EXPECT_TRUE(NodeKey().isRoot());
  EXPECT_EQ(NodeKey().level(), 0);
  EXPECT_EQ(NodeKey().text(), "r");
  EXPECT_EQ(NodeKey::parse("r"), NodeKey());
}

TEST(NodeKey, TheTextNamesTheOctantsFromTheRootDown) {
  EXPECT_EQ(NodeKey().child(0).child(4).child(2).child(7).text(), "r0427");
  EXPECT_EQ(NodeKey::parse("r0427").octant(), 7);
}

TEST(NodeKey, ParsingTheTextGivesTheKeyBackAtEveryLevel) {
  std::mt19937 random(1);
  for (int level = 0; level <= NodeKey::kDeepestLevel; ++level)
    for (int i = 0; i < 50; ++i) {
      const NodeKey key = randomKey(random, level);
      EXPECT_EQ(key.level(), level);
      EXPECT_EQ(NodeKey::parse(key.text()), key);
    }
}

TEST(NodeKey, TextThatIsNoKeyIsRefused) {
  const std::string tooDeep = "r" + std::string(NodeKey::kDeepestLevel + 1, '0');
  for (const std::string& text : {std::string(), std::string("0427"), std::string("r8"), std::string("r04-7"),
                                  std::string("R0"), std::string("r0 "), tooDeep})
    EXPECT_THROW(NodeKey::parse(text), Error) << text;
}

TEST(NodeKey, AParentIsAnAncestorAndAChildIsNot) {
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const NodeKey key = randomKey(random, 1 + i % NodeKey::kDeepestLevel);
    EXPECT_TRUE(key.isAncestorOf(key));
    EXPECT_FALSE(key.isAncestorOf(key.parent()));
    for (NodeKey above = key.parent();; above = above.parent()) {
      EXPECT_TRUE(above.isAncestorOf(key));
      if (above.isRoot()) break;
    }
    const NodeKey sibling = key.parent().child((key.octant() + 1) % 8);
    EXPECT_FALSE(sibling.isAncestorOf(key));
  }
}

TEST(NodeKey, TheEightCubesOfTheChildrenTileTheirParent) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Box root{{-100.0, 50.0, 0.0}, {28.0, 178.0, 128.0}};
  for (int i = 0; i < 200; ++i) {
    const NodeKey key = randomKey(random, i % 12);
    const Box cube = nodeCube(key, root);
    Box together;
    double volume = 0.0;
    for (int octant = 0; octant < 8; ++octant) {
      const Box child = nodeCube(key.child(octant), root);
      EXPECT_EQ(child.min.x >= cube.centre().x, (octant & 4) != 0);
      EXPECT_EQ(child.min.y >= cube.centre().y, (octant & 2) != 0);
      EXPECT_EQ(child.min.z >= cube.centre().z, (octant & 1) != 0);
      together.add(child);
      volume += child.size().x * child.size().y * child.size().z;
    }
    EXPECT_EQ(together.min, cube.min);
    EXPECT_EQ(together.max, cube.max);
    EXPECT_DOUBLE_EQ(volume, cube.size().x * cube.size().y * cube.size().z);

    const glm::dvec3 inside = cube.min + cube.size() * glm::dvec3(unit(random), unit(random), unit(random));
    int holding = 0;
    for (int octant = 0; octant < 8; ++octant) holding += nodeCube(key.child(octant), root).contains(inside) ? 1 : 0;
    EXPECT_GE(holding, 1);
  }
}

}  // namespace
}  // namespace strata
