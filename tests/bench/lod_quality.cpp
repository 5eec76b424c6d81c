// How good pictures of few points are, against the picture of all points; docs/benchmarks/lod_quality.md has the
// results.
//   lod_quality compare OUT REFERENCE.strata VIEWS.json LABEL=NAME.strata...   PSNR and SSIM at equal numbers of points
//   lod_quality coverage OUT (LABEL NAME.strata VIEWS.json)...                 covered share over points a pixel
//   lod_quality growth OUT NAME.strata VIEWS.json                              change of the picture when the budget
//   grows
// VIEWS.json is a camera path whose three keys are the views overview, close and detail. OUT is a folder; it gets
// tables, plots and pictures.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/picture.h"
#include "io/store/node_codec.h"
#include "io/store/store.h"
#include "lod/hierarchy_index.h"
#include "lod/selection.h"
#include "render/create_rasterizer.h"
#include "tests/support/mean_picture.h"
#include "tests/support/picture_quality.h"
#include "tests/support/svg_chart.h"
#include "viewer/camera/camera_path.h"

namespace strata::test {
namespace {

constexpr int kWidth = 1920, kHeight = 1080;
constexpr const char* kViewNames[] = {"overview", "close", "detail"};
constexpr std::uint64_t kBudgets[] = {250'000, 1'000'000, 4'000'000};
constexpr std::uint64_t kShownBudget = 1'000'000;  ///< of the pictures
constexpr double kWantedCover = 0.98;
constexpr int kLargestClosing = 12;  ///< pixels, side of the points that close the gaps

std::vector<View> readViews(const std::string& file) {
  const CameraPath path = readCameraPath(file);
  if (path.keys.size() != std::size(kViewNames)) throw Error(file, "three keys are expected");
  std::vector<View> views;
  for (const CameraKey& key : path.keys) views.push_back(viewAt(path, key.t, kWidth, kHeight));
  return views;
}

/// Calls visit(position, drawn 8-bit colour) for every point of the store, from its exact attributes.
template <typename Visit>
void forEachPoint(const Store& store, Visit visit) {
  const StoreInfo& info = store.info();
  const int rgb = info.layout.find(attribute::kRgb);
  if (rgb < 0 || info.layout.find(attribute::kColourShift) >= 0)
    throw Error(store.path(), "no colours, or such of several depths");
  const std::size_t offset = info.layout.offset(static_cast<std::size_t>(rgb));
  for (std::uint32_t node = 0; node < store.hierarchy().nodes.size(); ++node) {
    const NodePoints points = readAll(store, node);
    for (std::size_t i = 0; i < points.count(); ++i) {
      const glm::dvec3 position =
          info.grid.offset + info.grid.scale * glm::dvec3(points.grid[0][i], points.grid[1][i], points.grid[2][i]);
      std::uint16_t channels[3];
      std::memcpy(channels, &points.attributes[i * info.layout.stride() + offset], sizeof channels);
      glm::u8vec3 colour;
      for (glm::length_t c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>(channels[c] >> info.colourShift);
      visit(position, colour);
    }
  }
}

std::vector<MeanPicture> picturesOfAllPoints(const Store& store, const std::vector<View>& views) {
  std::vector<MeanPictureMaker> makers(views.begin(), views.end());
  forEachPoint(store, [&](const glm::dvec3& position, const glm::u8vec3&) {
    for (MeanPictureMaker& maker : makers) maker.addDepth(position);
  });
  forEachPoint(store, [&](const glm::dvec3& position, const glm::u8vec3& colour) {
    for (MeanPictureMaker& maker : makers) maker.addColour(position, colour);
  });
  std::vector<MeanPicture> pictures;
  for (const MeanPictureMaker& maker : makers) pictures.push_back(maker.finish(DrawOptions{}.background));
  return pictures;
}

/// Draws what selectNodes() chooses, everything resident.
class LodPictures {
 public:
  explicit LodPictures(const std::string& path)
      : store_(path),
        index_(indexHierarchy(store_.hierarchy())),
        nodes_(store_.hierarchy().nodes.size()),
        rasterizer_(createRasterizer(Backend::cpu, {}, nullptr)) {}

  const Store& store() const { return store_; }

  /// Returns the number of points in the render list; drawn() counts those of them that passed culling.
  std::uint64_t select(const View& view, const SelectionOptions& options) {
    selectNodes({store_.hierarchy(), index_.reach}, view, options, selection_);
    list_ = {};
    list_.view = view;
    for (const SelectedNode& selected : selection_.nodes) {
      std::shared_ptr<NodeData>& node = nodes_[selected.node];
      if (!node) {
        node = std::make_shared<NodeData>();
        readForDrawing(store_, selected.node, Precision::full30, *node);
      }
      list_.items.push_back({node, selected.pointCount});
      list_.pointCount += selected.pointCount;
    }
    return list_.pointCount;
  }

  const Picture& draw(int pointSize) {
    DrawOptions options;
    options.pointSize = pointSize;
    drawn_ = rasterizer_->draw(list_, list_.view, options, frame_).pointsDrawn;
    return frame_;
  }
  std::uint64_t drawn() const { return drawn_; }

 private:
  Store store_;
  HierarchyIndex index_;
  std::vector<std::shared_ptr<NodeData>> nodes_;
  std::unique_ptr<Rasterizer> rasterizer_;
  Selection selection_;
  RenderList list_;
  Picture frame_;
  std::uint64_t drawn_ = 0;
};

/// More than any budget here allows, so that the budget decides.
SelectionOptions withinBudget(std::uint64_t budget) {
  SelectionOptions options;
  options.pointsPerPixel = 64.0;
  options.pointBudget = budget;
  return options;
}

std::ofstream openTable(const std::string& file, const std::string& header) {
  std::ofstream out(file);
  if (!out) throw Error(file, "cannot be written");
  out << header << '\n';
  return out;
}

void writeText(const std::string& file, const std::string& text) { openTable(file, text); }

Image imageOf(const MeanPicture& picture) {
  Image image{picture.width, picture.height, {}};
  for (const glm::dvec3& colour : picture.colour) {
    const glm::uvec3 c(colour + 0.5);
    image.pixels.push_back(c.x | c.y << 8 | c.z << 16 | 0xff000000u);
  }
  return image;
}

Chart budgetChart(const std::string& title, const std::string& yLabel) {
  Chart chart;
  chart.title = title;
  chart.xLabel = "million points drawn";
  chart.yLabel = yLabel;
  chart.xTicks = {250'000, 500'000, 1'000'000, 2'000'000, 4'000'000};
  chart.xTickLabels = {"0.25", "0.5", "1", "2", "4"};
  return chart;
}

/// Four rows of panels: PSNR and SSIM with points of one pixel, and with points as large as close the gaps.
class QualityPlots {
 public:
  QualityPlots() {
    for (const char* kind : {"PSNR, dB", "SSIM", "PSNR closed, dB", "SSIM closed"})
      for (const char* view : kViewNames) charts_.push_back(budgetChart(view, kind));
  }
  void add(std::size_t view, const std::string& label, std::uint64_t points, const PictureQuality& thin,
           const PictureQuality& closed) {
    const double values[] = {thin.psnr, thin.ssim, closed.psnr, closed.ssim};
    for (std::size_t kind = 0; kind < std::size(values); ++kind) {
      std::vector<ChartLine>& lines = charts_[kind * std::size(kViewNames) + view].lines;
      if (lines.empty() || lines.back().label != label) lines.push_back({label, {}, {}});
      lines.back().x.push_back(static_cast<double>(points));
      lines.back().y.push_back(values[kind]);
    }
  }
  std::string svg() {
    for (Chart& chart : charts_) fitYAxis(chart);
    return svgFigure(charts_, static_cast<int>(std::size(kViewNames)));
  }

 private:
  std::vector<Chart> charts_;
};

/// Points of the least size that cover what is wanted.
const Picture& drawClosed(LodPictures& pictures, const MeanPicture& reference, int& size) {
  for (size = 1;; ++size) {
    const Picture& frame = pictures.draw(size);
    if (size == kLargestClosing || coveredShare(reference, frame) >= kWantedCover) return frame;
  }
}

void compare(const std::string& out, const std::string& referenceStore, const std::string& viewsFile,
             const std::vector<std::string>& stores) {
  const std::vector<View> views = readViews(viewsFile);
  const std::vector<MeanPicture> references = picturesOfAllPoints(Store(referenceStore), views);
  for (std::size_t v = 0; v < views.size(); ++v)
    writePng(out + "/" + kViewNames[v] + "_all.png", imageOf(references[v]));
  std::ofstream table = openTable(out + "/quality.tsv",
                                  "label\tview\tbudget\tpoints\tcovered\tpsnr\tssim\tclosing_size\tpsnr_closed\tssim_"
                                  "closed");
  QualityPlots plots;
  for (const std::string& labelled : stores) {
    const std::size_t equals = labelled.find('=');
    if (equals == std::string::npos) throw UsageError(labelled, "LABEL=NAME.strata is expected");
    const std::string label = labelled.substr(0, equals);
    LodPictures pictures(labelled.substr(equals + 1));
    for (std::size_t v = 0; v < views.size(); ++v)
      for (const std::uint64_t budget : kBudgets) {
        const std::uint64_t points = pictures.select(views[v], withinBudget(budget));
        const Picture& frame = pictures.draw(1);
        const PictureQuality thin = pictureQuality(references[v], frame);
        const std::string name = out + "/" + kViewNames[v] + "_" + label + "_" + std::to_string(budget / 1000) + "k";
        if (budget == kShownBudget) writePng(name + ".png", {frame.width, frame.height, frame.colour});
        int size = 1;
        const Picture& closed = drawClosed(pictures, references[v], size);
        const PictureQuality filled = pictureQuality(references[v], closed);
        if (budget == kShownBudget) writePng(name + "_closed.png", {closed.width, closed.height, closed.colour});
        table << label << '\t' << kViewNames[v] << '\t' << budget << '\t' << points << '\t' << thin.covered << '\t'
              << thin.psnr << '\t' << thin.ssim << '\t' << size << '\t' << filled.psnr << '\t' << filled.ssim
              << std::endl;
        plots.add(v, label, budget, thin, filled);
      }
  }
  writeText(out + "/quality.svg", plots.svg());
}

void coverage(const std::string& out, const std::vector<std::string>& scans) {
  std::ofstream table = openTable(out + "/coverage.tsv", "scan\tview\tpoints_per_pixel\tpoints\tdrawn\tcovered");
  Chart chart;
  chart.title = "covered share of the pixels that all points cover";
  chart.xLabel = "points a pixel";
  chart.xTicks = {0.25, 0.5, 1.0, 2.0, 4.0};
  chart.xTickLabels = {"0.25", "0.5", "1", "2", "4"};
  chart.yMarks = {kWantedCover};
  for (std::size_t scan = 0; scan + 2 < scans.size(); scan += 3) {
    LodPictures pictures(scans[scan + 1]);
    const std::vector<View> views = readViews(scans[scan + 2]);
    const std::vector<MeanPicture> references = picturesOfAllPoints(pictures.store(), views);
    for (std::size_t v = 0; v < views.size(); ++v) {
      ChartLine line{scans[scan] + " " + kViewNames[v], {}, {}};
      for (const double density :
           {0.25, 0.35, 0.5, 0.7, 0.85, 1.0, 1.2, 1.4, 1.5, 1.6, 1.7, 1.8, 2.0, 2.4, 2.8, 3.4, 4.0}) {
        SelectionOptions options;
        options.pointBudget = SelectionOptions::kMaxPointBudget;
        options.pointsPerPixel = density;
        const std::uint64_t points = pictures.select(views[v], options);
        const double covered = coveredShare(references[v], pictures.draw(1));
        table << scans[scan] << '\t' << kViewNames[v] << '\t' << density << '\t' << points << '\t' << pictures.drawn()
              << '\t' << covered << std::endl;
        line.x.push_back(density);
        line.y.push_back(covered);
      }
      chart.lines.push_back(line);
    }
  }
  fitYAxis(chart);
  writeText(out + "/coverage.svg", svgFigure({chart}, 1));
}

void growth(const std::string& out, const std::string& store, const std::string& viewsFile) {
  std::ofstream table = openTable(out + "/growth.tsv", "view\tpoints\tpsnr_to_last\tchanged_share");
  LodPictures pictures(store);
  const std::vector<View> views = readViews(viewsFile);
  for (std::size_t v = 0; v < views.size(); ++v) {
    Picture last;
    for (double budget = 250e3; budget < 4e6; budget *= 1.01) {
      const std::uint64_t points = pictures.select(views[v], withinBudget(static_cast<std::uint64_t>(budget)));
      const Picture& frame = pictures.draw(1);
      if (!last.colour.empty()) {
        std::uint64_t changed = 0;
        for (std::size_t i = 0; i < frame.colour.size(); ++i) changed += frame.colour[i] != last.colour[i] ? 1u : 0u;
        table << kViewNames[v] << '\t' << points << '\t' << psnr(last, frame) << '\t'
              << static_cast<double>(changed) / static_cast<double>(frame.colour.size()) << std::endl;
      }
      last = frame;
    }
  }
}

int run(const std::vector<std::string>& arguments) {
  const std::string command = arguments.empty() ? "" : arguments[0];
  if (arguments.size() < 4) throw UsageError("compare, coverage or growth, OUT and stores are expected");
  const std::string& out = arguments[1];
  std::filesystem::create_directories(out);
  if (command == "compare")
    compare(out, arguments[2], arguments[3], {arguments.begin() + 4, arguments.end()});
  else if (command == "coverage")
    coverage(out, {arguments.begin() + 2, arguments.end()});
  else if (command == "growth")
    growth(out, arguments[2], arguments[3]);
  else
    throw UsageError(command, "compare, coverage or growth is expected");
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
