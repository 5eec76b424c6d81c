// Every real LAS, LAZ and COPC file against what other programs read from it (EXPECTED.tsv).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/error.h"
#include "io/las/las_record.h"
#include "io/las/las_source.h"
#include "tests/support/sha256.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

std::vector<std::vector<std::string>> readTable(const std::filesystem::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, '\t');) row.push_back(cell);
    rows.push_back(std::move(row));
  }
  return rows;
}

bool isLasFile(const std::string& name) { return name.ends_with(".las") || name.ends_with(".laz"); }

glm::dvec3 parseVector(const std::string& text) {
  glm::dvec3 v(NAN);
  std::sscanf(text.c_str(), "%lf,%lf,%lf", &v.x, &v.y, &v.z);
  return v;
}

/// The results of reading a whole file.
struct Summary {
  std::uint64_t points = 0;
  Box bounds;
  glm::dvec3 first{0.0}, last{0.0};
  std::string recordsSum;
};

Summary summarize(const PointSource& source) {
  const SourceInfo& info = source.info();
  const LasRecordFormat format{info.las->pointFormat, info.las->recordBytes};
  Summary summary;
  test::Sha256 sum;
  std::vector<glm::ivec3> integers;
  std::vector<std::byte> records;
  PointBlock block;
  for (std::size_t part = 0; part < source.partCount(); ++part) {
    const auto reader = source.openPart(part);
    while (reader->read(block, 10007)) {
      EXPECT_EQ(block.attributes.size(), block.count() * info.layout.stride());
      integers.resize(block.count());
      for (std::size_t i = 0; i < block.count(); ++i) {
        integers[i] = glm::ivec3(glm::round(block.positions[i] / info.las->scale));
        const glm::dvec3 world = info.origin + block.positions[i];
        summary.bounds.add(world);
        if (summary.points == 0 && i == 0) summary.first = world;
        summary.last = world;
      }
      records.resize(block.count() * format.recordBytes);
      packLasRecords(format, integers, block.attributes.data(), records.data());
      sum.add(records);
      summary.points += block.count();
    }
  }
  summary.recordsSum = sum.hex();
  return summary;
}

/// The table rounds to 6 decimals (x, y) or 9 digits (z).
void expectNear(const glm::dvec3& found, const std::string& expected, const char* what) {
  const glm::dvec3 wanted = parseVector(expected);
  EXPECT_NEAR(found.x, wanted.x, 0.51e-6) << what;
  EXPECT_NEAR(found.y, wanted.y, 0.51e-6) << what;
  EXPECT_NEAR(found.z, wanted.z, 0.51e-6 + std::abs(wanted.z) * 0.51e-8) << what;
}

/// The headers of these two claim 1065 points; the table has the number that can be read.
bool isCutShort(const std::string& name) {
  return name == "las/edge/1.2-no-points.las" || name == "las/edge/1.2-with-color-clipped.las";
}

TEST(LasFiles, GiveThePointsThatOtherProgramsRead) {
  STRATA_REQUIRE_DATA();
  int files = 0;
  for (const auto& row : readTable(test::dataFolder() / "EXPECTED.tsv")) {
    if (row.size() < 7 || !isLasFile(row[0])) continue;
    SCOPED_TRACE(row[0]);
    SourceOptions options;
    options.skipDamaged = isCutShort(row[0]);
    const auto source = openLas((test::dataFolder() / row[0]).string(), options);
    EXPECT_EQ(source->info().pointCount, isCutShort(row[0]) ? 1065 : std::stoull(row[1]));
    const Summary summary = summarize(*source);
    EXPECT_EQ(summary.points, std::stoull(row[1]));
    EXPECT_EQ(summary.recordsSum, row[6]);
    if (summary.points != 0) {
      expectNear(summary.bounds.min, row[2], "min");
      expectNear(summary.bounds.max, row[3], "max");
      expectNear(summary.first, row[4], "first");
      expectNear(summary.last, row[5], "last");
    }
    ++files;
  }
  EXPECT_GT(files, 100);
}

