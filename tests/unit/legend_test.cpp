#include "viewer/session/legend.h"

#include <gtest/gtest.h>

#include "render/picture/colour_map.h"

namespace strata {
namespace {

TEST(Legend, EveryModeButTheOwnColoursHasOne) {
  std::bitset<256> classes;
  classes.set(2).set(6);
  for (int mode = 0; mode <= static_cast<int>(ColourMode::overdraw); ++mode) {
    DrawOptions options;
    options.colour = static_cast<ColourMode>(mode);
    const Legend legend = legendOf(options, classes, 5);
    EXPECT_EQ(legend.entries.empty() && legend.colours.empty(), options.colour == ColourMode::rgb) << mode;
    EXPECT_TRUE(legend.entries.empty() || legend.colours.empty()) << mode;
  }
}

TEST(Legend, NamesTheClassesThatArePresentInTheirColours) {
  std::bitset<256> classes;
  classes.set(6);
  DrawOptions options;
  options.colour = ColourMode::classification;
  const Legend legend = legendOf(options, classes, 5);
  ASSERT_EQ(legend.entries.size(), 1u);
  EXPECT_EQ(legend.entries[0].label, "6 building");
  EXPECT_EQ(legend.entries[0].colour, classificationColour(6));
}

TEST(Legend, AScaleGoesFromTheColourOfItsLowEndToThatOfItsHighEnd) {
  DrawOptions options;
  options.colour = ColourMode::elevation;
  options.elevationRange = {12.5, 80.0};
  const Legend legend = legendOf(options, {}, 5);
  EXPECT_EQ(legend.low, "12.50 m");
  EXPECT_EQ(legend.high, "80.00 m");
  EXPECT_EQ(legend.colours.front(), elevationColour(0.0));
  EXPECT_EQ(legend.colours.back(), elevationColour(1.0));
}

}  // namespace
}  // namespace strata
