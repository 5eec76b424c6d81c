#include "io/store/attribute_codec.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "io/store/column_codec.h"

namespace strata {
namespace {

enum Transform : std::uint8_t { kValues = 0, kDifferences = 1 };
/// The transform is chosen by the entropy of this many values from the middle.
constexpr std::size_t kSampleValues = 2048;

template <class T>
T folded(T difference) {
  constexpr int kSign = std::numeric_limits<T>::digits - 1;
  return static_cast<T>(static_cast<T>(difference << 1) ^ static_cast<T>(-static_cast<T>(difference >> kSign)));
}
template <class T>
T unfolded(T value) {
  return static_cast<T>(static_cast<T>(value >> 1) ^ static_cast<T>(-static_cast<T>(value & 1)));
}

/// Splits the values from `begin` to `end` into bytes: byte b of value i goes to out[b * (end - begin) + i - begin].
template <class T>
void splitBytes(const ComponentSource& source, std::size_t begin, std::size_t end, Transform transform,
                std::uint8_t* out) {
  const std::size_t count = end - begin;
  const auto value = [&](std::size_t i) {
    T v;
    std::memcpy(&v, source.first + (source.order.empty() ? i : source.order[i]) * source.stride, sizeof v);
    return v;
  };
  T before = begin > 0 ? value(begin - 1) : T{0};
  for (std::size_t i = 0; i < count; ++i) {
    const T now = value(begin + i);
    const T shown = transform == kDifferences ? folded(static_cast<T>(now - before)) : now;
    before = now;
    for (std::size_t b = 0; b < sizeof(T); ++b) out[b * count + i] = static_cast<std::uint8_t>(shown >> (8 * b));
  }
}

template <class T>
double sampleBits(const ComponentSource& source, std::size_t count, Transform transform,
                  std::vector<std::uint8_t>& spare) {
  const std::size_t sample = std::min(count, kSampleValues), begin = (count - sample) / 2;
  splitBytes<T>(source, begin, begin + sample, transform, spare.data());
  double bits = 0.0;
  for (std::size_t b = 0; b < sizeof(T); ++b) bits += entropyBits(std::span(spare).subspan(b * sample, sample));
  return bits;
}

template <class T>
void append(const ComponentSource& source, std::size_t count, std::vector<std::uint8_t>& spare,
            std::vector<std::byte>& out) {
  spare.resize(count * sizeof(T));
  const Transform transform =
      sampleBits<T>(source, count, kDifferences, spare) < sampleBits<T>(source, count, kValues, spare) ? kDifferences
                                                                                                       : kValues;
  splitBytes<T>(source, 0, count, transform, spare.data());
  out.push_back(static_cast<std::byte>(transform));
  for (std::size_t b = 0; b < sizeof(T); ++b) appendColumn(std::span(spare).subspan(b * count, count), out);
}

}  // namespace

void appendComponent(const ComponentSource& source, std::size_t count, std::vector<std::uint8_t>& spare,
                     std::vector<std::byte>& out) {
  switch (source.width) {
    case 1:
      return append<std::uint8_t>(source, count, spare, out);
    case 2:
      return append<std::uint16_t>(source, count, spare, out);
    case 4:
      return append<std::uint32_t>(source, count, spare, out);
    default:
      return append<std::uint64_t>(source, count, spare, out);
  }
}

template <class T>
bool ComponentDecoder<T>::open(std::span<const std::byte>& stored, std::size_t count,
                               std::vector<std::uint8_t>& spare) {
  if (stored.empty() || static_cast<unsigned>(stored[0]) > kDifferences) return false;
  differences_ = static_cast<Transform>(stored[0]) == kDifferences;
  before_ = 0;
  stored = stored.subspan(1);
  spare.resize(count * sizeof(T));
  for (std::size_t b = 0; b < sizeof(T); ++b) {
    column_[b] = spare.data() + b * count;
    if (!takeColumn(stored, std::span(spare).subspan(b * count, count))) return false;
  }
  return true;
}

template <class T>
void ComponentDecoder<T>::read(std::span<T> out) {
  if constexpr (sizeof(T) == 1) {
    std::copy_n(column_[0], out.size(), out.data());
  } else {
    for (std::size_t i = 0; i < out.size(); ++i) {
      T value = 0;
      for (std::size_t b = 0; b < sizeof(T); ++b)
        value = static_cast<T>(value | static_cast<T>(static_cast<T>(column_[b][i]) << (8 * b)));
      out[i] = value;
    }
  }
  for (const std::uint8_t*& column : column_) column += out.size();
  if (!differences_) return;
  for (T& value : out) value = unfolded(value);
  T before = before_;
  for (T& value : out) value = before = static_cast<T>(before + value);
  before_ = before;
}

template class ComponentDecoder<std::uint8_t>;
template class ComponentDecoder<std::uint16_t>;
template class ComponentDecoder<std::uint32_t>;
template class ComponentDecoder<std::uint64_t>;

}  // namespace strata