void expectRefused(const std::filesystem::path& path, const std::string& why) {
  try {
    openLas(path.string(), {});
    ADD_FAILURE() << path << " was not refused";
  } catch (const Error& error) {
    const std::string line = error.what();
    EXPECT_TRUE(line.starts_with(path.string() + ": ")) << line;
    EXPECT_NE(line.find(why), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

TEST(LasFiles, ThatAreBrokenAreRefusedWithTheReason) {
  STRATA_REQUIRE_DATA();
  const auto data = test::dataFolder();
  expectRefused(data / "laz/edge/broken_coder.laz", "unknown LASzip coder, found 15 (expected 0)");
  expectRefused(data / "laz/edge/broken_size.laz", "unknown compression of item 6, found version 6");
  expectRefused(data / "laz/edge/broken_type.laz", "found item 22 of 8 bytes (expected item 7 of 8 bytes)");
  expectRefused(data / "laz/edge/2-2-2-2.laz", "unknown LAS version, found 126.203 (expected 1.0 to 1.4)");
  expectRefused(data / "laz/edge/empty_laz_0673_6363_to_test_pattern_matching_1.laz", "the file is empty");
  expectRefused(data / "las/edge/1.2-no-points.las", "the file ends early, found 0 points (expected 1065)");
  expectRefused(data / "las/edge/1.2-with-color-clipped.las", "the file ends early, found 1064 points (expected 1065)");
}

TEST(LasFiles, OtherThanFilesAreRefused) {
  const test::TempFolder folder;
  expectRefused(folder.path(), "found a folder");
  expectRefused(folder / "missing.las", "No such file");
  std::ofstream(folder / "text.las") << "1 2 3\n4 5 6\n";
  expectRefused(folder / "text.las", "not a LAS or LAZ file");
}

struct PartBytes {
  std::vector<glm::dvec3> positions;
  std::vector<std::byte> attributes;
};

PartBytes readPart(const PointSource& source, std::size_t part, std::size_t blockPoints) {
  PartBytes all;
  PointBlock block;
  const auto reader = source.openPart(part);
  while (reader->read(block, blockPoints)) {
    all.positions.insert(all.positions.end(), block.positions.begin(), block.positions.end());
    all.attributes.insert(all.attributes.end(), block.attributes.begin(), block.attributes.end());
  }
  return all;
}

TEST(LasFiles, PartsReadSideBySideEqualPartsReadInTurn) {
  STRATA_REQUIRE_DATA();
  for (const char* name : {"laz/real/las_with_several_extra_byte_bloc.laz", "laz/real/indoor.laz",
                           "copc/lion_takanawa.copc.laz", "copc/lone-star.copc.laz"}) {
    SCOPED_TRACE(name);
    const auto source = openLas((test::dataFolder() / name).string(), {});
    std::vector<PartBytes> inTurn(source->partCount()), sideBySide(source->partCount());
    std::uint64_t points = 0;
    for (std::size_t part = 0; part < inTurn.size(); ++part) {
      inTurn[part] = readPart(*source, part, 65536);
      points += inTurn[part].positions.size();
    }
    EXPECT_EQ(points, source->info().pointCount);
    {
      std::vector<std::jthread> threads;
      for (std::size_t part = inTurn.size(); part-- > 0;)
        threads.emplace_back([&, part] { sideBySide[part] = readPart(*source, part, 1000); });
    }
    for (std::size_t part = 0; part < inTurn.size(); ++part) {
      EXPECT_EQ(inTurn[part].positions, sideBySide[part].positions);
      EXPECT_EQ(inTurn[part].attributes, sideBySide[part].attributes);
    }
  }
}

TEST(LasFiles, SayTheirCoordinateSystemAndColumns) {
  STRATA_REQUIRE_DATA();
  const auto info = [](const char* name) { return openLas((test::dataFolder() / name).string(), {})->info(); };
  EXPECT_EQ(info("copc/lone-star.copc.laz").format, "COPC 1.4 format 6");
  EXPECT_EQ(info("las/basic/simple.laz").format, "LAZ 1.2 format 3");
  EXPECT_TRUE(info("las/edge/epsg_4326.las").crs.find("4326") != std::string::npos)
      << info("las/edge/epsg_4326.las").crs;
  const SourceInfo extra = info("laz/v2/extrabytes.laz");
  ASSERT_GE(extra.layout.find("extra:Colors"), 0);
  EXPECT_EQ(extra.layout.attributes()[static_cast<std::size_t>(extra.layout.find("extra:Colors"))].components, 3);
  EXPECT_EQ(extra.uncompressedBytes, extra.pointCount * 61);
  EXPECT_EQ(info("las/edge/bad_vlr_count.las").pointCount, 10u);
}

}  // namespace
}  // namespace strata
