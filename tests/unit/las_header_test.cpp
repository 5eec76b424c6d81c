#include "io/las/las_header.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/error.h"
#include "io/las/las_record.h"
#include "io/las/las_vlr.h"

namespace strata {
namespace {

/// A file in memory.
class Memory final : public ByteSource {
 public:
  explicit Memory(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  std::uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    if (offset > bytes_.size() || out.size() > bytes_.size() - offset) throw Error(name_, "truncated read");
    if (!out.empty()) std::memcpy(out.data(), bytes_.data() + offset, out.size());
  }

 private:
  std::string name_ = "memory.las";
  std::vector<std::byte> bytes_;
};

LasMeta someMeta(std::uint8_t minor) {
  LasMeta meta;
  meta.versionMinor = minor;
  meta.pointFormat = minor >= 4 ? 7 : 3;
  meta.recordBytes = minor >= 4 ? 41 : 39;
  meta.scale = {0.01, 0.02, 0.03};
  meta.offset = {500000.0, -4000000.0, 7.5};
  meta.globalEncoding = 17;
  meta.fileSourceId = 42;
  meta.creationDay = 123;
  meta.creationYear = 2024;
  meta.systemIdentifier = "a system";
  meta.generatingSoftware = "a program of exactly 32 letters!";
  meta.vlrs = {{"LASF_Projection", 2112, "WKT", {'P', 'R', 'O', 'J', 0}}, {"someone", 7, "", {}}};
  return meta;
}

LasTotals someTotals() {
  LasTotals totals;
  totals.points = 3;
  totals.byReturn[1] = 2;
  totals.byReturn[2] = 1;
  totals.bounds = {{1, 2, 3}, {4, 5, 6}};
  return totals;
}

std::vector<std::byte> someHead(std::uint8_t minor) {
  const LasMeta meta = someMeta(minor);
  return encodeLasHead("out.las", meta, meta.vlrs, false, someTotals());
}

template <typename T>
std::vector<std::byte> with(std::vector<std::byte> bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

std::string complaint(const std::vector<std::byte>& bytes, std::uint64_t fileBytes = 1000000) {
  try {
    parseLasHeader("a.las", bytes, fileBytes);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

TEST(LasHeader, ComesBackAsItWasWritten) {
  for (std::uint8_t minor = 0; minor <= 4; ++minor) {
    const LasMeta meta = someMeta(minor);
    auto bytes = someHead(minor);
    const std::size_t headBytes = bytes.size();
    bytes.resize(headBytes + 200);
    const LasHead head = readLasHead(Memory(bytes));
    EXPECT_EQ(head.header.versionMinor, minor);
    EXPECT_EQ(head.header.pointFormat, meta.pointFormat);
    EXPECT_EQ(head.header.recordBytes, meta.recordBytes);
    EXPECT_FALSE(head.header.compressed);
    EXPECT_EQ(head.header.pointCount, 3u);
    EXPECT_EQ(head.header.pointsOffset, headBytes);
    EXPECT_EQ(head.header.scale, meta.scale);
    EXPECT_EQ(head.header.offset, meta.offset);
    EXPECT_EQ(head.header.bounds.min, glm::dvec3(1, 2, 3));
    EXPECT_EQ(head.header.bounds.max, glm::dvec3(4, 5, 6));
    EXPECT_EQ(head.header.globalEncoding, 17);
    EXPECT_EQ(head.header.fileSourceId, 42);
    EXPECT_EQ(head.header.creationDay, 123);
    EXPECT_EQ(head.header.creationYear, 2024);
    EXPECT_EQ(head.header.systemIdentifier, meta.systemIdentifier);
    EXPECT_EQ(head.header.generatingSoftware, meta.generatingSoftware);
    ASSERT_EQ(head.vlrs.size(), 2u);
    EXPECT_EQ(head.vlrs[0].data, meta.vlrs[0].data);
    EXPECT_EQ(head.vlrs[1].userId, "someone");
    EXPECT_EQ(lasCrs(head.vlrs), "PROJ");
  }
}

TEST(LasHeader, RefusesEveryPrefixOfItself) {
  for (const std::uint8_t minor : {std::uint8_t{2}, std::uint8_t{4}}) {
    const auto bytes = someHead(minor);
    const std::size_t needed = minor == 4 ? 375 : 227;
    for (std::size_t size = 0; size < needed; ++size) {
      const std::vector<std::byte> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_THROW(parseLasHeader("a.las", prefix, size), Error) << size;
    }
    for (std::size_t size = needed; size < bytes.size(); ++size) {
      const std::vector<std::byte> prefix(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_THROW(readLasHead(Memory(prefix)), Error) << size;
    }
  }
}

TEST(LasHeader, NamesTheFieldThatIsWrong) {
  const auto bytes = someHead(2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint(bytes), "none");
  EXPECT_EQ(complaint({}, 0), "a.las: the file is empty, found 0 bytes (expected a LAS or LAZ file)");
  EXPECT_EQ(complaint(with(bytes, 0, 'X')), "a.las: not a LAS or LAZ file, found no signature (expected LASF)");
  EXPECT_EQ(complaint(with<std::uint8_t>(bytes, 25, 5)), "a.las: unknown LAS version, found 1.5 (expected 1.0 to 1.4)");
  EXPECT_EQ(complaint(with<std::uint8_t>(bytes, 24, 2)), "a.las: unknown LAS version, found 2.2 (expected 1.0 to 1.4)");
  EXPECT_EQ(complaint(with<std::uint16_t>(bytes, 94, 226)),
            "a.las: the header is too short, found 226 bytes (expected at least 227)");
  EXPECT_EQ(complaint(with<std::uint32_t>(bytes, 96, 100)),
            "a.las: points start inside the header, found offset 100 (expected at least 227)");
  EXPECT_EQ(complaint(with<std::uint32_t>(bytes, 96, 1001), 1000),
            "a.las: points start behind the end of the file, found offset 1001 (expected at most 1000)");
  EXPECT_EQ(complaint(with<std::uint8_t>(bytes, 104, 11)), "a.las: unknown point format, found 11 (expected 0 to 10)");
  EXPECT_EQ(complaint(with<std::uint8_t>(bytes, 104, 0x80 | 127)),
            "a.las: unknown point format, found 127 (expected 0 to 10)");
  EXPECT_EQ(complaint(with<std::uint16_t>(bytes, 105, 0)),
            "a.las: the point record is too short, found 0 bytes (expected at least 34 for format 3)");
  EXPECT_EQ(complaint(with<std::uint16_t>(bytes, 105, 33)),
            "a.las: the point record is too short, found 33 bytes (expected at least 34 for format 3)");
  EXPECT_NE(complaint(with(bytes, 139, 0.0)).find("unusable scale factor"), std::string::npos);
  EXPECT_NE(complaint(with(bytes, 147, nan)).find("unusable scale factor"), std::string::npos);
  EXPECT_NE(complaint(with(bytes, 155, nan)).find("unusable offset"), std::string::npos);
}

TEST(LasHeader, TakesWildBoundsForNone) {
  const auto bytes = someHead(2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(parseLasHeader("a.las", with(bytes, 179, nan), 1000).bounds.empty());
  EXPECT_TRUE(parseLasHeader("a.las", with(bytes, 187, 5e300), 1000).bounds.empty());
  EXPECT_FALSE(parseLasHeader("a.las", bytes, 1000).bounds.empty());
}

TEST(LasHeader, PrefersThe64BitCountUnlessItIsZero) {
  const auto bytes = someHead(4);
  EXPECT_EQ(parseLasHeader("a.las", with<std::uint32_t>(bytes, 107, 99), 1000).pointCount, 3u);
  const auto zero = with<std::uint64_t>(with<std::uint32_t>(bytes, 107, 99), 247, 0);
  EXPECT_EQ(parseLasHeader("a.las", zero, 1000).pointCount, 99u);
}

TEST(LasHeader, CutsAVlrCountThatIsTooLarge) {
  auto bytes = with<std::uint32_t>(someHead(2), 100, 0xffffffffu);
  EXPECT_EQ(readLasHead(Memory(bytes)).vlrs.size(), 2u);
}

TEST(LasHeader, KeepsLargeRecordsBehindThePoints) {
  LasMeta meta = someMeta(4);
  meta.vlrs.push_back({"large", 1, "", std::vector<std::uint8_t>(70000, 5)});
  LasTotals totals = someTotals();
  auto bytes = encodeLasHead("out.las", meta, meta.vlrs, false, totals);
  bytes.resize(bytes.size() + 3 * meta.recordBytes);
  totals.evlrStart = bytes.size();
  const auto head = encodeLasHead("out.las", meta, meta.vlrs, false, totals);
  std::copy(head.begin(), head.end(), bytes.begin());
  const auto tail = encodeEvlrs(meta.vlrs);
  bytes.insert(bytes.end(), tail.begin(), tail.end());
  const LasHead found = readLasHead(Memory(bytes));
  ASSERT_EQ(found.vlrs.size(), 3u);
  EXPECT_EQ(found.vlrs[2].data, meta.vlrs[2].data);
  for (std::size_t size = totals.evlrStart; size < bytes.size(); size += 997)
    EXPECT_EQ(readLasHead(Memory({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)})).vlrs.size(), 2u);
}

TEST(LasHeader, WithAnyBytesFlippedIsReadOrRefused) {
  std::mt19937 random(1);
  LasMeta meta = someMeta(4);
  meta.vlrs.push_back(
      encodeExtraBytes({{"extra:a", ScalarType::i16, 1, "", 0.5, 1.0}, {"extra:b", ScalarType::u8, 3, ""}}));
  meta.vlrs.push_back(encodeCrs("EPSG:4326"));
  const auto sound = encodeLasHead("out.las", meta, meta.vlrs, false, someTotals());
  for (int round = 0; round < 20000; ++round) {
    auto bytes = sound;
    bytes.resize(bytes.size() + 300);
    for (int flips = 1 + static_cast<int>(random() % 8); flips > 0; --flips)
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    try {
      const LasHead head = readLasHead(Memory(bytes));
      const LasRecordFormat format{head.header.pointFormat, head.header.recordBytes};
      EXPECT_EQ(lasLayout(format, head.vlrs).stride(), lasStride(format));
      (void)lasCrs(head.vlrs);
    } catch (const Error&) {
    }
  }
}

TEST(ExtraBytes, BecomeColumnsWithScaleAndOffset) {
  const std::vector<Attribute> written{{"extra:height", ScalarType::i32, 1, "above ground", 0.001, -5.0},
                                       {"extra:raw", ScalarType::u8, 9, ""},
                                       {"extra:pair", ScalarType::f64, 2, ""}};
  const auto read = extraAttributes({encodeExtraBytes(written)}, 4 + 9 + 16 + 2);
  ASSERT_EQ(read.size(), 5u);
  EXPECT_EQ(read[0].name, "extra:height");
  EXPECT_EQ(read[0].type, ScalarType::i32);
  EXPECT_EQ(read[0].description, "above ground");
  EXPECT_EQ(read[0].scale, 0.001);
  EXPECT_EQ(read[0].offset, -5.0);
  EXPECT_EQ(read[1].components, 9);
  EXPECT_EQ(read[2].name, "extra:pair[0]");
  EXPECT_EQ(read[3].name, "extra:pair[1]");
  EXPECT_EQ(read[4].name, "extra:bytes");
  EXPECT_EQ(read[4].components, 2);
}

TEST(ExtraBytes, OfOneNameGetNamesOfTheirOwn) {
  const auto read =
      extraAttributes({encodeExtraBytes({{"extra:a", ScalarType::u8, 1, ""}, {"extra:a", ScalarType::u8, 1, ""}})}, 2);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].name, "extra:a");
  EXPECT_EQ(read[1].name, "extra:a_2");
}

TEST(LasText, IsAlwaysUtf8) {
  EXPECT_EQ(lasText("abc"), "abc");
  EXPECT_EQ(lasText({"ab\0c", 4}), "ab");
  EXPECT_EQ(lasText("R\xc3\xa9seau"), "R\xc3\xa9seau");
  EXPECT_EQ(lasText("R\xe9seau"), "R?seau");
  EXPECT_EQ(lasText("\xed\xa0\x80"), "???");
  EXPECT_EQ(lasText("\xf0\x9f"), "??");
}

TEST(LasCrs, ComesFromWktOrGeoKeys) {
  EXPECT_EQ(lasCrs({}), "");
  EXPECT_EQ(lasCrs({encodeCrs("EPSG:25832")}), "EPSG:25832");
  EXPECT_EQ(lasCrs({encodeCrs("EPSG:4326")}), "EPSG:4326");
  EXPECT_EQ(lasCrs({encodeCrs("EPSG:25832"), encodeCrs("PROJCS[\"x\"]")}), "PROJCS[\"x\"]");
}

}  // namespace
}  // namespace strata
