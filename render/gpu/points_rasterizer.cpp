#include "render/gpu/points_rasterizer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/log.h"
#include "render/flood/gl_flood.h"
#include "render/gpu/gl_scene.h"
#include "render/picture/resolve.h"
#include "render/stopwatch.h"

namespace strata {
namespace {

constexpr std::size_t kPixelsAtOnce = std::size_t{1} << 16;
constexpr int kDepthExponent = 40;  ///< the shader stores depth * 2^-40, which the host multiplies back without loss

/// OpenGL's DrawArraysIndirectCommand.
struct DrawCommand {
  std::uint32_t count, instances, first, baseInstance;
};

/// A framebuffer with an id and a float depth per pixel.
class PointTarget {
 public:
  explicit PointTarget(const GlFunctions& functions) : gl_(functions) {
    gl_.GenFramebuffers(1, &framebuffer_);
    gl_.GenRenderbuffers(2, buffers_);
    gl_.GetIntegerv(gl::kMaxRenderbufferSize, &maxSide_);
  }
  ~PointTarget() {
    gl_.DeleteFramebuffers(1, &framebuffer_);
    gl_.DeleteRenderbuffers(2, buffers_);
  }
  PointTarget(const PointTarget&) = delete;
  PointTarget& operator=(const PointTarget&) = delete;

  /// Binds and clears the framebuffer. False where the driver has none of this size.
  bool begin(int width, int height) {
    if (width > maxSide_ || height > maxSide_) return false;
    gl_.BindFramebuffer(gl::kFramebuffer, framebuffer_);
    if (width != width_ || height != height_) {
      attach(0, gl::kColourAttachment0, gl::kR32Ui, width, height);
      attach(1, gl::kDepthAttachment, gl::kDepthComponent32F, width, height);
      width_ = width;
      height_ = height;
    }
    if (gl_.CheckFramebufferStatus(gl::kFramebuffer) != gl::kFramebufferComplete) return false;
    const unsigned noPoint[4] = {Picture::kNoPoint, 0, 0, 0};
    const float farthest = 1.0f;
    gl_.ClearBufferuiv(gl::kColour, 0, noPoint);
    gl_.ClearBufferfv(gl::kDepth, 0, &farthest);
    return true;
  }

  /// Reads ids and depths. Row 0 is on top, because the shader draws it at the bottom of GL's image.
  void read(std::uint32_t* ids, float* depths) const {
    gl_.PixelStorei(gl::kPackAlignment, 4);
    gl_.ReadBuffer(gl::kColourAttachment0);
    gl_.ReadPixels(0, 0, width_, height_, gl::kRedInteger, gl::kUnsignedInt, ids);
    gl_.ReadPixels(0, 0, width_, height_, gl::kDepthComponent, gl::kFloat, depths);
  }

 private:
  void attach(int index, unsigned attachment, unsigned format, int width, int height) {
    gl_.BindRenderbuffer(gl::kRenderbuffer, buffers_[index]);
    gl_.RenderbufferStorage(gl::kRenderbuffer, format, width, height);
    gl_.FramebufferRenderbuffer(gl::kFramebuffer, attachment, gl::kRenderbuffer, buffers_[index]);
  }

  const GlFunctions& gl_;
  unsigned framebuffer_ = 0;
  unsigned buffers_[2] = {};
  int maxSide_ = 0;
  int width_ = 0, height_ = 0;
};

class PointsRasterizer final : public Rasterizer {
 public:
  PointsRasterizer(std::unique_ptr<GlContext> context, const RasterizerOptions& options)
      : pool_(options.threads),
        scene_(std::move(context), options),
        programs_(scene_.gl(), stages(false)),
        counting_(scene_.gl(), stages(true)),
        counts_(scene_.gl(), 0, gl::kDynamicCopy),
        commands_(scene_.gl(), 0, gl::kStreamDraw),
        recordNumbers_(scene_.gl(), 0, gl::kStaticDraw),
        target_(scene_.gl()),
        begin_(scene_.gl()),
        end_(scene_.gl()) {
    if (scene_.gl().ClipControl == nullptr)
      throw Error("OpenGL", "points needs glClipControl (OpenGL 4.5 or ARB_clip_control), found none");
    scene_.gl().GenVertexArrays(1, &vertexArray_);
    programs_.get({});  // compiled now, so that a driver that cannot is noticed in the constructor
  }

  ~PointsRasterizer() override {
    scene_.makeCurrent();
    scene_.gl().DeleteVertexArrays(1, &vertexArray_);
  }

  DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Picture& picture) override {
    Stopwatch watch;
    scene_.makeCurrent();
    DrawStats stats = scene_.prepare(list, {&view, 1}, options, {});
    writeCommands();
    stats.uploadMs = watch.lapMs();
    const bool counts = options.colour == ColourMode::overdraw;
    buffer_.width = std::max(view.width, 0);
    buffer_.height = std::max(view.height, 0);
    buffer_.pixels.assign(static_cast<std::size_t>(buffer_.width) * static_cast<std::size_t>(buffer_.height),
                          kEmptyPixel);
    buffer_.counts.assign(counts ? buffer_.pixels.size() : 0, 0);
    if (!buffer_.pixels.empty()) drawPoints(counts, stats);
    stats.drawMs = watch.lapMs();
    resolvePicture({list, view, options}, {pool_, &flood_}, buffer_, picture);
    stats.resolveMs = watch.lapMs();
    return stats;
  }

  std::string_view name() const override { return "points"; }
  std::string device() const override { return scene_.renderer(); }

