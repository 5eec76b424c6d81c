#include "io/las/laz_integers.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"

namespace strata {
namespace {

constexpr std::uint32_t kShortestLength = 1u << 24;  // shortest interval of the coder
constexpr unsigned kSymbolShift = 15, kBitShift = 13;
constexpr unsigned kHighBits = 8;  // of a long corrector are coded by a model, the lower ones as they are
constexpr unsigned kIntegerBits = 32;

}  // namespace

/// Adaptive frequencies of a small alphabet.
struct LazIntegers::SymbolModel {
  explicit SymbolModel(std::uint32_t symbols) : counts(symbols, 1), starts(symbols), cycle(symbols) {
    update();
    cycle = untilUpdate = (symbols + 6) >> 1;
  }

  void update() {
    total += cycle;
    if (total > 1u << kSymbolShift) {
      total = 0;
      for (std::uint32_t& count : counts) total += count = (count + 1) >> 1;
    }
    const std::uint32_t scale = 0x80000000u / total;
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      starts[i] = (scale * sum) >> (31 - kSymbolShift);
      sum += counts[i];
    }
    cycle = std::min((5 * cycle) >> 2, (static_cast<std::uint32_t>(counts.size()) + 6) << 3);
    untilUpdate = cycle;
  }

  std::vector<std::uint32_t> counts, starts;
  std::uint32_t total = 0, cycle, untilUpdate = 0;
};

struct LazIntegers::Models {
  Models() {
    for (unsigned bits = 1; bits <= kIntegerBits; ++bits) correctors.emplace_back(1u << std::min(bits, kHighBits));
  }

  SymbolModel bitCounts[2] = {SymbolModel(kIntegerBits + 1), SymbolModel(kIntegerBits + 1)};  // one for each context
  std::vector<SymbolModel> correctors;                                                        // [bits - 1]
  // Frequencies of the corrector of zero bits, which is 0 or 1.
  std::uint32_t zeros = 1, total = 2, probability = 1u << (kBitShift - 1), cycle = 4, untilUpdate = 4;
};

LazIntegers::LazIntegers(std::string file, std::span<const std::byte> bytes)
    : file_(std::move(file)), bytes_(bytes), models_(std::make_unique<Models>()) {
  for (int i = 0; i < 4; ++i) value_ = value_ << 8 | byte();
}

LazIntegers::~LazIntegers() = default;

std::uint32_t LazIntegers::byte() {
  if (at_ == bytes_.size())
    throw Error(file_,
                "the chunk table is cut short, found " + std::to_string(bytes_.size()) + " bytes (expected more)");
  return static_cast<std::uint32_t>(bytes_[at_++]);
}

void LazIntegers::refill() {
  while (length_ < kShortestLength) {
    value_ = value_ << 8 | byte();
    length_ <<= 8;
  }
}

std::uint32_t LazIntegers::symbol(SymbolModel& model) {
  const std::uint32_t whole = length_;
  length_ >>= kSymbolShift;
  const auto above = std::upper_bound(model.starts.begin(), model.starts.end(), value_ / length_);
  const auto found = static_cast<std::size_t>(above - model.starts.begin()) - 1;
  const std::uint32_t start = model.starts[found] * length_;
  const std::uint32_t end = above == model.starts.end() ? whole : *above * length_;
  value_ -= start;
  length_ = end - start;
  if (value_ >= length_) throw Error(file_, "the chunk table is damaged, found no symbol (expected one)");
  refill();
  ++model.counts[found];
  if (--model.untilUpdate == 0) model.update();
  return static_cast<std::uint32_t>(found);
}

std::uint32_t LazIntegers::bit() {
  Models& m = *models_;
  const std::uint32_t split = m.probability * (length_ >> kBitShift);
  const bool one = value_ >= split;
  if (one) {
    value_ -= split;
    length_ -= split;
  } else {
    length_ = split;
    ++m.zeros;
  }
  refill();
  if (--m.untilUpdate == 0) {
    m.total += m.cycle;
    if (m.total > 1u << kBitShift) {
      m.total = (m.total + 1) >> 1;
      m.zeros = (m.zeros + 1) >> 1;
      if (m.zeros == m.total) ++m.total;
    }
    m.probability = (m.zeros * (0x80000000u / m.total)) >> (31 - kBitShift);
    m.cycle = std::min((5 * m.cycle) >> 2, 64u);
    m.untilUpdate = m.cycle;
  }
  return one ? 1 : 0;
}

std::uint32_t LazIntegers::bits(unsigned count) {
  if (count > 19) {
    const std::uint32_t low = bits(16);
    return bits(count - 16) << 16 | low;
  }
  length_ >>= count;
  const std::uint32_t found = value_ / length_;
  if (found >> count != 0) throw Error(file_, "the chunk table is damaged, found no bits (expected some)");
  value_ -= length_ * found;
  refill();
  return found;
}

std::uint32_t LazIntegers::next(std::uint32_t predicted, int context) {
  const unsigned k = symbol(models_->bitCounts[context]);
  if (k == 0) return predicted + bit();
  if (k == kIntegerBits) return predicted + 0x80000000u;
  std::uint32_t corrector = symbol(models_->correctors[k - 1]);
  if (k > kHighBits) {
    const unsigned low = k - kHighBits;
    corrector = corrector << low | bits(low);
  }
  // Correctors of k bits mean [1 - 2^k, -2^(k-1)] and [2^(k-1) + 1, 2^k].
  if (corrector >= 1u << (k - 1)) return predicted + corrector + 1;
  return predicted + corrector - ((1u << k) - 1);
}

}  // namespace strata
