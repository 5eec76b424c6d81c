#include "render/gpu/compute_rasterizer.h"

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/log.h"
#include "render/flood/gl_flood.h"
#include "render/gpu/compute_target.h"
#include "render/gpu/gl_scene.h"
#include "render/picture/colour_map.h"
#include "render/picture/resolve.h"
#include "render/stopwatch.h"

namespace strata {
namespace {

/// The extensions that compute64 needs, each by any of its names.
const std::vector<std::vector<std::string>>& wideAtomics() {
  static const std::vector<std::vector<std::string>> needs = {
      {"GL_ARB_gpu_shader_int64", "GL_AMD_gpu_shader_int64"},
      {"GL_NV_shader_atomic_int64", "GL_EXT_shader_atomic_int64"}};
  return needs;
}

/// The first name in `either` that the driver has; empty where it has none.
std::string extensionOf(const GlFunctions& gl, const std::vector<std::string>& either) {
  const auto found =
      std::find_if(either.begin(), either.end(), [&gl](const std::string& name) { return hasExtension(gl, name); });
  return found == either.end() ? "" : *found;
}

/// The #extension lines of compute64. Throws Error that names the extensions that are missing.
std::string requireWideAtomics(const GlFunctions& gl) {
  std::string lines, missing;
  for (const std::vector<std::string>& either : wideAtomics()) {
    const std::string name = extensionOf(gl, either);
    if (name.empty()) missing += (missing.empty() ? "" : " and ") + either.front();
    lines += "#extension " + name + " : require\n";
  }
  if (missing.empty()) return lines;
  throw Error("OpenGL", "compute64 needs " + missing + ", not found on " + glRenderer(gl) +
                            " (compute32 draws the same picture without)");
}

std::vector<ShaderStage> stages(std::string_view file, const GlScene& scene, const std::string& defines) {
  return {{gl::kComputeShader,
           {"shader_types.h", "batch.glsl", "draw_batch.glsl", file},
           defines + define("STRATA_GROUP_SIZE", std::to_string(scene.groupSize()))}};
}

std::string prefetch(bool on) { return define("STRATA_PREFETCH", on ? "1" : "0"); }

class ComputeRasterizer final : public Rasterizer {
 public:
  ComputeRasterizer(ComputeWay way, std::unique_ptr<GlContext> context, const RasterizerOptions& options,
                    const ComputeExperiment& experiment)
      : way_(way),
        experiment_(experiment),
        pool_(options.threads),
        scene_(std::move(context), options),
        passes32_(scene_.gl(), stages("compute32.comp", scene_, prefetch(true))),
        blend_(scene_.gl(), stages("accumulate.comp", scene_,
                                   prefetch(experiment.prefetch) + define("STRATA_COUNT", "0") +
                                       define("STRATA_DEPTH_STRIDE", way == ComputeWay::compute64 ? "2" : "1"))),
        count_(scene_.gl(), stages("accumulate.comp", scene_,
                                   prefetch(true) + define("STRATA_COUNT", "1") + define("STRATA_DEPTH_STRIDE", "1"))),
        target_(scene_.gl(), way),
        begin_(scene_.gl()),
        end_(scene_.gl()) {
    if (way == ComputeWay::compute64) {
      std::vector<ShaderStage> wide =
          stages("compute64.comp", scene_, requireWideAtomics(scene_.gl()) + prefetch(experiment.prefetch));
      wide.front().version = 450;  // before it the extensions have no atomics by these names
      onePass_.emplace(scene_.gl(), std::move(wide));
    }
    if (way == ComputeWay::computeLock)
      onePass_.emplace(scene_.gl(),
                       stages("compute_lock.comp", scene_,
                              prefetch(experiment.prefetch) +
                                  define("STRATA_LOCK_TURNS", std::to_string(experiment.lockTurns) + "u")));
    // Compiled now, so that a driver that cannot is noticed in the constructor.
    scene_.compile();
    (onePass_ ? *onePass_ : passes32_).get({});
  }

  ~ComputeRasterizer() override { scene_.makeCurrent(); }

  DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Picture& picture) override {
    return drawViews(list, {&view, 1}, options, {&picture, 1});
  }

  DrawStats drawViews(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                      std::span<Picture> pictures) override {
    DrawStats sum;
    const std::size_t count = std::min(views.size(), pictures.size());
    for (std::size_t first = 0; first < count; first += STRATA_MOST_VIEWS) {
      const std::size_t now = std::min<std::size_t>(count - first, STRATA_MOST_VIEWS);
      addStats(drawAtOnce(list, views.subspan(first, now), options, pictures.subspan(first, now)), sum);
    }
    return sum;
  }

  std::string_view name() const override {
    return way_ == ComputeWay::compute64 ? "compute64" : way_ == ComputeWay::compute32 ? "compute32" : "compute_lock";
  }
  std::string device() const override { return scene_.renderer(); }

