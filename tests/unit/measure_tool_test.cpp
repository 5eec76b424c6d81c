#include "viewer/tools/measure_tool.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace strata {
namespace {

TEST(MeasureTool, ClicksGoNowhereUntilAKindIsChosen) {
  MeasureTool tool;
  tool.add({1, 2, 3});
  tool.undo();
  tool.finish();
  EXPECT_FALSE(tool.active());
  EXPECT_TRUE(tool.kept().empty());
}

TEST(MeasureTool, AKindWithAFixedNumberOfPointsIsKeptWithTheLastOneAndTheNextBegins) {
  MeasureTool tool;
  tool.begin(MeasureKind::angle);
  for (int i = 0; i < 7; ++i) tool.add(glm::dvec3(i));
  ASSERT_EQ(tool.kept().size(), 2u);
  EXPECT_EQ(tool.kept()[0].name, "angle 1");
  EXPECT_EQ(tool.kept()[1].name, "angle 2");
  ASSERT_TRUE(tool.current());
  EXPECT_EQ(tool.current()->points.size(), 1u);
}

TEST(MeasureTool, APolylineGrowsUntilItIsFinished) {
  MeasureTool tool;
  tool.begin(MeasureKind::polyline);
  for (int i = 0; i < 5; ++i) tool.add(glm::dvec3(i));
  tool.undo();
  EXPECT_TRUE(tool.kept().empty());
  tool.finish();
  EXPECT_FALSE(tool.active());
  ASSERT_EQ(tool.kept().size(), 1u);
  EXPECT_EQ(tool.kept()[0].points.size(), 4u);
}

TEST(MeasureTool, SaysWhatTheNextClickIsFor) {
  MeasureTool tool;
  EXPECT_EQ(tool.hint(), "");
  tool.begin(MeasureKind::polyline);
  EXPECT_EQ(tool.hint(), "polyline: click the first point");
  tool.add({});
  EXPECT_EQ(tool.hint(), "polyline: click the next point");
  tool.add(glm::dvec3(1.0));
  EXPECT_EQ(tool.hint(), "polyline: click the next point, or double click to end");
  tool.finish();
  EXPECT_EQ(tool.hint(), "");
}

TEST(MeasureTool, TheSamePointTwiceInARowCountsOnce) {
  MeasureTool tool;
  tool.begin(MeasureKind::polyline);
  for (const double x : {1.0, 1.0, 2.0, 2.0, 1.0}) tool.add(glm::dvec3(x));
  EXPECT_EQ(tool.current()->points.size(), 3u);
}

TEST(MeasureTool, AProfileIsKeptWithAWidthThatSuitsItsLength) {
  MeasureTool tool;
  for (const double length : {0.3, 40.0, 9000.0}) {
    tool.begin(MeasureKind::profile);
    tool.add({});
    tool.add({length, 0.0, 5.0});
    tool.finish();
    EXPECT_GT(tool.kept().back().width, 0.01 * length);
    EXPECT_LT(tool.kept().back().width, 0.06 * std::max(length, 5.0));
  }
}

TEST(MeasureTool, WhatIsNotWholeIsNotKept) {
  MeasureTool tool;
  tool.begin(MeasureKind::area);
  tool.add({});
  tool.add({1, 0, 0});
  tool.begin(MeasureKind::distance);
  tool.add({});
  tool.cancel();
  tool.finish();
  EXPECT_TRUE(tool.kept().empty());
}

TEST(MeasureTool, NamesAreNotUsedTwice) {
  MeasureTool tool;
  tool.begin(MeasureKind::point);
  for (int i = 0; i < 3; ++i) tool.add(glm::dvec3(i));
  tool.kept().erase(tool.kept().begin());
  tool.finish();
  tool.begin(MeasureKind::point);
  EXPECT_EQ(tool.current()->name, "point 1");
  tool.add({});
  EXPECT_EQ(tool.current()->name, "point 4");
}

}  // namespace
}  // namespace strata
