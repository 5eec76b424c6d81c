#pragma once
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/scalar.h"
#include "io/scan/point_source.h"
#include "tests/support/test_data.h"

namespace strata::test {

/// Reads all points of a source, part by part in order.
inline PointBlock readSource(const PointSource& source, std::size_t blockPoints = 10000) {
  PointBlock all, block;
  for (std::size_t part = 0; part < source.partCount(); ++part) {
    const std::unique_ptr<PointReader> reader = source.openPart(part);
    while (reader->read(block, blockPoints)) {
      EXPECT_LE(block.count(), blockPoints);
      EXPECT_EQ(block.attributes.size(), block.count() * source.info().layout.stride());
      all.positions.insert(all.positions.end(), block.positions.begin(), block.positions.end());
      all.attributes.insert(all.attributes.end(), block.attributes.begin(), block.attributes.end());
    }
  }
  return all;
}

/// Reads them with one thread per part.
inline PointBlock readInParallel(const PointSource& source) {
  std::vector<PointBlock> parts(source.partCount());
  {
    std::vector<std::jthread> threads;
    for (std::size_t part = 0; part < parts.size(); ++part)
      threads.emplace_back([&source, &parts, part] {
        PointBlock block;
        const std::unique_ptr<PointReader> reader = source.openPart(part);
        while (reader->read(block, 777)) {
          PointBlock& out = parts[part];
          out.positions.insert(out.positions.end(), block.positions.begin(), block.positions.end());
          out.attributes.insert(out.attributes.end(), block.attributes.begin(), block.attributes.end());
        }
      });
  }
  PointBlock all;
  for (const PointBlock& part : parts) {
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
    all.attributes.insert(all.attributes.end(), part.attributes.begin(), part.attributes.end());
  }
  return all;
}

inline bool isFinite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

inline Box boundsOf(const PointBlock& points) {
  Box box;
  for (const glm::dvec3& p : points.positions)
    if (isFinite(p)) box.add(p);
  return box;
}

/// Compares bit by bit, so that NaN equals itself.
inline bool sameBits(const PointBlock& a, const PointBlock& b) {
  return a.count() == b.count() && a.attributes == b.attributes &&
         std::memcmp(a.positions.data(), b.positions.data(), a.count() * sizeof(glm::dvec3)) == 0;
}

/// The value of component `k` of an attribute of one point.
inline double valueOf(const PointSource& source, const PointBlock& points, std::size_t point, std::string_view name,
                      std::size_t k = 0) {
  const PointLayout& layout = source.info().layout;
  const int index = layout.find(name);
  if (index < 0) {
    ADD_FAILURE() << "no attribute " << name;
    return std::nan("");
  }
  const auto i = static_cast<std::size_t>(index);
  const ScalarType type = layout.attributes()[i].type;
  return loadScalar(points.attributes.data() + point * layout.stride() + layout.offset(i) + k * scalarBytes(type),
                    type);
}

/// A line of EXPECTED.tsv.
struct ExpectedScan {
  std::string file;
  std::uint64_t points = 0;
  std::string min, max, first, last;  ///< "x,y,z" with as many digits as are known
};

/// The lines whose path starts with `prefix`.
inline std::vector<ExpectedScan> expectedScans(std::string_view prefix) {
  std::ifstream file(dataFolder() / "EXPECTED.tsv");
  std::vector<ExpectedScan> scans;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(prefix)) continue;
    std::istringstream columns(line);
    ExpectedScan scan;
    std::string count;
    std::getline(columns, scan.file, '\t');
    std::getline(columns, count, '\t');
    scan.points = std::stoull(count);
    for (std::string* text : {&scan.min, &scan.max, &scan.first, &scan.last}) std::getline(columns, *text, '\t');
    scans.push_back(scan);
  }
  return scans;
}

/// Compares a number with a text, to half a unit of its last digit and a little more for rounding.
inline void expectPosition(std::string text, const glm::dvec3& found, const std::string& what) {
  std::erase(text, '[');
  std::erase(text, ']');
  std::istringstream columns(text);
  std::string token;
  for (int axis = 0; axis < 3 && std::getline(columns, token, ','); ++axis) {
    const double expected = std::strtod(token.c_str(), nullptr);
    if (!std::isfinite(expected)) {
      EXPECT_FALSE(std::isfinite(found[axis])) << what << " axis " << axis;
      continue;
    }
    const std::size_t exponentAt = token.find('e');
    const int exponent = exponentAt == std::string::npos ? 0 : std::stoi(token.substr(exponentAt + 1));
    const std::size_t point = token.find('.');
    const auto decimals =
        point == std::string::npos ? 0 : static_cast<int>(std::min(exponentAt, token.size()) - point) - 1;
    const double tolerance = 0.51 * std::pow(10.0, exponent - decimals) + 1e-9 * std::abs(expected);
    EXPECT_NEAR(found[axis], expected, tolerance) << what << " axis " << axis;
  }
}

/// Expects the count, the bounds, and the first and last point of EXPECTED.tsv, and a SourceInfo that agrees with them.
inline void expectScan(const ExpectedScan& expected, const PointSource& source) {
  SCOPED_TRACE(expected.file);
  const SourceInfo& info = source.info();
  EXPECT_EQ(info.pointCount, expected.points);
  const PointBlock points = readSource(source);
  ASSERT_EQ(points.count(), expected.points);
  const Box box = boundsOf(points);
  expectPosition(expected.min, box.min, "min");
  expectPosition(expected.max, box.max, "max");
  expectPosition(expected.first, points.positions.front(), "first");
  expectPosition(expected.last, points.positions.back(), "last");
  if (info.boundsExact) {
    EXPECT_EQ(info.bounds.min, box.min);
    EXPECT_EQ(info.bounds.max, box.max);
  }
  if (info.gridExact) {
    for (const glm::dvec3& p : points.positions) {
      if (!isFinite(p)) continue;
      const glm::dvec3 off = p - glm::round(p / info.step) * info.step;
      ASSERT_LE(glm::length(off), 1e-12 * (1.0 + glm::length(p))) << "not on the grid";
    }
  }
  EXPECT_TRUE(sameBits(points, readInParallel(source)));
}

}  // namespace strata::test
