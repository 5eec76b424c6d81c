#include "converter/survey/sampled_source.h"

#include <algorithm>

namespace strata {
namespace {

constexpr std::uint64_t kMostSampledParts = 32;

/// The first points of a part.
class PrefixReader final : public PointReader {
 public:
  PrefixReader(std::unique_ptr<PointReader> reader, std::uint64_t points) : reader_(std::move(reader)), left_(points) {}
  bool read(PointBlock& block, std::size_t maxPoints) override {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(maxPoints, left_));
    if (wanted == 0 || !reader_->read(block, wanted)) return false;
    left_ -= block.count();
    return true;
  }

 private:
  std::unique_ptr<PointReader> reader_;
  std::uint64_t left_;
};

class SampledSource final : public PointSource {
 public:
  SampledSource(const PointSource& whole, std::vector<std::size_t> parts, std::uint64_t pointsOfPart)
      : whole_(whole), parts_(std::move(parts)), pointsOfPart_(pointsOfPart), info_(whole.info()) {
    const std::uint64_t before = info_.pointCount;
    info_.pointCount = std::min<std::uint64_t>(before, parts_.size() * pointsOfPart);
    const double share =
        static_cast<double>(info_.pointCount) / static_cast<double>(std::max<std::uint64_t>(before, 1));
    info_.fileBytes = static_cast<std::uint64_t>(share * static_cast<double>(info_.fileBytes));
  }
  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override { return parts_.size(); }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override {
    return std::make_unique<PrefixReader>(whole_.openPart(parts_[part]), pointsOfPart_);
  }
  std::unique_ptr<PointReader> openIntegers(std::size_t part) const override {
    return std::make_unique<PrefixReader>(whole_.openIntegers(parts_[part]), pointsOfPart_);
  }

 private:
  const PointSource& whole_;
  const std::vector<std::size_t> parts_;
  const std::uint64_t pointsOfPart_;
  SourceInfo info_;
};

}  // namespace

Sources sampleSources(const Sources& sources, std::uint64_t points) {
  std::uint64_t total = 0, parts = 0;
  for (const auto& source : sources) {
    total += source->info().pointCount;
    parts += source->info().pointCount > 0 ? source->partCount() : 0;
  }
  Sources sampled;
  if (parts == 0) return sampled;
  // Small parts: as many as have the points wanted. Large parts: few, so that little is opened and sought.
  const std::uint64_t ofPart = std::max<std::uint64_t>(1, total / parts);
  const std::uint64_t chosen =
      points >= total ? parts
                      : std::min(parts, std::max<std::uint64_t>(kMostSampledParts, (points + ofPart - 1) / ofPart));
  const std::uint64_t limit = points >= total ? total : std::max<std::uint64_t>(1, points / chosen);
  std::uint64_t before = 0;
  for (const auto& source : sources) {
    if (source->info().pointCount == 0) continue;
    std::vector<std::size_t> mine;
    for (std::size_t part = 0; part < source->partCount(); ++part, ++before)
      if (before * chosen / parts != (before + 1) * chosen / parts) mine.push_back(part);
    if (!mine.empty()) sampled.push_back(std::make_unique<SampledSource>(*source, std::move(mine), limit));
  }
  return sampled;
}

}  // namespace strata
