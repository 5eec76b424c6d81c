#include "render/flood/gl_flood.h"

#include <algorithm>
#include <bit>
#include <sstream>

#include "core/error.h"
#include "core/log.h"
#include "render/flood/flood_search.h"
#include "render/flood/flood_splats.h"
#include "render/gl/gl_objects.h"
#include "render/gl/shader_variant.h"
#include "render/shaders/shader_types.h"

namespace strata {
namespace {

constexpr unsigned kMostIndexBits = 22;  ///< bits of FloodSum::heaviest that the weight leaves

shader::FloodParams paramsOf(const RenderList& list, const View& view, const FloodSettings& settings, bool normals,
                             const Picture& picture) {
  const FloodLens lens = floodLens(view);
  shader::FloodParams params{};
  params.width = picture.width;
  params.height = picture.height;
  params.halfWidth = (picture.width + 1) / 2;
  params.halfHeight = (picture.height + 1) / 2;
  params.tileColumns = (params.halfWidth + STRATA_FLOOD_TILE - 1) / STRATA_FLOOD_TILE;
  params.tileRows = (params.halfHeight + STRATA_FLOOD_TILE - 1) / STRATA_FLOOD_TILE;
  const auto flag = [&](bool on, std::uint32_t bit) { params.flags |= on ? bit : 0; };
  flag(lens.perspective, STRATA_FLOOD_PERSPECTIVE);
  flag(settings.sectors, STRATA_FLOOD_SECTORS);
  flag(settings.estimateNormals, STRATA_FLOOD_ESTIMATE);
  flag(settings.ellipses, STRATA_FLOOD_ELLIPSES);
  flag(settings.keepFront, STRATA_FLOOD_KEEP_FRONT);
  flag(normals, STRATA_FLOOD_NORMALS);
  params.items = static_cast<std::uint32_t>(list.items.size());
  params.perPixel = lens.perPixel;
  params.middleX = lens.middleX;
  params.middleY = lens.middleY;
  params.farthestReach = static_cast<float>(2 * settings.firstStep);
  params.angle = settings.angle;
  params.continuity = settings.continuity;
  params.relativeRadius = settings.relativeRadius;
  params.mostReaches = kFloodMostSpacings / settings.reachSpacings;
  params.indexBits = static_cast<std::uint32_t>(
      std::bit_width(static_cast<unsigned>(params.halfWidth) * static_cast<unsigned>(params.halfHeight)));
  return params;
}

std::vector<shader::FloodItem> itemsOf(const RenderList& list, const FloodSettings& settings) {
  std::vector<shader::FloodItem> items;
  std::uint32_t firstId = 0;
  const std::vector<float> reaches = floodReaches(list, settings);
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    items.push_back({firstId, reaches[i]});
    firstId += list.items[i].pointCount;
  }
  return items;
}

std::string constants() {
  const auto real = [](const std::string& name, float value) {
    std::ostringstream text;
    text << std::fixed << value;
    return define(name, text.str());
  };
  return real("STRATA_FLOOD_FLAT", kFloodFlat) + real("STRATA_FLOOD_MOST_STRETCH", kFloodMostStretch) +
         real("STRATA_FLOOD_ROUND", kFloodRound) + real("STRATA_FLOOD_NEXT_PIXELS", kFloodNextPixels) +
         real("STRATA_FLOOD_SEED_PIXELS", kFloodSeedPixels) + real("STRATA_FLOOD_LEAST_PIXELS", kFloodLeastPixels) +
         real("STRATA_FLOOD_EDGE_ON", kFloodEdgeOn) + real("STRATA_FLOOD_OPEN_SIDE", kFloodOpenSide) +
         real("STRATA_FLOOD_DEPTH_SHARE", kFloodDepthShare) +
         define("STRATA_FLOOD_FEWEST", std::to_string(kFloodFewestNeighbours));
}

}  // namespace

std::string floodDefines(std::uint32_t groupSize) {
  return define("STRATA_GROUP_SIZE", std::to_string(groupSize)) + constants();
}

/// The programs and buffers, which are made for the first picture.
class GlFlood::Work {
 public:
  Work(const GlFunctions& functions, std::uint32_t groupSize)
      : gl_(functions), groupSize_(groupSize), largestBlock_(largestStorageBlock(functions)) {}

  bool fits(const Picture& picture) const {
    const std::uint64_t pixels = static_cast<std::uint64_t>(picture.width) * static_cast<std::uint64_t>(picture.height);
    const std::uint64_t half =
        static_cast<std::uint64_t>((picture.width + 1) / 2) * static_cast<std::uint64_t>((picture.height + 1) / 2);
    return picture.width <= kFloodLargestSide && picture.height <= kFloodLargestSide &&
           half < (std::uint64_t{1} << kMostIndexBits) && pixels * sizeof(shader::FloodSum) <= largestBlock_ &&
           half * sizeof(shader::FloodShape) <= largestBlock_;
  }

