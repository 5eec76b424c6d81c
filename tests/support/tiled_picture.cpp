#include "tests/support/tiled_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "render/plan/picture_tiles.h"
#include "tests/support/synthetic_nodes.h"

namespace strata::test {

std::vector<std::pair<std::string, DrawOptions>> effectsOnPictures(const RenderList& list) {
  std::vector<std::pair<std::string, DrawOptions>> effects;
  const auto add = [&](const std::string& name) -> DrawOptions& {
    effects.push_back({name, {}});
    return effects.back().second;
  };
  add("plain");
  add("large points").pointSize = 5;
  add("points in metres").pointMetres = 1.5f;
  add("filled").fill = 7;
  add("lit").edl = true;
  add("high quality").shading = Shading::highQuality;
  DrawOptions& gradient = add("background that changes from row to row");
  gradient.background = {250, 20, 0};
  gradient.backgroundBelow = glm::u8vec3{0, 100, 255};
  add("gaze").gaze = {true, {0.3f, 0.6f}, 1.0f, 30.0f};
  DrawOptions& clipped = add("clipped");
  const Box box = boundsOf(list);
  clipped.clip.boxes.push_back({box.min, box.centre()});
  add("precision").colour = ColourMode::precision;
  for (const bool metres : {false, true}) {
    DrawOptions& all = add(metres ? "all of it, in metres" : "all of it");
    all.pointSize = 3;
    if (metres) all.pointMetres = 0.8f;
    all.fill = 5;
    all.edl = true;
    all.edlStrength = 2.0f;
    all.shading = Shading::highQuality;
  }
  return effects;
}

Image drawnInTiles(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& options,
                   const TileCuts& cuts) {
  std::mt19937 random(cuts.seed);
  const auto endsOfTiles = [&](int length) {
    std::vector<int> at{0};
    while (at.back() < length)
      at.push_back(std::min(at.back() + std::uniform_int_distribution<int>(1, 150)(random), length));
    return at;
  };
  Image image{view.width, view.height, {}};
  image.pixels.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  const std::vector<int> columns = endsOfTiles(view.width), rows = endsOfTiles(view.height);
  Picture picture;
  for (std::size_t r = 0; r + 1 < rows.size(); ++r)
    for (std::size_t c = 0; c + 1 < columns.size(); ++c) {
      const View tile = tileOfPicture(view, columns[c], rows[r], columns[c + 1] - columns[c], rows[r + 1] - rows[r]);
      const View drawn = withMargin(tile, cuts.margin);
      rasterizer.draw(list, drawn, options, picture);
      copyTile(picture, drawn, tile, image, {columns[c], rows[r]});
    }
  return image;
}

void expectTilesMakeTheWhole(Rasterizer& rasterizer, int views) {
  const RenderList list = makeTown({630000.0, 4850000.0, 120.0}, 120.0, 60000, 7, 4);
  std::uint32_t seed = 1;
  for (View view : viewsAround(boundsOf(list), views, 333, 251)) {
    view.orthographic = seed % 4 == 0;
    view.orthographicHeight = 90.0;
    for (const auto& [name, options] : effectsOnPictures(list)) {
      Picture whole;
      rasterizer.draw(list, view, options, whole);
      const Image tiles = drawnInTiles(rasterizer, list, view, options, {tileMargin(options), ++seed});
      std::size_t different = 0;
      for (std::size_t i = 0; i < tiles.pixels.size(); ++i) different += tiles.pixels[i] != whole.colour[i] ? 1 : 0;
      EXPECT_EQ(different, 0u) << rasterizer.name() << ", " << name << ", seed " << seed;
    }
  }
}

}  // namespace strata::test
