#include "render/compute32_rasterizer.h"

#include <algorithm>

#include "render/gl_scene.h"
#include "render/resolve.h"
#include "render/stopwatch.h"

namespace strata {
namespace {

constexpr std::uint32_t kMaxGroups = 65535;  ///< in one dispatch, which OpenGL guarantees
constexpr std::size_t kPixelsAtOnce = std::size_t{1} << 16;

class Compute32Rasterizer final : public Rasterizer {
 public:
  Compute32Rasterizer(std::unique_ptr<GlContext> context, const RasterizerOptions& options)
      : pool_(options.threads),
        scene_(std::move(context), options),
        program_(scene_.gl(), {{gl::kComputeShader, {"shader_types.h", "batch.glsl", "compute32.comp"}}}),
        depths_(scene_.gl(), 0, gl::kDynamicCopy),
        ids_(scene_.gl(), 0, gl::kDynamicCopy) {
    long long bytes = 0;
    scene_.gl().GetInteger64v(gl::kMaxShaderStorageBlockSize, &bytes);
    maxPixels_ = static_cast<std::size_t>(bytes) / sizeof(std::uint32_t);
  }

  ~Compute32Rasterizer() override { scene_.makeCurrent(); }

  DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Frame& frame) override {
    Stopwatch watch;
    scene_.makeCurrent();
    DrawStats stats = scene_.prepare(list, view, options);
    stats.uploadMs = watch.lapMs();
    buffer_.width = std::max(view.width, 0);
    buffer_.height = std::max(view.height, 0);
    buffer_.pixels.resize(static_cast<std::size_t>(buffer_.width) * static_cast<std::size_t>(buffer_.height));
    program_.use();
    scene_.setViewUniforms();
    // A storage block may be too small for the whole image: then it is drawn band by band.
    const auto width = static_cast<std::size_t>(std::max(view.width, 1));
    const int rowsAtOnce = static_cast<int>(std::clamp<std::size_t>(maxPixels_ / width, 1, std::size_t{1} << 30));
    for (int row = 0; row < buffer_.height; row += rowsAtOnce)
      drawBand(row, std::min(row + rowsAtOnce, buffer_.height));
    scene_.gl().UseProgram(0);
    stats.drawMs = watch.lapMs();
    resolveFrame(list, view, options, buffer_, pool_, frame);
    stats.resolveMs = watch.lapMs();
    return stats;
  }

  std::string_view name() const override { return "compute32"; }
  std::string device() const override { return scene_.renderer(); }

 private:
  void drawBand(int firstRow, int endRow) {
    const GlFunctions& gl = scene_.gl();
    const std::size_t pixels = static_cast<std::size_t>(endRow - firstRow) * static_cast<std::size_t>(buffer_.width);
    const std::uint64_t bytes = pixels * sizeof(std::uint32_t);
    for (GlBuffer* target : {&depths_, &ids_})
      if (target->bytes() != bytes) target->assign(nullptr, bytes);
    depths_.fill(static_cast<std::uint32_t>(kEmptyPixel >> 32));
    ids_.fill(Frame::kNoPoint);
    depths_.bindStorage(STRATA_BINDING_DEPTH);
    ids_.bindStorage(STRATA_BINDING_ID);
    gl.Uniform2i(STRATA_UNIFORM_ROWS, firstRow, endRow);
    for (const int indexPass : {0, 1}) {
      gl.Uniform1i(STRATA_UNIFORM_INDEX_PASS, indexPass);
      for (const PageRun& run : scene_.runs()) dispatch(run);
      gl.MemoryBarrier(gl::kShaderStorageBarrier | gl::kBufferUpdateBarrier);
    }
    readBand(static_cast<std::size_t>(firstRow) * static_cast<std::size_t>(buffer_.width), pixels);
  }

  void dispatch(const PageRun& run) {
    scene_.bind(run);
    for (std::uint32_t done = 0; done < run.recordCount; done += kMaxGroups) {
      scene_.gl().Uniform1ui(STRATA_UNIFORM_FIRST_RECORD, run.firstRecord + done);
      scene_.gl().DispatchCompute(std::min(run.recordCount - done, kMaxGroups), 1, 1);
    }
  }

  void readBand(std::size_t firstPixel, std::size_t pixels) {
    hostDepths_.resize(pixels);
    hostIds_.resize(pixels);
    depths_.read(0, hostDepths_.data(), pixels * sizeof(std::uint32_t));
    ids_.read(0, hostIds_.data(), pixels * sizeof(std::uint32_t));
    pool_.parallelFor(pixels, kPixelsAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) buffer_.pixels[firstPixel + i] = packPixel(hostDepths_[i], hostIds_[i]);
    });
  }

  ThreadPool pool_;
  GlScene scene_;
  GlProgram program_;
  GlBuffer depths_, ids_;
  std::size_t maxPixels_ = 0;  ///< that one storage block holds
  std::vector<std::uint32_t> hostDepths_, hostIds_;
  VisibilityBuffer buffer_;
};

}  // namespace

std::unique_ptr<Rasterizer> createCompute32Rasterizer(std::unique_ptr<GlContext> context,
                                                      const RasterizerOptions& options) {
  return std::make_unique<Compute32Rasterizer>(std::move(context), options);
}

}  // namespace strata
