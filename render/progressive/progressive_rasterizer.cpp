#include "render/progressive/progressive_rasterizer.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/error.h"
#include "core/fingerprint.h"
#include "core/log.h"
#include "render/flood/gl_flood.h"
#include "render/gl/gl_device.h"
#include "render/gpu/shader_records.h"
#include "render/picture/resolve.h"
#include "render/stopwatch.h"

namespace strata {
namespace {

enum Pass : std::size_t { kDepth = 0, kIndex = 1, kKeep = 2, kPasses = 3 };  // STRATA_PASS of progressive.comp
constexpr std::uint32_t kPointsOfThread = 32;                                // kPoints of progressive.comp

/// A fingerprint of everything that decides a picture: two frames with the same key show the same points in the same
/// pixels.
std::uint64_t pictureKey(const View& view, const DrawOptions& options, const DrawPlan& plan) {
  Fingerprint key;
  key.add(view.width);
  key.add(view.height);
  key.add(view.tile);
  key.add(view.nearPlane);
  key.add(view.orthographic);
  for (const GridTransform& grid : plan.grids) {
    key.add(grid.x);
    key.add(grid.y);
    key.add(grid.depth);
    for (const ClipSteps& box : grid.clipBoxes) key.add(box);
    for (const ClipSteps& box : grid.clipCutouts) key.add(box);
    for (const glm::vec4& plane : grid.clipPlanes) key.add(plane);
  }
  for (const PlannedBatch& batch : plan.batches) {
    key.add(batch.node);
    key.add(batch.firstPoint);
    key.add(batch.pointCount);
    key.add(batch.firstId);
    key.add(batch.precision);
    key.add(batch.mapping);
  }
  for (std::size_t c = 0; c < options.classes.size(); ++c) key.add(options.classes[c]);
  return key.value();
}

/// The points [first, end) of one page.
struct Range {
  std::uint32_t page, first, end;
};

class Progressive final : public ProgressiveRasterizer {
 public:
  Progressive(std::unique_ptr<GlContext> context, const ProgressiveOptions& options, int threads)
      : options_(options),
        threads_(threads),
        device_(std::move(context)),
        gl_(device_.gl()),
        groupSize_(device_.groupSize()),
        passes_{programs(0, false), programs(1, false), programs(2, false),
                programs(0, true),  programs(1, true),  programs(2, true)},
        points_(gl_, options.poolPoints, options.key, groupSize_, threads_),
        gridBuffer_(gl_, 0, gl::kStreamDraw),
        depths_(gl_, 0, gl::kDynamicCopy),
        ids_(gl_, 0, gl::kDynamicCopy),
        candidates_(gl_, 0, gl::kDynamicCopy),
        kept_{{{gl_, 0, gl::kDynamicCopy}, {gl_, 0, gl::kDynamicCopy}}},
        stamps_{GlTimestamp(gl_), GlTimestamp(gl_), GlTimestamp(gl_),
                GlTimestamp(gl_), GlTimestamp(gl_), GlTimestamp(gl_)},
        mostPixels_(largestStorageBlock(gl_) / sizeof(glm::uvec4)) {
    passes_[kDepth].get({});  // compiled now, so that a driver that cannot is noticed in the constructor
    stats_.poolPoints = points_.size();
    stats_.poolFree = points_.size();
  }

  ~Progressive() override { device_.makeCurrent(); }

  std::string_view name() const override { return "progressive"; }
  std::string device() const override { return device_.renderer(); }
  const ProgressiveOptions& options() const override { return options_; }
  const ProgressiveStats& progress() const override { return stats_; }
  void setOptions(const ProgressiveOptions& options) override {
    options_.pointsPerFrame = options.pointsPerFrame;
    options_.uploadPerFrame = options.uploadPerFrame;
  }

  DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Picture& picture) override {
    Stopwatch watch;
    device_.makeCurrent();
    planBatches(list, view, options, plan_);
    DrawStats stats = planStats(plan_);
    stats.pointsDrawn = 0;
    const PoolUpdate shown = points_.show(list, plan_, !options.classes.all(), options_.uploadPerFrame);
    stats.nodesNotUploaded = shown.nodesMissing;
    stats.bytesUploaded = shown.pointsWritten * sizeof(glm::uvec4);
    stats.uploadMs = watch.lapMs();
    const std::uint64_t key = pictureKey(view, options, plan_);
    if (key != key_ || shown.pointsWritten > 0) points_.schedule().restart();
    key_ = key;
    beginPixels(view);
    try {
      if (pixels_ > 0) drawOnGpu(options, shown.rewritten, stats);
    } catch (const Error& error) {  // a variant of a shader that this driver cannot compile
      if (!warned_) logWarning("progressive: " + std::string(error.what()));
      warned_ = true;
      forget();
    }
    gl_.UseProgram(0);
    stats.drawMs = watch.lapMs();
    stats.pointsPending = pixels_ > 0 ? points_.schedule().pending() : 0;
    stats.gpuBytes = points_.gpuBytes() + 2 * kept_[0].bytes() + candidates_.bytes();
    resolvePicture({list, view, options}, {threads_, &flood_}, buffer_, picture);
    stats.resolveMs = watch.lapMs();
    report(stats, shown);
    return stats;
  }

 private:
  /// Forgets what the pixels show, so that the next frame begins anew.
  void forget() {
    kept_[source_].fill(STRATA_NO_POINT);
    covered_ = 0;
    points_.schedule().restart();
  }

  void beginPixels(const View& view) {
    const bool sameSize = buffer_.width == view.width && buffer_.height == view.height;
    buffer_.width = std::max(view.width, 0);
    buffer_.height = std::max(view.height, 0);
    const std::size_t pixels = static_cast<std::size_t>(buffer_.width) * static_cast<std::size_t>(buffer_.height);
    buffer_.pixels.assign(pixels, kEmptyPixel);
    pixels_ = plan_.constants.drawable ? pixels : 0;
    if (pixels > mostPixels_) {
      if (!warned_)
        logWarning("progressive: an image of " + std::to_string(pixels) + " pixels stays empty (expected " +
                   std::to_string(mostPixels_) + " at most)");
      warned_ = true;
      pixels_ = 0;
    }
    if (pixels_ == 0 || sameSize) return;
    for (GlBuffer* buffer : {&depths_, &ids_}) buffer->assign(nullptr, pixels * 4);
    for (GlBuffer& buffer : kept_) buffer.assign(nullptr, pixels * sizeof(glm::uvec4));
    forget();
  }

  /// The next `count` places of the pool, split at the ends of pages.
  std::vector<Range> nextRanges(std::uint64_t count) {
    std::vector<Range> ranges;
    const std::uint32_t pagePoints = points_.pagePoints();
    for (const PoolSchedule::Band& band : points_.schedule().next(count))
      for (std::uint32_t first = band.first; first < band.end;) {
        const std::uint32_t page = first / pagePoints, start = page * pagePoints;
        const std::uint32_t end = band.end - start <= pagePoints ? band.end : start + pagePoints;
        ranges.push_back({page, first - start, end - start});
        first = end;
      }
    return ranges;
  }

  std::uint32_t groupsFor(std::uint32_t points) const {
    const std::uint32_t ofGroup = kPointsOfThread * groupSize_;
    return (points + ofGroup - 1) / ofGroup;
  }