  FloodStats fill(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
                  Picture& picture) {
    send(list, view, settings, pool, picture);
    begin_.record();
    project();
    projected_.record();
    for (int step = settings.firstStep; step > 0; step /= 2) round(layersProgram_, layers_, step);
    searched_.record();
    layers_[0]->bindStorage(STRATA_BINDING_FLOOD_LAYERS);
    for (int step = settings.firstStep; step > 0; step /= 2) round(neighboursProgram_, neighbours_, step);
    round(neighboursProgram_, neighbours_, 0);
    found_.record();
    draw();
    end_.record();
    gl_.UseProgram(0);
    fetch(picture);
    const auto ms = [](const GlTimestamp& from, const GlTimestamp& to) {
      return static_cast<double>(to.value() - from.value()) * 1e-6;
    };
    FloodStats stats;
    stats.projectMs = ms(begin_, projected_);
    stats.layersMs = ms(projected_, searched_);
    stats.neighboursMs = ms(searched_, found_);
    stats.renderMs = ms(found_, end_);
    return stats;
  }

 private:
  using Pair = std::unique_ptr<GlBuffer>[2];

  GlProgram program(std::string_view file) const {
    return GlProgram(gl_, {{gl::kComputeShader, {"shader_types.h", "flood.glsl", file}, floodDefines(groupSize_)}});
  }

  void send(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
            const Picture& picture) {
    // The scan's normals are not in GPU memory, so the CPU looks them up for the pixels of the half picture.
    const bool normals = settings.useNormals && std::any_of(list.items.begin(), list.items.end(), [](const auto& item) {
                           return !item.node->normal.empty();
                         });
    params_ = paramsOf(list, view, settings, normals, picture);
    const auto bytes = [](const auto& some) { return some.size() * sizeof(some[0]); };
    paramsBuffer_.assign(&params_, sizeof(params_));
    const std::vector<shader::FloodItem> items = itemsOf(list, settings);
    items_.assign(items.data(), bytes(items));
    if (normals) {
      const FloodSeeds seeds = collectSeeds(list, view, settings, picture, pool);
      normals_.assign(seeds.normals.data(), bytes(seeds.normals));
    } else {
      normals_.reserve(sizeof(std::uint32_t));
    }
    depths_.assign(picture.depth.data(), bytes(picture.depth));
    ids_.assign(picture.pointId.data(), bytes(picture.pointId));
    colours_.assign(picture.colour.data(), bytes(picture.colour));
    const std::uint64_t pixels = picture.depth.size();
    const std::uint64_t half =
        static_cast<std::uint64_t>(params_.halfWidth) * static_cast<std::uint64_t>(params_.halfHeight);
    seeds_.reserve(half * sizeof(shader::FloodSeed));
    for (const auto& layers : layers_) layers->reserve(half * sizeof(FloodLayers));
    for (const auto& neighbours : neighbours_) {
      neighbours->reserve(half * sizeof(FloodNeighbours));
      neighbours->fill(kNoPixel);
    }
    shapes_.reserve(half * sizeof(shader::FloodShape));
    filledIds_.reserve(pixels * sizeof(std::uint32_t));
    limits_.reserve(pixels * sizeof(std::uint32_t));
    limits_.fill(0x7f800000u);  // infinite
    sums_.reserve(pixels * sizeof(shader::FloodSum));
    sums_.fill(0);
    const auto tiles = static_cast<std::uint64_t>(params_.tileColumns) * static_cast<std::uint64_t>(params_.tileRows);
    reaches_.reserve(2 * tiles * sizeof(float));
    reaches_.fill(0);
    paramsBuffer_.bindStorage(STRATA_BINDING_FLOOD_PARAMS);
    seeds_.bindStorage(STRATA_BINDING_FLOOD_SEEDS);
  }

  void dispatch(const GlProgram& program, int jump, int columns, int rows) {
    program.use();
    gl_.Uniform1i(STRATA_UNIFORM_PASS, jump);
    gl_.DispatchCompute((static_cast<unsigned>(columns) + groupSize_ - 1) / groupSize_, static_cast<unsigned>(rows), 1);
    gl_.MemoryBarrier(gl::kShaderStorageBarrier | gl::kBufferUpdateBarrier);
  }
  void dispatch(const GlProgram& program, int jump) { dispatch(program, jump, params_.halfWidth, params_.halfHeight); }

