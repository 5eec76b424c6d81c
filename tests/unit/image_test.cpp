#include "core/image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/error.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

Image noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) image.pixels.push_back(static_cast<std::uint32_t>(random()));
  return image;
}

TEST(Image, APngGivesBackEveryPixel) {
  const test::TempFolder folder;
  const std::string path = (folder / "picture.png").string();
  unsigned seed = 0;
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(7, 3), std::pair(256, 1), std::pair(1, 300), std::pair(640, 480)}) {
    const Image image = noise(width, height, ++seed);
    writePng(path, image);
    const Image again = readPng(path);
    EXPECT_EQ(again.width, width);
    EXPECT_EQ(again.height, height);
    EXPECT_EQ(again.pixels, image.pixels);
  }
}

TEST(Image, TheFileHoldsTheEncodedBytes) {
  const test::TempFolder folder;
  const std::string path = (folder / "picture.png").string();
  const Image image = noise(33, 21, 9);
  writePng(path, image);
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(in), {});
  EXPECT_EQ(bytes, encodePng(image));
  ASSERT_GT(bytes.size(), 4u);
  EXPECT_EQ(std::string(bytes.begin() + 1, bytes.begin() + 4), "PNG");
}

TEST(Image, APngWrittenRowByRowGivesBackEveryPixel) {
  const test::TempFolder folder;
  const std::string path = (folder / "rows.png").string();
  for (const int atOnce : {1, 3, 7, 100}) {
    const Image image = noise(53, 21, static_cast<unsigned>(atOnce));
    PngWriter writer(path, image.width, image.height);
    for (int y = 0; y < image.height; y += atOnce)
      writer.add(&image.pixels[static_cast<std::size_t>(y * image.width)], std::min(atOnce, image.height - y));
    EXPECT_FALSE(std::filesystem::exists(path));
    writer.finish();
    EXPECT_EQ(readPng(path).pixels, image.pixels);
    std::filesystem::remove(path);
  }
}

TEST(Image, APngThatIsNotFinishedLeavesNothingBehind) {
  const test::TempFolder folder;
  const Image image = noise(40, 40, 2);
  { PngWriter(((folder / "never.png").string()), 40, 40).add(image.pixels.data(), 20); }
  PngWriter early((folder / "early.png").string(), 40, 40);
  early.add(image.pixels.data(), 20);
  EXPECT_THROW(early.finish(), Error);
  EXPECT_THROW(PngWriter("/nowhere/x.png", 4, 4), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "never.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "never.png.building"));
  EXPECT_FALSE(std::filesystem::exists(folder / "early.png"));
}

TEST(Image, ReadingWhatIsNoPngNamesTheFile) {
  const test::TempFolder folder;
  const std::string missing = (folder / "missing.png").string();
  const std::string text = (folder / "text.png").string();
  std::ofstream(text) << "no picture";
  for (const std::string& path : {missing, text}) {
    try {
      readPng(path);
      FAIL() << path << " was read";
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).rfind(path, 0), 0u) << e.what();
    }
  }
}

TEST(Image, ATruncatedPngIsRefused) {
  const test::TempFolder folder;
  const std::string path = (folder / "cut.png").string();
  std::vector<std::uint8_t> bytes = encodePng(noise(64, 64, 4));
  bytes.resize(bytes.size() / 2);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  EXPECT_THROW(readPng(path), Error);
}

TEST(Image, WritingIntoAMissingFolderSaysSo) {
  const test::TempFolder folder;
  EXPECT_THROW(writePng((folder / "no" / "such" / "picture.png").string(), noise(2, 2, 1)), Error);
}

}  // namespace
}  // namespace strata