  void drawOnGpu(const DrawOptions& options, bool rewritten, DrawStats& stats) {
    const ShaderVariant variant{1, !options.clip.empty(), !options.classes.all()};
    const auto pixels = static_cast<std::uint32_t>(pixels_);
    stats_.filled = std::min(options_.pointsPerFrame, points_.schedule().pending());
    const std::vector<Range> ranges = nextRanges(stats_.filled);
    std::uint64_t words = groupsFor(pixels);
    for (const Range& range : ranges) words += groupsFor(range.end - range.first);
    candidates_.reserve(words * groupSize_ * 4);

    mark(0);
    depths_.fill(static_cast<std::uint32_t>(kEmptyPixel >> 32));
    ids_.fill(Picture::kNoPoint);
    kept_[1 - source_].fill(STRATA_NO_POINT);
    if (rewritten) points_.fetchAgain(kept_[source_], pixels);
    uploadGrids();
    points_.bindPieces(STRATA_BINDING_PIECES);
    kept_[1 - source_].bindStorage(STRATA_BINDING_KEPT);
    gridBuffer_.bindStorage(STRATA_BINDING_GRIDS);
    depths_.bindStorage(STRATA_BINDING_DEPTH);
    ids_.bindStorage(STRATA_BINDING_ID);
    candidates_.bindStorage(STRATA_BINDING_MORE);
    for (const Pass pass : {kDepth, kIndex, kKeep}) {
      mark(pass == kDepth ? 1 : pass + 2);
      passes_[pass + (plan_.grids.size() == 1 ? kPasses : kDepth)].get(variant).use();
      setUniforms(options);
      kept_[source_].bindStorage(STRATA_BINDING_POINTS);
      std::uint32_t word = dispatch({0, 0, pixels}, 0);
      if (pass == kDepth) mark(2);
      for (const Range& range : ranges) {
        points_.bindPage(range.page, STRATA_BINDING_POINTS);
        word = dispatch(range, word);
      }
      gl_.MemoryBarrier(gl::kShaderStorageBarrier | gl::kBufferUpdateBarrier);
    }
    mark(5);
    stats.pointsDrawn = covered_ + stats_.filled;
    stats_.reprojected = covered_;
    readPixels(stats);
    source_ = 1 - source_;
  }

  /// Dispatches one pass over `range`, whose candidates begin at `word`. Returns the word behind them.
  std::uint32_t dispatch(const Range& range, std::uint32_t word) {
    const std::uint32_t groups = groupsFor(range.end - range.first);
    gl_.Uniform3ui(STRATA_UNIFORM_RANGE, range.first, range.end, word);
    gl_.DispatchCompute(groups, 1, 1);
    return word + groups * groupSize_;
  }

  /// Marks the end of a step. Software OpenGL runs a dispatch before the call returns, but puts timestamps off until it
  /// draws; so the wall time of each step is kept as well.
  void mark(std::size_t stamp) {
    stamps_[stamp].record();
    lapMs_[stamp] = lap_.lapMs();
  }

  /// The programs of one pass, either for any number of grids or for a single one.
  ProgramCache programs(int pass, bool oneGrid) const {
    return {gl_,
            {{gl::kComputeShader,
              {"shader_types.h", "batch.glsl", "progressive.comp"},
              define("STRATA_GROUP_SIZE", std::to_string(groupSize_)) + define("STRATA_PASS", std::to_string(pass)) +
                  define("STRATA_ONE_GRID", oneGrid ? "1" : "0")}}};
  }

  void uploadGrids() {
    std::vector<shader::GridRecord> grids;
    for (const GridTransform& grid : plan_.grids) grids.push_back(gridRecord(grid));
    if (grids.empty()) grids.emplace_back();
    gridBuffer_.assign(grids.data(), grids.size() * sizeof(shader::GridRecord));
  }

  /// Sets the uniforms of the program in use.
  void setUniforms(const DrawOptions& options) const {
    if (plan_.grids.size() == 1) {
      const glm::vec4 rows[3] = {plan_.grids[0].x, plan_.grids[0].y, plan_.grids[0].depth};
      gl_.Uniform4fv(STRATA_UNIFORM_GRID, 3, &rows[0].x);
    }
    setViewUniforms(gl_, {&plan_.constants, 1});
    setClipUniforms(gl_, clipCounts(options.clip));
    if (!options.classes.all()) setClassUniforms(gl_, options.classes);
  }

