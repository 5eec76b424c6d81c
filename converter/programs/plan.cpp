#include "converter/programs/plan.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "converter/convert.h"
#include "converter/journal/disk_room.h"
#include "converter/programs/progress_display.h"
#include "converter/survey/sampled_source.h"
#include "core/error.h"
#include "core/readable.h"
#include "io/open_scans.h"
#include "io/store/store.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSamplePoints = 1'500'000;
constexpr std::uint64_t kThinner = 4;  // the second sample has so many times fewer points
/// The order of twice the points takes one bit more per point, so that positions get at most one bit shorter.
constexpr double kMostBytesADoubling = 1.0 / 8;
/// The sample shows neither deeper trees nor chunks that end at different times.
constexpr double kBuildMore = 1.1;
constexpr double kMergeMicros = 0.012;  // wall clock per point on one thread; a sample of one chunk has no merge
constexpr double kWriteMicros = 0.006;  // wall clock per point

/// A new folder that the destructor removes.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& parent) : path_(parent + "/strata-plan-XXXXXX") {
    if (::mkdtemp(path_.data()) == nullptr) throw posixError(parent, "creating a folder for the sample", errno);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

struct Sample {
  ConvertReport report;
  Box bounds;
  double bytesOfPoint() const {
    return static_cast<double>(report.outputBytes) / static_cast<double>(std::max<std::uint64_t>(1, report.points));
  }
  double temporaryOfPoint() const {
    return static_cast<double>(report.tempPeakBytes) / static_cast<double>(std::max<std::uint64_t>(1, report.points));
  }
};

Sample convertSample(const Sources& sources, std::uint64_t points, const ConvertOptions& asked,
                     const ConvertControl& control) {
  const ScratchFolder folder(asked.tempFolder.empty() ? fs::temp_directory_path().string() : asked.tempFolder);
  ConvertOptions options = asked;
  options.output = folder.path() + "/sample.strata";
  options.tempFolder = folder.path();
  options.source.skipDamaged = true;  // parts may hold fewer points than asked
  ConvertControl quiet;
  quiet.stop = control.stop;
  quiet.warn = [](const std::string&) {};
  Sample sample;
  sample.report = convert(sampleSources(sources, points), options, quiet);
  sample.bounds = Store(options.output).info().bounds;
  return sample;
}

/// Finds the time of a stage; a stage that did not run took none.
StageTime stageOf(const ConvertReport& report, const char* name) {
  for (const StageTime& stage : report.stages)
    if (stage.name == name) return stage;
  return {name, 0.0, 0.0};
}

/// Scales up the time that each stage took for the sample. Reading counts by the wall clock, which includes the disk.
double secondsFor(const ConversionPlan& plan, const ConvertReport& sample, double surveySeconds, int threads) {
  const double more = static_cast<double>(plan.points) / static_cast<double>(std::max<std::uint64_t>(1, sample.points));
  const double reading = stageOf(sample, stage::kMeasure).seconds + stageOf(sample, stage::kDistribute).seconds;
  const double building = kBuildMore * stageOf(sample, stage::kBuild).cpuSeconds / threads;
  return surveySeconds + more * (reading + building) +
         1e-6 * static_cast<double>(plan.points) * (kMergeMicros + kWriteMicros);
}

/// Bytes per point of the whole scan: those of the larger sample, less what each doubling of the points saved between
/// the two.
double bytesOfPoint(const Sample& larger, const Sample& smaller, std::uint64_t points) {
  const double step = std::log2(static_cast<double>(larger.report.points) / static_cast<double>(smaller.report.points));
  const double rest = std::log2(static_cast<double>(points) / static_cast<double>(larger.report.points));
  if (!(step > 0.5) || !(rest > 0.0)) return larger.bytesOfPoint();
  const double saved = std::clamp((smaller.bytesOfPoint() - larger.bytesOfPoint()) / step, 0.0, kMostBytesADoubling);
  return std::max(larger.bytesOfPoint() - saved * rest, 0.25 * larger.bytesOfPoint());
}

nlohmann::ordered_json toJson(const glm::dvec3& v) { return nlohmann::ordered_json::array({v.x, v.y, v.z}); }