 private:
  static std::vector<ShaderStage> stages(bool count) {
    const std::string defines = define("STRATA_COUNT", count ? "1" : "0");
    return {{gl::kVertexShader, {"shader_types.h", "batch.glsl", "points.vert"}, defines},
            {gl::kFragmentShader, {"shader_types.h", "points.frag"}, defines}};
  }

  /// Writes one draw command per record. A draw gets the number of its record as an instanced attribute.
  void writeCommands() {
    const std::vector<shader::BatchRecord>& records = scene_.records();
    std::vector<DrawCommand> commands;
    for (std::uint32_t i = 0; i < records.size(); ++i) commands.push_back({records[i].pointCount, 1, 0, i});
    if (!commands.empty()) commands_.assign(commands.data(), commands.size() * sizeof(DrawCommand));
    if (recordNumbers_.bytes() >= records.size() * sizeof(std::uint32_t)) return;
    std::vector<std::uint32_t> numbers(2 * records.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    recordNumbers_.assign(numbers.data(), numbers.size() * sizeof(std::uint32_t));
  }

  void drawPoints(bool counts, DrawStats& stats) {
    if (!target_.begin(buffer_.width, buffer_.height)) {
      if (!warned_) logWarning("points: " + scene_.renderer() + " has no framebuffer for so large an image");
      warned_ = true;
      return;
    }
    begin_.record();
    setState(programs_);
    drawRuns();
    ids_.resize(buffer_.pixels.size());
    depths_.resize(buffer_.pixels.size());
    scene_.gl().Finish();  // llvmpipe draws as late as it can, and its clock does not count the delay
    end_.record();
    target_.read(ids_.data(), depths_.data());
    if (counts) countPoints();
    resetState();
    stats.gpuMs = static_cast<double>(end_.value() - begin_.value()) * 1e-6;
    pool_.parallelFor(ids_.size(), kPixelsAtOnce, [&](std::size_t begin, std::size_t end) {
      const float scale = std::ldexp(1.0f, kDepthExponent);
      for (std::size_t i = begin; i < end; ++i)
        if (ids_[i] != Picture::kNoPoint)
          buffer_.pixels[i] = packPixel(std::bit_cast<std::uint32_t>(depths_[i] * scale), ids_[i]);
    });
  }

  void drawRuns() const {
    for (const PageRun& run : scene_.runs()) {
      scene_.bind(run);
      const std::uintptr_t offset = run.firstRecord * sizeof(DrawCommand);
      scene_.gl().MultiDrawArraysIndirect(gl::kPoints, reinterpret_cast<const void*>(offset),
                                          static_cast<int>(run.recordCount), 0);
    }
  }

  /// Draws every point once more, without a depth test, and counts per pixel.
  void countPoints() {
    const std::uint64_t bytes = buffer_.counts.size() * sizeof(std::uint32_t);
    counts_.reserve(bytes);
    counts_.fill(0);
    counts_.bindStorage(STRATA_BINDING_MORE);
    setState(counting_);
    scene_.gl().Disable(gl::kDepthTest);
    scene_.gl().Uniform1i(STRATA_UNIFORM_PASS, buffer_.width);
    drawRuns();
    scene_.gl().MemoryBarrier(gl::kBufferUpdateBarrier);
    counts_.read(0, buffer_.counts.data(), bytes);
  }

  void setState(ProgramCache& programs) const {
    const GlFunctions& gl = scene_.gl();
    gl.Viewport(0, 0, buffer_.width, buffer_.height);
    for (const unsigned capability :
         {gl::kBlend, gl::kCullFace, gl::kScissorTest, gl::kStencilTest, gl::kProgramPointSize})
      gl.Disable(capability);
    gl.Enable(gl::kDepthTest);
    gl.DepthFunc(gl::kLess);
    gl.ClipControl(gl::kLowerLeft, gl::kZeroToOne);
    programs.get(scene_.variant()).use();
    scene_.setViewUniforms();
    gl.BindVertexArray(vertexArray_);
    gl.BindBuffer(gl::kArrayBuffer, recordNumbers_.name());
    gl.EnableVertexAttribArray(STRATA_ATTRIBUTE_RECORD);
    gl.VertexAttribIPointer(STRATA_ATTRIBUTE_RECORD, 1, gl::kUnsignedInt, 0, nullptr);
    gl.VertexAttribDivisor(STRATA_ATTRIBUTE_RECORD, 1);
    gl.BindBuffer(gl::kDrawIndirectBuffer, commands_.name());
  }

  /// Restores the state that other drawing in a window expects.
  void resetState() const {
    const GlFunctions& gl = scene_.gl();
    gl.BindBuffer(gl::kDrawIndirectBuffer, 0);
    gl.BindBuffer(gl::kArrayBuffer, 0);
    gl.BindVertexArray(0);
    gl.UseProgram(0);
    gl.ClipControl(gl::kLowerLeft, gl::kNegativeOneToOne);
    gl.Disable(gl::kDepthTest);
    gl.BindFramebuffer(gl::kFramebuffer, 0);
  }

  ThreadPool pool_;
  GlScene scene_;
  ProgramCache programs_, counting_;
  GlBuffer counts_, commands_, recordNumbers_;
  PointTarget target_;
  GlFlood flood_{scene_.gl(), scene_.groupSize()};
  GlTimestamp begin_, end_;
  unsigned vertexArray_ = 0;
  bool warned_ = false;
  std::vector<std::uint32_t> ids_;
  std::vector<float> depths_;
  VisibilityBuffer buffer_;
};

}  // namespace

std::unique_ptr<Rasterizer> createPointsRasterizer(std::unique_ptr<GlContext> context,
                                                   const RasterizerOptions& options) {
  return std::make_unique<PointsRasterizer>(std::move(context), options);
}

}  // namespace strata