 private:
  DrawStats drawAtOnce(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                       std::span<Picture> pictures) {
    Stopwatch watch;
    scene_.makeCurrent();
    const bool counts = options.colour == ColourMode::overdraw;
    const bool sums = !counts && options.shading == Shading::highQuality;
    DrawStats stats = scene_.prepare(list, views, options,
                                     {true, sums && options.colour != ColourMode::precision, experiment_.forcedPlanes});
    stats.uploadMs = watch.lapMs();
    buffers_.resize(views.size());
    for (std::size_t v = 0; v < views.size(); ++v) prepareBuffer(views[v], sums, counts, buffers_[v]);
    try {
      drawOnGpu(options, sums, counts, stats);
    } catch (const Error& error) {  // a variant of a shader that this driver cannot compile
      if (!warned_) logWarning(std::string(name()) + ": " + error.what());
      warned_ = true;
    }
    scene_.gl().UseProgram(0);
    stats.drawMs = watch.lapMs();
    for (std::size_t v = 0; v < views.size(); ++v)
      resolvePicture({list, views[v], options}, {pool_, &flood_}, buffers_[v], pictures[v]);
    stats.resolveMs = watch.lapMs();
    return stats;
  }

  void drawOnGpu(const DrawOptions& options, bool sums, bool counts, DrawStats& stats) {
    begin_.record();
    scene_.dispatchPlan();
    for (const Band& band : target_.begin(buffers_, sums, counts)) {
      drawBand(band, options, sums, counts, stats);
      end_.record();
      target_.read(buffers_);
    }
    addCounters(stats);
  }

  static void prepareBuffer(const View& view, bool sums, bool counts, VisibilityBuffer& buffer) {
    buffer.width = std::max(view.width, 0);
    buffer.height = std::max(view.height, 0);
    const std::size_t pixels = static_cast<std::size_t>(buffer.width) * static_cast<std::size_t>(buffer.height);
    buffer.pixels.assign(pixels, kEmptyPixel);
    buffer.sums.resize(sums ? pixels : 0);
    buffer.counts.resize(counts ? pixels : 0);
  }

  void drawBand(const Band& band, const DrawOptions& options, bool sums, bool counts, DrawStats& stats) {
    target_.beginBand(band);
    if (onePass_) {
      scene_.bindCounters();
      dispatch(*onePass_);
    } else {
      target_.bindCandidates(scene_.candidateWords());
      dispatchPasses32();
    }
    if (way_ == ComputeWay::computeLock && scene_.readCounters().lockGivenUp > 0) repair(stats);
    if (sums || counts) {
      target_.bindSums();
      dispatch(counts ? count_ : blend_, &options);
    }
  }

  /// Draws the points that are missing because a lock stayed taken for too long. The passes of compute32 may go on from
  /// the depths so far, because these are too large at worst, never too small.
  void repair(DrawStats& stats) {
    target_.beginRepair(scene_.candidateWords());
    dispatchPasses32();
    stats.lockRepairs = 1;
  }

  void dispatchPasses32() {
    for (const int indexPass : {0, 1}) {
      begin(passes32_);
      scene_.gl().Uniform1i(STRATA_UNIFORM_PASS, indexPass);
      dispatchRuns();
    }
  }

  void dispatch(ProgramCache& programs, const DrawOptions* options = nullptr) {
    begin(programs);
    if (options != nullptr) {
      const bool own = options->colour != ColourMode::precision;
      scene_.gl().Uniform3ui(STRATA_UNIFORM_PRECISIONS, own ? 0 : precisionColour(1), own ? 0 : precisionColour(2),
                             own ? 0 : precisionColour(3));
    }
    dispatchRuns();
  }

  void begin(ProgramCache& programs) {
    programs.get(scene_.variant()).use();
    scene_.setViewUniforms();
    target_.setUniforms();
  }

  void dispatchRuns() {
    for (const PageRun& run : scene_.runs()) scene_.dispatch(run);
    scene_.gl().MemoryBarrier(gl::kShaderStorageBarrier | gl::kBufferUpdateBarrier);
  }

  void addCounters(DrawStats& stats) const {
    const shader::Counters counters = scene_.readCounters();
    stats.pointsDrawn += counters.pointsDrawn;
    stats.batchesDrawn += counters.batchesDrawn;
    stats.batchesCulled += counters.batchesCulled;
    for (int p = 0; p < 3; ++p) stats.batchesAt[p] += counters.batchesAt[p];
    stats.lockRetries = counters.lockRetries;
    if (!buffers_.empty() && !scene_.runs().empty())
      stats.gpuMs = static_cast<double>(end_.value() - begin_.value()) * 1e-6;
  }

  const ComputeWay way_;
  const ComputeExperiment experiment_;
  ThreadPool pool_;
  GlScene scene_;
  ProgramCache passes32_, blend_, count_;
  std::optional<ProgramCache> onePass_;
  ComputeTarget target_;
  GlFlood flood_{scene_.gl(), scene_.groupSize()};
  GlTimestamp begin_, end_;
  std::vector<VisibilityBuffer> buffers_;
  bool warned_ = false;
};

}  // namespace

bool hasWideAtomics(GlContext& context) {
  const GlFunctions gl = loadGlFunctions(context);
  return std::none_of(wideAtomics().begin(), wideAtomics().end(),
                      [&gl](const auto& either) { return extensionOf(gl, either).empty(); });
}

std::unique_ptr<Rasterizer> createComputeRasterizer(ComputeWay way, std::unique_ptr<GlContext> context,
                                                    const RasterizerOptions& options,
                                                    const ComputeExperiment& experiment) {
  return std::make_unique<ComputeRasterizer>(way, std::move(context), options, experiment);
}

}  // namespace strata