  void project() {
    normals_.bindStorage(STRATA_BINDING_FLOOD_NORMALS);
    layers_[0]->bindStorage(STRATA_BINDING_FLOOD_TO);
    reaches_.bindStorage(STRATA_BINDING_FLOOD_REACHES);
    items_.bindStorage(STRATA_BINDING_FLOOD_ITEMS);
    ids_.bindStorage(STRATA_BINDING_FLOOD_IDS);
    depths_.bindStorage(STRATA_BINDING_FLOOD_DEPTHS);
    dispatch(projectProgram_, 0);
    dispatch(spreadProgram_, 0, params_.tileColumns, params_.tileRows);
  }

  /// Runs one round, which reads the first buffer of the pair and writes the second. Then swaps them.
  void round(const GlProgram& program, Pair& pair, int step) {
    pair[0]->bindStorage(STRATA_BINDING_FLOOD_FROM);
    pair[1]->bindStorage(STRATA_BINDING_FLOOD_TO);
    dispatch(program, step);
    pair[0].swap(pair[1]);
  }

  void draw() {
    neighbours_[0]->bindStorage(STRATA_BINDING_FLOOD_FROM);
    shapes_.bindStorage(STRATA_BINDING_FLOOD_TO);
    colours_.bindStorage(STRATA_BINDING_FLOOD_COLOURS);
    dispatch(splatsProgram_, 0);
    shapes_.bindStorage(STRATA_BINDING_FLOOD_FROM);
    limits_.bindStorage(STRATA_BINDING_FLOOD_LIMITS);
    sums_.bindStorage(STRATA_BINDING_FLOOD_SUMS);
    depths_.bindStorage(STRATA_BINDING_FLOOD_DEPTHS);
    for (const int pass : {0, 1}) dispatch(drawProgram_, pass);
    ids_.bindStorage(STRATA_BINDING_FLOOD_FROM);
    filledIds_.bindStorage(STRATA_BINDING_FLOOD_IDS);
    dispatch(finishProgram_, 0);
  }

  void fetch(Picture& picture) const {
    const std::uint64_t bytes = picture.depth.size() * sizeof(std::uint32_t);
    colours_.read(0, picture.colour.data(), bytes);
    depths_.read(0, picture.depth.data(), bytes);
    filledIds_.read(0, picture.pointId.data(), bytes);
  }

  std::unique_ptr<GlBuffer> buffer() const { return std::make_unique<GlBuffer>(gl_, 0, gl::kDynamicCopy); }

  const GlFunctions& gl_;
  const std::uint32_t groupSize_;
  const std::uint64_t largestBlock_;  ///< bytes
  const GlProgram projectProgram_ = program("flood_project.comp"), spreadProgram_ = program("flood_spread.comp"),
                  layersProgram_ = program("flood_layers.comp"), neighboursProgram_ = program("flood_neighbours.comp"),
                  splatsProgram_ = program("flood_splats.comp"), drawProgram_ = program("flood_draw.comp"),
                  finishProgram_ = program("flood_finish.comp");
  shader::FloodParams params_{};
  GlBuffer paramsBuffer_{gl_, 0, gl::kDynamicCopy}, items_{gl_, 0, gl::kDynamicCopy},
      normals_{gl_, 0, gl::kDynamicCopy}, depths_{gl_, 0, gl::kDynamicCopy}, ids_{gl_, 0, gl::kDynamicCopy},
      colours_{gl_, 0, gl::kDynamicCopy}, seeds_{gl_, 0, gl::kDynamicCopy}, shapes_{gl_, 0, gl::kDynamicCopy},
      filledIds_{gl_, 0, gl::kDynamicCopy}, limits_{gl_, 0, gl::kDynamicCopy}, sums_{gl_, 0, gl::kDynamicCopy},
      reaches_{gl_, 0, gl::kDynamicCopy};
  Pair layers_{buffer(), buffer()}, neighbours_{buffer(), buffer()};
  GlTimestamp begin_{gl_}, projected_{gl_}, searched_{gl_}, found_{gl_}, end_{gl_};
};

GlFlood::GlFlood(const GlFunctions& functions, std::uint32_t groupSize) : gl_(functions), groupSize_(groupSize) {}

GlFlood::~GlFlood() = default;

FloodStats GlFlood::fill(const RenderList& list, const View& view, const FloodSettings& settings,
                         const ThreadPool& pool, Picture& picture) {
  if (list.items.empty() || picture.depth.empty()) return {};
  try {
    if (!failed_ && work_ == nullptr) work_ = std::make_unique<Work>(gl_, groupSize_);
  } catch (const Error& error) {
    failed_ = true;
    logWarning("holes are filled on the CPU: " + std::string(error.what()));
  }
  return failed_ || !work_->fits(picture) ? floodFill(list, view, settings, pool, picture)
                                          : work_->fill(list, view, settings, pool, picture);
}

}  // namespace strata
