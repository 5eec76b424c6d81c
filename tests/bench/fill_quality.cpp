// Measures how well holes are filled. A scan is thinned at random, drawn, filled in several ways, and compared with the
// picture of the whole scan. docs/benchmarks/filling.md has the results. Each call prints one table:
//   fill_quality pictures OUT NAME.strata VIEWS.json [KEPT...]
//       PSNR, SSIM, covered and wrongly filled pixels; the pictures of the first view go to the folder OUT
//   fill_quality times NAME.strata VIEWS.json [KEPT...]
//       milliseconds of each step
//   fill_quality steadiness NAME.strata VIEWS.json [KEPT...]
//       the difference between successive frames
// VIEWS.json is a camera path, each of whose keys is a view. KEPT are the shares of points that remain, such as 0.25.
#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/picture.h"
#include "io/store/node_codec.h"
#include "io/store/store.h"
#include "render/create_rasterizer.h"
#include "render/flood/flood_fill.h"
#include "render/flood/gl_flood.h"
#include "render/gl/gl_context.h"
#include "render/stopwatch.h"
#include "tests/support/faithful_flood.h"
#include "tests/support/fill_judge.h"
#include "tests/support/mean_picture.h"
#include "tests/support/picture_quality.h"
#include "viewer/camera/camera_path.h"