std::string about(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

ConversionPlan planConversion(const ConvertOptions& options, const ConvertControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  SourceOptions sourceOptions = options.source;
  sourceOptions.memoryBytes = options.memoryBytes;
  const Sources sources = openScans(options.inputs, sourceOptions);
  const double surveySeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  ConversionPlan plan;
  plan.scans = sources.size();
  plan.boundsKnown = true;
  for (const auto& source : sources) {
    const SourceInfo& info = source->info();
    plan.points += info.pointCount;
    plan.inputBytes += info.fileBytes;
    plan.boundsKnown = plan.boundsKnown && (!info.bounds.empty() || info.pointCount == 0);
    if (!info.bounds.empty()) plan.bounds.add(info.bounds);
    if (plan.crs.empty()) plan.crs = info.crs;
  }
  if (plan.points == 0) throw Error(sources.front()->info().path, "has no points");

  const Sample larger = convertSample(sources, kSamplePoints, options, control);
  plan.sampledPoints = larger.report.points;
  if (!plan.boundsKnown) plan.bounds.add(larger.bounds);
  plan.storeBytes = static_cast<double>(larger.report.outputBytes);
  plan.temporaryBytes = larger.temporaryOfPoint() * static_cast<double>(plan.points);
  if (larger.report.points < plan.points) {
    const Sample smaller = convertSample(sources, kSamplePoints / kThinner, options, control);
    plan.storeBytes = bytesOfPoint(larger, smaller, plan.points) * static_cast<double>(plan.points);
  }
  plan.seconds = secondsFor(plan, larger.report, surveySeconds, threadsOf(options));
  plan.memoryBytes = static_cast<double>(options.memoryBytes);

  const std::string storeFolder = options.output.empty() ? "." : folderOf(options.output);
  plan.warnings = roomWarnings(storeFolder, options.tempFolder.empty() ? storeFolder : options.tempFolder,
                               {plan.storeBytes, plan.temporaryBytes});
  return plan;
}

std::string planText(const ConversionPlan& plan, const ConvertOptions& options) {
  const auto points = static_cast<double>(plan.points);
  const glm::dvec3 &low = plan.bounds.min, &high = plan.bounds.max;
  char bounds[256];
  std::snprintf(bounds, sizeof bounds, "%.3f %.3f %.3f to %.3f %.3f %.3f%s", low.x, low.y, low.z, high.x, high.y,
                high.z, plan.boundsKnown ? "" : " (of the sample)");
  std::string text = "plan for " + grouped(plan.scans) + (plan.scans == 1 ? " scan, " : " scans, ") +
                     bytesText(static_cast<double>(plan.inputBytes)) + "\n";
  const auto row = [&](const char* name, const std::string& value) {
    text.append("  ").append(name).append(16 - std::string_view(name).size(), ' ').append(value).append("\n");
  };
  row("points", grouped(plan.points));
  row("bounds", bounds);
  row("crs", plan.crs.empty() ? "not stated" : plan.crs);
  row("store", "about " + bytesText(plan.storeBytes) + about(", %.1f bytes a point", plan.storeBytes / points));
  row("temporary disk", "about " + bytesText(plan.temporaryBytes));
  row("memory", "at most " + bytesText(plan.memoryBytes));
  row("time", "about " + durationText(plan.seconds) + " on " + std::to_string(threadsOf(options)) + " threads");
  row("sample", grouped(plan.sampledPoints) + " points converted for this");
  for (const std::string& warning : plan.warnings) text += "warning: " + warning + "\n";
  return text;
}

std::string planJson(const ConversionPlan& plan) {
  const nlohmann::ordered_json json{{"plan", true},
                                    {"scans", plan.scans},
                                    {"points", plan.points},
                                    {"bounds", {{"min", toJson(plan.bounds.min)}, {"max", toJson(plan.bounds.max)}}},
                                    {"bounds_known", plan.boundsKnown},
                                    {"crs", plan.crs},
                                    {"input_bytes", plan.inputBytes},
                                    {"store_bytes", std::llround(plan.storeBytes)},
                                    {"temp_bytes", std::llround(plan.temporaryBytes)},
                                    {"memory_bytes", std::llround(plan.memoryBytes)},
                                    {"seconds", plan.seconds},
                                    {"sampled_points", plan.sampledPoints},
                                    {"warnings", plan.warnings}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace strata
