#include "io/synthetic/shape_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "core/error.h"
#include "core/text.h"
#include "io/synthetic/scanner.h"
#include "io/synthetic/scenes.h"
#include "io/synthetic/shape.h"

namespace strata::synthetic {
namespace {

constexpr std::string_view kScheme = "synthetic:";
constexpr std::size_t kBlockPoints = 4096;  // generated at a time, few enough for the second cache

using Factory = std::unique_ptr<Shape> (*)(std::uint64_t points, std::uint64_t seed);
struct NamedShape {
  std::string_view name;
  Factory make;
};
constexpr std::array<NamedShape, 7> kShapes = {{
    {"plane", makePlane},
    {"room", [](std::uint64_t points, std::uint64_t seed) -> std::unique_ptr<Shape> { return makeRoom(points, seed); }},
    {"city", [](std::uint64_t points, std::uint64_t seed) -> std::unique_ptr<Shape> { return makeCity(points, seed); }},
    {"terrain", makeTerrain},
    {"stack", makeStack},
    {"sphere", makeSphere},
    {"degenerate", makeDegenerate},
}};

struct Spec {
  const NamedShape* shape = nullptr;
  std::uint64_t points = 1'000'000;
  std::uint64_t seed = 1;
};

/// Whole numbers, also as 1e9.
std::uint64_t parsePoints(const std::string& spec, std::string_view text) {
  double value = 0.0;
  if (!parseWhole(text, value) || value != std::floor(value) || value < 1.0 || value > kMaxPoints) {
    throw UsageError(spec, "points: found '" + std::string(text) + "' (expected a whole number from 1 to 1e11)");
  }
  return static_cast<std::uint64_t>(value);
}

std::uint64_t parseSeed(const std::string& spec, std::string_view text) {
  std::uint64_t value = 0;
  if (!parseWhole(text, value)) {
    throw UsageError(spec, "seed: found '" + std::string(text) + "' (expected a whole number from 0 to 2^64 - 1)");
  }
  return value;
}

const NamedShape* parseName(const std::string& spec, std::string_view name) {
  std::string choices;
  for (const NamedShape& shape : kShapes) {
    if (shape.name == name) return &shape;
    choices += (choices.empty() ? "" : ", ") + std::string(shape.name);
  }
  throw UsageError(spec, "no such synthetic scan: found '" + std::string(name) + "' (expected one of " + choices + ")");
}

Spec parseSpec(const std::string& spec) {
  std::string_view rest = spec;
  if (!rest.starts_with(kScheme))
    throw UsageError(spec, "found no 'synthetic:' in front (expected synthetic:NAME?points=N&seed=S)");
  rest.remove_prefix(kScheme.size());
  const std::size_t question = rest.find('?');
  Spec result;
  result.shape = parseName(spec, rest.substr(0, question));
  if (question == std::string_view::npos) return result;
  rest.remove_prefix(question + 1);
  for (bool more = true; more;) {
    const std::size_t ampersand = rest.find('&');
    const std::string_view pair = rest.substr(0, ampersand);
    more = ampersand != std::string_view::npos;
    if (more) rest.remove_prefix(ampersand + 1);
    const std::size_t equals = pair.find('=');
    const std::string_view key = pair.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? std::string_view() : pair.substr(equals + 1);
    if (key == "points") {
      result.points = parsePoints(spec, value);
    } else if (key == "seed") {
      result.seed = parseSeed(spec, value);
    } else {
      throw UsageError(spec, "unknown key: found '" + std::string(key) + "' (expected points or seed)");
    }
  }
  return result;
}

PointLayout layoutOf(const ShapeExtent& extent) {
  std::vector<Attribute> attributes = {{std::string(attribute::kRgb), ScalarType::u16, 3, "", 1.0, 0.0},
                                       {std::string(attribute::kIntensity), ScalarType::u16, 1, "", 1.0, 0.0},
                                       {std::string(attribute::kClassification), ScalarType::u8, 1, "", 1.0, 0.0}};
  if (extent.hasNormals) attributes.push_back({std::string(attribute::kNormal), ScalarType::f32, 3, "", 1.0, 0.0});
  return PointLayout(std::move(attributes));
}

/// The box of the extent in whole grid steps from the origin. Points are clamped into it.
struct GridBox {
  glm::dvec3 low, high;
};
GridBox gridBox(const ShapeExtent& extent) {
  return {glm::floor(extent.min / kStep + 0.5), glm::floor(extent.max / kStep + 0.5)};
}

SourceInfo describe(const std::string& path, const Spec& spec, const ShapeExtent& extent) {
  const GridBox box = gridBox(extent);
  SourceInfo info;
  info.path = path;
  info.format = "synthetic " + std::string(spec.shape->name);
  info.pointCount = spec.points;
  info.boundsExact = true;
  info.origin = extent.origin;
  info.bounds.add(extent.origin + box.low * kStep);
  info.bounds.add(extent.origin + box.high * kStep);
  info.step = glm::dvec3(kStep);
  info.gridExact = true;
  info.layout = layoutOf(extent);
  info.uncompressedBytes = spec.points * (3 * sizeof(std::int32_t) + info.layout.stride());
  return info;
}

/// 8-bit shade in both bytes, as 8-bit cameras fill 16-bit fields.
std::uint16_t shade(float value) {
  return static_cast<std::uint16_t>(257 * static_cast<int>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f));
}

/// One record as layoutOf() lays it out.
void pack(const ShapePoint& point, bool withNormal, std::byte* record) {
  const std::uint16_t values[4] = {
      shade(point.colour.x), shade(point.colour.y), shade(point.colour.z),
      static_cast<std::uint16_t>(std::clamp(point.intensity, 0.0f, 1.0f) * 65535.0f + 0.5f)};
  std::memcpy(record, values, sizeof values);
  std::memcpy(record + sizeof values, &point.classification, 1);
  if (withNormal) std::memcpy(record + sizeof values + 1, &point.normal, sizeof point.normal);
}

class ShapeReader final : public PointReader {
 public:
  ShapeReader(std::shared_ptr<const Shape> shape, std::size_t stride, std::uint64_t first, std::uint64_t end)
      : shape_(std::move(shape)), stride_(stride), next_(first), end_(end) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(maxPoints, end_ - next_));
    block.positions.resize(count);
    block.attributes.resize(count * stride_);
    const ShapeExtent& extent = shape_->extent();
    const GridBox box = gridBox(extent);
    for (std::size_t done = 0; done < count;) {
      block_.assign(std::min(kBlockPoints, count - done), ShapePoint{});
      shape_->generate(next_, block_);
      for (std::size_t i = 0; i < block_.size(); ++i) {
        const glm::dvec3 steps = glm::floor(block_[i].position / kStep + 0.5);
        block.positions[done + i] = glm::clamp(steps, box.low, box.high) * kStep;
        pack(block_[i], extent.hasNormals, block.attributes.data() + (done + i) * stride_);
      }
      done += block_.size();
      next_ += block_.size();
    }
    return count > 0;
  }

 private:
  std::shared_ptr<const Shape> shape_;
  std::size_t stride_;
  std::uint64_t next_, end_;
  std::vector<ShapePoint> block_;
};

class ShapeSource final : public PointSource {
 public:
  ShapeSource(const std::string& path, const Spec& spec)
      : shape_(spec.shape->make(spec.points, spec.seed)), info_(describe(path, spec, shape_->extent())) {}

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override {
    return static_cast<std::size_t>((info_.pointCount + kPartPoints - 1) / kPartPoints);
  }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override {
    const std::uint64_t first = static_cast<std::uint64_t>(part) * kPartPoints;
    const std::uint64_t end = std::min(first + kPartPoints, info_.pointCount);
    return std::make_unique<ShapeReader>(shape_, info_.layout.stride(), std::min(first, end), end);
  }

 private:
  std::shared_ptr<const Shape> shape_;
  SourceInfo info_;
};

}  // namespace

std::unique_ptr<PointSource> openScan(const std::string& spec) {
  return std::make_unique<ShapeSource>(spec, parseSpec(spec));
}

}  // namespace strata::synthetic