namespace strata::test {
namespace {

constexpr int kWidth = 1200, kHeight = 800;  // Farias 2014, 5.1
constexpr int kTimedFrames = 3;
constexpr int kSteadyFrames = 4;
constexpr std::size_t kJudgedViews = 1;  ///< of the pictures: judging them takes longest
constexpr double kStepPixels = 0.6;      ///< that the target moves by from frame to frame

/// Every node of a store with everything that its payload holds, including normals.
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

/// One way of filling a picture that was drawn unfilled.
struct Way {
  std::string name;
  int window = 1;
  bool flood = false;
  FloodSettings settings{};
  bool steadied = false;  ///< judged in motion, too
};

std::vector<Way> waysOf(const Store& store) {
  const glm::dvec3 size = store.info().bounds.size();
  const auto scale = static_cast<float>(std::max({size.x, size.y, size.z}));
  std::vector<Way> ways{{"nothing"}, {"window 3", 3}, {"window 5", 5}, {"window 7", 7}};
  for (const float share : {0.001f, 0.003f, 0.01f, 0.03f}) {
    std::ostringstream name;
    name << "paper " << share;
    ways.push_back({name.str(), 1, true, test::faithfulFlood(scale, share)});
  }
  FloodSettings settings = test::faithfulFlood(scale, 0.01f);
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
  ways.push_back({"with normals of the neighbourhood (jump-flood)", 1, true, settings});
  for (Way& way : ways)
    way.steadied = !way.flood || way.name == "paper 0.003" || way.name == "paper 0.01" || &way == &ways.back();
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

/// Compares fillings of thinned scans with the picture of all points, with one column per share.
void pictures(const std::string& out, const Store& store, const std::vector<View>& views,
              const std::vector<double>& kept) {
  const RenderList whole = readWhole(store);
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const ThreadPool pool(0);
  const std::vector<Way> ways = waysOf(store);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const MeanPicture reference = meanPicture(whole, views[v]);
    Picture full;
    rasterizer->draw(whole, views[v], {}, full);
    const std::string view = out + "/view" + std::to_string(v);
    writePng(view + "_all.png", imageOf(reference));
    std::vector<std::string> rows;
    for (const Way& way : ways) rows.push_back("| " + way.name + " |");
    std::cout << "| view " << v << ": covered, wrong, PSNR, SSIM |";
    for (const double share : kept) {
      std::cout << ' ' << share << " of " << whole.pointCount << " points |";
      const RenderList thin = thinned(whole, share, 1);
      for (std::size_t i = 0; i < ways.size(); ++i) {
        const Way& way = ways[i];
        DrawOptions options;
        options.fill = way.window;
        Picture picture;
        rasterizer->draw(thin, views[v], options, picture);
        if (way.flood) floodFill(thin, views[v], way.settings, pool, picture);
        const FillJudgement judged = judgeFill(full, picture);
        const PictureQuality quality = pictureQuality(reference, picture);
        std::ostringstream cell, name;
        cell << std::fixed << std::setprecision(2) << ' ' << 100.0 * judged.covered << " %, " << 100.0 * judged.wrong
             << " %, " << quality.psnr << " dB, " << std::setprecision(3) << quality.ssim << " |";
        rows[i] += cell.str();
        name << view << "_" << share << "_" << fileName(way.name) << ".png";
        writePng(name.str(), {picture.width, picture.height, picture.colour});
      }
    }
    std::cout << "\n|---|";
    for (std::size_t i = 0; i < kept.size(); ++i) std::cout << "---|";
    std::cout << '\n';
    for (const std::string& row : rows) std::cout << row << '\n';
    std::cout << std::endl;
  }
}

/// The mean time of each step over several frames, milliseconds. The first frame does not count.
struct StepTimes {
  FloodStats sum;
  double wholeMs = 0.0;
};

template <typename Fill>
StepTimes timesOf(const Picture& drawn, Fill fill) {
  StepTimes times;
  for (int i = -1; i < kTimedFrames; ++i) {
    Picture picture = drawn;
    Stopwatch watch;
    const FloodStats one = fill(picture);
    if (i < 0) continue;
    times.wholeMs += watch.lapMs() / kTimedFrames;
    times.sum.seeds = one.seeds;
    times.sum.splats = one.splats;
    times.sum.projectMs += one.projectMs / kTimedFrames;
    times.sum.layersMs += one.layersMs / kTimedFrames;
    times.sum.neighboursMs += one.neighboursMs / kTimedFrames;
    times.sum.renderMs += one.renderMs / kTimedFrames;
  }
  return times;
}

/// Times as in Table 5.2 of Farias 2014, on the CPU, and by compute shaders where there is OpenGL.
void times(const Store& store, const std::vector<View>& views, const std::vector<double>& kept) {
  const RenderList whole = readWhole(store);
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const ThreadPool pool(0);
  std::unique_ptr<GlContext> context;
  GlFunctions gl;
  std::unique_ptr<GlFlood> flood;
  std::string device;
  try {
    context = createHeadlessContext();
    context->makeCurrent();
    gl = loadGlFunctions(*context);
    device = glRenderer(gl);
    flood = std::make_unique<GlFlood>(gl, isSoftwareRenderer(device) ? 8 : 128);
  } catch (const Error& error) {
    std::cout << "No OpenGL: " << error.what() << "\n\n";
  }
  std::cout
      << "| view | size | points | on | seeds | splats | projection | layers | neighbours | splats drawn | all |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|\n"
      << std::fixed << std::setprecision(1);
  const auto row = [&](std::size_t v, const View& view, std::uint64_t points, const std::string& on,
                       const StepTimes& t) {
    std::cout << "| " << v << " | " << view.width << "x" << view.height << " | " << points << " | " << on << " | ";
    if (t.sum.seeds > 0)
      std::cout << t.sum.seeds << " | " << t.sum.splats;
    else
      std::cout << "- | -";
    std::cout << " | " << t.sum.projectMs << " | " << t.sum.layersMs << " | " << t.sum.neighboursMs << " | "
              << t.sum.renderMs << " | " << t.wholeMs << " |" << std::endl;
  };
  for (std::size_t v = 0; v < views.size(); ++v)
    for (const auto& [width, height] : {std::pair{kWidth, kHeight}, {1280, 720}})
      for (const double share : kept) {
        View view = views[v];
        view.width = width;
        view.height = height;
        const RenderList thin = thinned(whole, share, 1);
        Picture drawn;
        rasterizer->draw(thin, view, {}, drawn);
        row(v, view, thin.pointCount, "CPU",
            timesOf(drawn, [&](Picture& picture) { return floodFill(thin, view, {}, pool, picture); }));
        if (flood == nullptr || width != kWidth) continue;
        row(v, view, thin.pointCount, "OpenGL",
            timesOf(drawn, [&](Picture& picture) { return flood->fill(thin, view, {}, pool, picture); }));
      }
  if (flood != nullptr) std::cout << "\nOpenGL: " << device << '\n';
  flood.reset();
}

/// How much successive frames differ along a slow path that goes by each view, see flicker().
void steadiness(const Store& store, const std::vector<View>& views, const std::vector<double>& kept) {
  const RenderList whole = readWhole(store);
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const ThreadPool pool(0);
  std::vector<Way> ways = waysOf(store);
  std::erase_if(ways, [](const Way& way) { return !way.steadied; });
  std::vector<RenderList> thin;
  for (const double share : kept) thin.push_back(thinned(whole, share, 1));
  std::vector<std::string> rows;
  for (const Way& way : ways) rows.push_back("| " + way.name + " |");
  std::cout << "| mean difference, of 255 |";
  for (std::size_t v = 0; v < views.size(); ++v) {
    // The path of one view, and the pictures of all points along it, are the same for every way.
    std::vector<View> path;
    std::vector<Picture> full(kSteadyFrames);
    const double pixel = glm::length(views[v].target - views[v].eye) / pixelsAt(views[v], 1.0, 1.0);
    for (int i = 0; i < kSteadyFrames; ++i) {
      const glm::dvec3 by = static_cast<double>(i) * kStepPixels * pixel * viewBasis(views[v]).right;
      path.push_back(views[v]);
      path.back().eye += by;
      path.back().target += by;
      rasterizer->draw(whole, path.back(), {}, full[static_cast<std::size_t>(i)]);
    }
    for (std::size_t k = 0; k < kept.size(); ++k) {
      std::cout << " view " << v << ", " << kept[k] << " |";
      for (std::size_t w = 0; w < ways.size(); ++w) {
        DrawOptions options;
        options.fill = ways[w].window;
        Picture picture, before;
        double sum = 0.0;
        for (std::size_t i = 0; i < path.size(); ++i) {
          rasterizer->draw(thin[k], path[i], options, picture);
          if (ways[w].flood) floodFill(thin[k], path[i], ways[w].settings, pool, picture);
          if (i > 0) sum += flicker({path[i], full[i], picture}, {path[i - 1], full[i - 1], before});
          std::swap(picture, before);
        }
        std::ostringstream cell;
        cell << std::fixed << std::setprecision(1) << ' ' << sum / (kSteadyFrames - 1) << " |";
        rows[w] += cell.str();
      }
    }
  }
  std::cout << "\n|---|";
  for (std::size_t i = 0; i < views.size() * kept.size(); ++i) std::cout << "---|";
  std::cout << '\n';
  for (const std::string& row : rows) std::cout << row << '\n';
  std::cout << std::endl;
}

std::vector<double> shares(const std::vector<std::string>& arguments, std::size_t first) {
  std::vector<double> kept;
  for (std::size_t i = first; i < arguments.size(); ++i) kept.push_back(std::stod(arguments[i]));
  return kept.empty() ? std::vector<double>{0.25, 0.0625} : kept;
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.size() >= 4 && arguments[0] == "pictures") {
    std::filesystem::create_directories(arguments[1]);
    std::vector<View> views = readViews(arguments[3]);
    views.resize(std::min<std::size_t>(views.size(), kJudgedViews));
    pictures(arguments[1], Store(arguments[2]), views, shares(arguments, 4));
  } else if (arguments.size() >= 3 && arguments[0] == "times") {
    times(Store(arguments[1]), readViews(arguments[2]), shares(arguments, 3));
  } else if (arguments.size() >= 3 && arguments[0] == "steadiness") {
    steadiness(Store(arguments[1]), readViews(arguments[2]), shares(arguments, 3));
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
