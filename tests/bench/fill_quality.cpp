// How well holes are filled: a scan thinned at random, drawn and filled in several ways, against the picture of the
// whole scan. docs/effects.md has the results.
//   fill_quality pictures OUT NAME.strata VIEWS.json [KEPT...]   PSNR, SSIM, covered and wrongly filled pixels
//   fill_quality times NAME.strata VIEWS.json [KEPT...]          milliseconds of each step
//   fill_quality steadiness NAME.strata VIEWS.json [KEPT...]     difference of successive frames
// VIEWS.json is a camera path, each of its keys a view. KEPT are the shares of points that remain, such as 0.25. OUT is
// a folder; it gets fill.tsv and the pictures.
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "io/node_codec.h"
#include "io/store.h"
#include "render/flood_fill.h"
#include "render/rasterizer.h"
#include "tests/support/fill_judge.h"
#include "tests/support/mean_picture.h"
#include "tests/support/picture_quality.h"
#include "viewer/camera_path.h"

namespace strata::test {
namespace {

constexpr int kWidth = 1200, kHeight = 800;  // Farias 2014, 5.1
constexpr int kTimedFrames = 5;
constexpr int kSteadyFrames = 6;
constexpr double kStepPixels = 0.6;  ///< that the target moves by from frame to frame

/// Every node of a store with all that its payload holds, normals too.
RenderList readWhole(const Store& store) {
  RenderList list;
  for (std::uint32_t i = 0; i < store.hierarchy().nodes.size(); ++i) {
    const NodeRecord& record = store.hierarchy().nodes[i];
    std::vector<std::byte> bytes(record.payloadBytes);
    store.points().read(record.offset, bytes);
    auto node = std::make_shared<NodeData>();
    decodeForDrawing(record, store.info(), bytes, Precision::full30, *node);
    list.items.push_back({node, node->pointCount()});
    list.pointCount += node->pointCount();
  }
  return list;
}

std::vector<View> readViews(const std::string& file) {
  const CameraPath path = readCameraPath(file);
  std::vector<View> views;
  for (const CameraKey& key : path.keys) views.push_back(viewAt(path, key.t, kWidth, kHeight));
  return views;
}

MeanPicture meanPicture(const RenderList& list, const View& view) {
  MeanPictureMaker maker(view);
  const auto visit = [&](const auto& add) {
    for (const RenderItem& item : list.items)
      for (const Batch& batch : item.node->batches)
        for (std::uint32_t i = batch.firstPoint; i < batch.firstPoint + batch.pointCount; ++i)
          add(pointPosition(*item.node, batch, i, static_cast<Precision>(item.node->loadedPlanes())),
              item.node->colour[i]);
  };
  visit([&](const glm::dvec3& p, std::uint32_t) { maker.addDepth(p); });
  visit([&](const glm::dvec3& p, std::uint32_t c) {
    maker.addColour(p, glm::u8vec3(c & 255u, c >> 8 & 255u, c >> 16 & 255u));
  });
  return maker.finish(DrawOptions{}.background);
}

/// One way of filling a picture that was drawn without.
struct Way {
  std::string name;
  int window = 1;
  bool flood = false;
  FloodSettings settings{};
};

std::vector<Way> waysOf(const Store& store) {
  const glm::dvec3 size = store.info().bounds.size();
  const auto scale = static_cast<float>(std::max({size.x, size.y, size.z}));
  std::vector<Way> ways{{"nothing"}, {"window 3", 3}, {"window 5", 5}, {"window 7", 7}};
  for (const float share : {0.001f, 0.003f, 0.01f, 0.03f}) {
    std::ostringstream name;
    name << "paper " << share;
    ways.push_back({name.str(), 1, true, faithfulFlood(scale, share)});
  }
  FloodSettings settings = faithfulFlood(scale, 0.01f);
  settings.keepFront = true;
  settings.reachMetres = 0.0f;
  settings.continuity = FloodSettings{}.continuity;
  ways.push_back({"reach by spacing", 1, true, settings});
  settings.sectors = true;
  ways.push_back({"and sectors", 1, true, settings});
  settings.ellipses = true;
  ways.push_back({"and ellipses", 1, true, settings});
  settings.useNormals = false;
  ways.push_back({"the same without normals", 1, true, settings});
  settings.estimateNormals = true;
  ways.push_back({"with normals of the neighbourhood", 1, true, settings});
  return ways;
}

Image imageOf(const MeanPicture& picture) {
  Image image{picture.width, picture.height, {}};
  for (const glm::dvec3& colour : picture.colour) {
    const glm::uvec3 c(colour + 0.5);
    image.pixels.push_back(c.x | c.y << 8 | c.z << 16 | 0xff000000u);
  }
  return image;
}

std::string fileName(std::string name) {
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name;
}

void pictures(const std::string& out, const std::string& path, const std::string& viewsFile,
              const std::vector<double>& kept) {
  const Store store(path);
  const RenderList whole = readWhole(store);
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const ThreadPool pool(0);
  const std::vector<View> views = readViews(viewsFile);
  std::ofstream table(out + "/fill.tsv");
  if (!table) throw Error(out + "/fill.tsv", "cannot be written");
  table << "view\tkept\tway\tcovered\twrong\tpsnr\tssim\tms\n";
  for (std::size_t v = 0; v < views.size(); ++v) {
    const MeanPicture reference = meanPicture(whole, views[v]);
    Frame full;
    rasterizer->draw(whole, views[v], {}, full);
    const std::string view = out + "/view" + std::to_string(v);
    writePng(view + "_all.png", imageOf(reference));
    for (const double share : kept) {
      const RenderList thin = thinned(whole, share, 1);
      for (const Way& way : waysOf(store)) {
        DrawOptions options;
        options.fill = way.window;
        Frame frame;
        rasterizer->draw(thin, views[v], options, frame);
        FloodStats stats;
        if (way.flood) stats = floodFill(thin, views[v], way.settings, pool, frame);
        const FillJudgement judged = judgeFill(full, frame);
        const PictureQuality quality = pictureQuality(reference, frame);
        table << v << '\t' << share << '\t' << way.name << '\t' << judged.covered << '\t' << judged.wrong << '\t'
              << quality.psnr << '\t' << quality.ssim << '\t'
              << stats.projectMs + stats.layersMs + stats.neighboursMs + stats.renderMs << std::endl;
        std::ostringstream name;
        name << view << "_" << share << "_" << fileName(way.name) << ".png";
        writePng(name.str(), {frame.width, frame.height, frame.colour});
      }
    }
  }
}

/// As Table 5.2 of Farias 2014: milliseconds of each step.
void times(const std::string& path, const std::string& viewsFile, const std::vector<double>& kept) {
  const RenderList whole = readWhole(Store(path));
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const ThreadPool pool(0);
  std::cout << "| view | points | seeds | splats | draw | projection | layers | neighbours | splats drawn | total |\n"
               "|---|---|---|---|---|---|---|---|---|---|\n"
            << std::fixed << std::setprecision(1);
  const std::vector<View> views = readViews(viewsFile);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double share : kept) {
      const RenderList thin = thinned(whole, share, 1);
      FloodStats sum;
      double drawMs = 0.0;
      for (int i = 0; i < kTimedFrames; ++i) {
        Frame frame;
        const DrawStats drawn = rasterizer->draw(thin, views[v], {}, frame);
        drawMs += drawn.drawMs + drawn.resolveMs;
        const FloodStats one = floodFill(thin, views[v], {}, pool, frame);
        sum.seeds = one.seeds;
        sum.splats = one.splats;
        sum.projectMs += one.projectMs;
        sum.layersMs += one.layersMs;
        sum.neighboursMs += one.neighboursMs;
        sum.renderMs += one.renderMs;
      }
      const auto mean = [](double ms) { return ms / kTimedFrames; };
      std::cout << "| " << v << " | " << thin.pointCount << " | " << sum.seeds << " | " << sum.splats << " | "
                << mean(drawMs) << " | " << mean(sum.projectMs) << " | " << mean(sum.layersMs) << " | "
                << mean(sum.neighboursMs) << " | " << mean(sum.renderMs) << " | "
                << mean(drawMs + sum.projectMs + sum.layersMs + sum.neighboursMs + sum.renderMs) << " |" << std::endl;
    }
}

/// How much successive frames differ along a slow path that goes by each view, see flicker().
void steadiness(const std::string& path, const std::string& viewsFile, const std::vector<double>& kept) {
  const Store store(path);
  const RenderList whole = readWhole(store);
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const ThreadPool pool(0);
  std::cout << "view\tkept\tway\tflicker" << std::endl;
  const std::vector<View> views = readViews(viewsFile);
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const double share : kept) {
      const RenderList thin = thinned(whole, share, 1);
      for (const Way& way : waysOf(store)) {
        DrawOptions options;
        options.fill = way.window;
        View view = views[v], before;
        const double pixel = glm::length(view.target - view.eye) / pixelsAt(view, 1.0, 1.0);
        const glm::dvec3 step = kStepPixels * pixel * viewBasis(view).right;
        Frame full, fullBefore, frame, frameBefore;
        double sum = 0.0;
        for (int i = 0; i < kSteadyFrames; ++i) {
          rasterizer->draw(whole, view, {}, full);
          rasterizer->draw(thin, view, options, frame);
          if (way.flood) floodFill(thin, view, way.settings, pool, frame);
          if (i > 0) sum += flicker(full, view, frame, fullBefore, before, frameBefore);
          std::swap(full, fullBefore);
          std::swap(frame, frameBefore);
          before = view;
          view.eye += step;
          view.target += step;
        }
        std::cout << v << '\t' << share << '\t' << way.name << '\t' << sum / (kSteadyFrames - 1) << std::endl;
      }
    }
}

std::vector<double> shares(const std::vector<std::string>& arguments, std::size_t first) {
  std::vector<double> kept;
  for (std::size_t i = first; i < arguments.size(); ++i) kept.push_back(std::stod(arguments[i]));
  return kept.empty() ? std::vector<double>{0.25, 0.0625} : kept;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() >= 4 && arguments[0] == "pictures") {
    std::filesystem::create_directories(arguments[1]);
    pictures(arguments[1], arguments[2], arguments[3], shares(arguments, 4));
  } else if (arguments.size() >= 3 && arguments[0] == "times") {
    times(arguments[1], arguments[2], shares(arguments, 3));
  } else if (arguments.size() >= 3 && arguments[0] == "steadiness") {
    steadiness(arguments[1], arguments[2], shares(arguments, 3));
  } else {
    throw UsageError("pictures OUT STORE VIEWS, times STORE VIEWS or steadiness STORE VIEWS is expected");
  }
  return 0;
}

}  // namespace
}  // namespace strata::test

int main(int argc, char** argv) {
  try {
    return strata::test::run({argv + 1, argv + argc});
  } catch (const std::exception& failure) {
    std::cerr << "error: " << failure.what() << '\n';
    return 1;
  }
}
