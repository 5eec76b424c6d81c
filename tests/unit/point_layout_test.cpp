#include "core/point_layout.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace strata {
namespace {

constexpr ScalarType kTypes[] = {ScalarType::u8,  ScalarType::i8,  ScalarType::u16, ScalarType::i16, ScalarType::u32,
                                 ScalarType::i32, ScalarType::u64, ScalarType::i64, ScalarType::f32, ScalarType::f64};

Attribute attributeOf(std::string_view name, ScalarType type, std::uint16_t components = 1) {
  Attribute made;
  made.name = name;
  made.type = type;
  made.components = components;
  return made;
}

TEST(PointLayout, AnEmptyLayoutHasNoBytes) {
  const PointLayout layout;
  EXPECT_EQ(layout.stride(), 0u);
  EXPECT_TRUE(layout.attributes().empty());
  EXPECT_EQ(layout.find(attribute::kRgb), -1);
}

TEST(PointLayout, AttributesStandBehindEachOtherWithoutPadding) {
  const PointLayout layout(
      {attributeOf(attribute::kClassification, ScalarType::u8), attributeOf(attribute::kRgb, ScalarType::u16, 3),
       attributeOf(attribute::kGpsTime, ScalarType::f64), attributeOf(attribute::kNormal, ScalarType::f32, 3)});
  EXPECT_EQ(layout.offset(0), 0u);
  EXPECT_EQ(layout.offset(1), 1u);
  EXPECT_EQ(layout.offset(2), 7u);
  EXPECT_EQ(layout.offset(3), 15u);
  EXPECT_EQ(layout.stride(), 27u);
}

TEST(PointLayout, AnAttributeIsFoundByItsWholeName) {
  const PointLayout layout(
      {attributeOf(attribute::kScanAngle, ScalarType::i16), attributeOf(attribute::kScanAngleRank, ScalarType::i8)});
  EXPECT_EQ(layout.find(attribute::kScanAngle), 0);
  EXPECT_EQ(layout.find(attribute::kScanAngleRank), 1);
  EXPECT_EQ(layout.find("scan"), -1);
  EXPECT_EQ(layout.find(""), -1);
}

TEST(ScalarType, EveryTypeIsFoundAgainByItsName) {
  for (const ScalarType type : kTypes) {
    EXPECT_EQ(parseScalarType(scalarName(type)), type);
    const std::string name(scalarName(type));
    EXPECT_EQ(scalarBytes(type) * 8, static_cast<std::size_t>(std::stoi(name.substr(1)))) << name;
  }
}

TEST(ScalarType, UnknownNamesAreRefused) {
  for (const std::string_view name : {"", "u7", "float", "U8", "u16 "})
    EXPECT_THROW(parseScalarType(name), Error) << name;
}

}  // namespace
}  // namespace strata