  void readPixels(DrawStats& stats) {
    Stopwatch watch;
    const auto between = [this](std::size_t from, std::size_t to) {
      if (device_.isSoftware()) return std::accumulate(&lapMs_[from + 1], &lapMs_[to] + 1, 0.0);
      return static_cast<double>(stamps_[to].value() - stamps_[from].value()) * 1e-6;
    };
    stats.gpuMs = between(0, 5);
    stats_.clearMs = between(0, 1);
    stats_.reprojectMs = between(1, 2);
    stats_.fillMs = between(2, 3);
    stats_.indexMs = between(3, 4);
    stats_.keepMs = between(4, 5);
    watch.lapMs();
    hostDepths_.resize(pixels_);
    hostIds_.resize(pixels_);
    depths_.read(0, hostDepths_.data(), pixels_ * 4);
    ids_.read(0, hostIds_.data(), pixels_ * 4);
    covered_ = 0;
    for (std::size_t i = 0; i < pixels_; ++i) {
      buffer_.pixels[i] = packPixel(hostDepths_[i], hostIds_[i]);
      covered_ += hostIds_[i] != Picture::kNoPoint;
    }
    stats_.readMs = watch.lapMs();
  }

  void report(const DrawStats& stats, const PoolUpdate& shown) {
    stats_.written = shown.pointsWritten;
    stats_.gpuBytes = stats.gpuBytes;
    stats_.turnPlaces = points_.schedule().places();
    stats_.uploadMs = stats.uploadMs;
    stats_.resolveMs = stats.resolveMs;
    stats_.poolFree = points_.manager().freePoints();
    stats_.ghostPieces = points_.ghostPieces();
    stats_.shownPoints = plan_.pointCount;
    stats_.pieces = 0;
    stats_.leastImportance = PoolManager::kMostImportance;
    stats_.mostImportance = 0;
    for (const PoolBlock& block : points_.manager().blocks()) {
      if (block.free) continue;
      ++stats_.pieces;
      stats_.leastImportance = std::min(stats_.leastImportance, block.importance);
      stats_.mostImportance = std::max(stats_.mostImportance, block.importance);
    }
    if (stats_.pieces == 0) stats_.leastImportance = 0;
  }

  ProgressiveOptions options_;
  ThreadPool threads_;
  const GlDevice device_;
  const GlFunctions& gl_;
  const std::uint32_t groupSize_;
  std::array<ProgramCache, 2 * kPasses> passes_;  ///< for any number of grids, then for one
  PointPool points_;
  GlFlood flood_{gl_, groupSize_};
  GlBuffer gridBuffer_, depths_, ids_, candidates_;
  std::array<GlBuffer, 2> kept_;  ///< the points that the pixels show, in the last frame and in this one
  std::array<GlTimestamp, 6> stamps_;
  const std::uint64_t mostPixels_;  ///< pixels that a storage block holds
  Stopwatch lap_;
  std::array<double, 6> lapMs_{};  ///< wall time since the stamp before
  std::size_t source_ = 0;         ///< which of kept_ is the last frame's
  DrawPlan plan_;
  VisibilityBuffer buffer_;
  std::vector<std::uint32_t> hostDepths_, hostIds_;
  ProgressiveStats stats_;
  std::uint64_t key_ = 0;
  std::uint64_t covered_ = 0;  ///< pixels of the last frame that have a point
  std::size_t pixels_ = 0;     ///< pixels of this frame; 0: nothing is drawn
  bool warned_ = false;
};

}  // namespace

std::unique_ptr<ProgressiveRasterizer> createProgressiveRasterizer(std::unique_ptr<GlContext> context,
                                                                   const ProgressiveOptions& options, int threads) {
  return std::make_unique<Progressive>(std::move(context), options, threads);
}

}  // namespace strata
