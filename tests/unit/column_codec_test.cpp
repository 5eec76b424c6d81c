#include "io/store/column_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>

#include "io/store/huffman.h"

namespace strata {
namespace {

using Values = std::vector<std::uint8_t>;

HuffmanCode::Histogram countsOf(const Values& values) {
  HuffmanCode::Histogram counts{};
  for (const std::uint8_t value : values) ++counts[value];
  return counts;
}

/// Counts that are Fibonacci numbers, so that a code without a limit gives each rarer symbol one more bit.
Values fibonacciValues(int symbols) {
  Values values;
  std::size_t count = 1, before = 1;
  for (int s = 0; s < symbols; ++s) {
    values.insert(values.end(), count, static_cast<std::uint8_t>(7 * s));
    count += std::exchange(before, count);
  }
  std::shuffle(values.begin(), values.end(), std::mt19937(1));
  return values;
}

void expectHuffman(const Values& values) {
  const HuffmanCode code(countsOf(values));
  std::vector<std::byte> stored;
  code.append(values, stored);
  EXPECT_LE(stored.size(), code.storedBytes());
  Values back(values.size());
  ASSERT_TRUE(decodeHuffman(stored, back));
  EXPECT_EQ(back, values);
}

TEST(Huffman, GivesBackEveryValueAtEveryLength) {
  std::mt19937 random(2);
  for (std::size_t count = 2; count < 200; ++count) {
    Values values(count);
    for (std::uint8_t& v : values) v = static_cast<std::uint8_t>(random() % (1 + count % 50));
    values[0] = 200;
    values[1] = 3;
    expectHuffman(values);
  }
}

TEST(Huffman, LimitsCodesThatWouldBeTooLong) {
  expectHuffman(fibonacciValues(20));
  expectHuffman(fibonacciValues(24));
}

TEST(Huffman, ComesWithinAHundredthOfTheEntropyWhereItCan) {
  std::mt19937 random(3);
  std::geometric_distribution<int> geometric(0.08);
  Values values(100000);
  for (std::uint8_t& v : values) v = static_cast<std::uint8_t>(std::min(geometric(random), 255));
  std::vector<std::byte> stored;
  HuffmanCode(countsOf(values)).append(values, stored);
  EXPECT_LT(static_cast<double>(stored.size()) * 8, entropyBits(values) * 1.01 + 8 * 160);
}

TEST(Huffman, RefusesWhatIsShortOrNoCode) {
  const Values values = fibonacciValues(16);
  std::vector<std::byte> stored;
  HuffmanCode(countsOf(values)).append(values, stored);
  Values back(values.size());
  for (std::size_t bytes = 0; bytes < stored.size(); bytes += 1 + bytes / 64)
    EXPECT_FALSE(decodeHuffman(std::span(stored).first(bytes), back)) << bytes;
  stored[1] = std::byte{0};  // the first two symbols lose their codes
  EXPECT_FALSE(decodeHuffman(stored, back));
}

ColumnMode modeOf(const std::vector<std::byte>& stored) { return static_cast<ColumnMode>(stored[0]); }

TEST(Column, TakesTheModeThatFitsAndGivesBackEveryValue) {
  std::mt19937 random(4);
  Values noise(5000), skewed(5000), runs(5000);
  for (std::size_t i = 0; i < 5000; ++i) {
    noise[i] = static_cast<std::uint8_t>(random());
    skewed[i] = static_cast<std::uint8_t>(std::min({random() % 200, random() % 200, random() % 200}));
    runs[i] = static_cast<std::uint8_t>(i / 1500);
  }
  const std::pair<Values, ColumnMode> cases[] = {
      {Values(5000, 9), ColumnMode::constant}, {Values{}, ColumnMode::constant},
      {Values{5}, ColumnMode::constant},       {noise, ColumnMode::raw},
      {skewed, ColumnMode::huffman},           {runs, ColumnMode::lz4}};
  for (const auto& [values, mode] : cases) {
    std::vector<std::byte> stored;
    appendColumn(values, stored);
    EXPECT_EQ(modeOf(stored), mode);
    EXPECT_LE(stored.size(), values.size() + kColumnHeadBytes + 1);
    stored.push_back(std::byte{77});
    std::span<const std::byte> rest(stored);
    Values back(values.size());
    ASSERT_TRUE(takeColumn(rest, back));
    EXPECT_EQ(back, values);
    EXPECT_EQ(rest.size(), 1u);
  }
}

}  // namespace
}  // namespace strata
