#include "io/store/column_codec.h"

#include <lz4.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/store/huffman.h"

namespace strata {
namespace {

/// Repeats may beat codes of single values when those have fewer bits than this on average.
constexpr double kTryLz4Bits = 3.0;

/// Counts in four tables, so that a run of one value does not wait for its own counter.
HuffmanCode::Histogram histogramOf(std::span<const std::uint8_t> values) {
  std::array<HuffmanCode::Histogram, 4> part{};
  std::size_t i = 0;
  for (; i + 4 <= values.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) ++part[k][values[i + k]];
  for (; i < values.size(); ++i) ++part[0][values[i]];
  for (std::size_t s = 0; s < 256; ++s) part[0][s] += part[1][s] + part[2][s] + part[3][s];
  return part[0];
}

void putHead(ColumnMode mode, std::size_t bytes, std::byte* to) {
  const auto head = static_cast<std::uint32_t>(mode) | static_cast<std::uint32_t>(bytes) << 8;
  std::memcpy(to, &head, kColumnHeadBytes);
}

/// Appends the LZ4 block if it takes less than `limit` bytes.
bool appendLz4(std::span<const std::uint8_t> values, std::size_t limit, std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.resize(start + limit);
  const int packed =
      LZ4_compress_default(reinterpret_cast<const char*>(values.data()), reinterpret_cast<char*>(out.data() + start),
                           static_cast<int>(values.size()), static_cast<int>(limit) - 1);
  out.resize(start + static_cast<std::size_t>(packed));
  return packed > 0;
}

}  // namespace

void appendColumn(std::span<const std::uint8_t> values, std::vector<std::byte>& out) {
  const std::size_t start = out.size();
  out.resize(start + kColumnHeadBytes);
  const auto finish = [&](ColumnMode mode) {
    putHead(mode, out.size() - start - kColumnHeadBytes, out.data() + start);
  };
  if (values.empty() || std::memcmp(values.data(), values.data() + 1, values.size() - 1) == 0) {
    out.push_back(values.empty() ? std::byte{0} : static_cast<std::byte>(values[0]));
    return finish(ColumnMode::constant);
  }
  const HuffmanCode code(histogramOf(values));
  const std::size_t best = std::min(code.storedBytes(), values.size());
  if (static_cast<double>(best) * 8 < kTryLz4Bits * static_cast<double>(values.size()) && appendLz4(values, best, out))
    return finish(ColumnMode::lz4);
  if (code.storedBytes() < values.size()) {
    code.append(values, out);
    return finish(ColumnMode::huffman);
  }
  const auto bytes = std::as_bytes(values);
  out.insert(out.end(), bytes.begin(), bytes.end());
  finish(ColumnMode::raw);
}

bool takeColumn(std::span<const std::byte>& stored, std::span<std::uint8_t> out) {
  if (stored.size() < kColumnHeadBytes) return false;
  std::uint32_t head;
  std::memcpy(&head, stored.data(), sizeof head);
  const std::size_t bytes = head >> 8;
  if (bytes > stored.size() - kColumnHeadBytes) return false;
  const std::span<const std::byte> body = stored.subspan(kColumnHeadBytes, bytes);
  stored = stored.subspan(kColumnHeadBytes + bytes);
  switch (static_cast<ColumnMode>(head & 255)) {
    case ColumnMode::constant:
      if (bytes != 1) return false;
      std::fill(out.begin(), out.end(), static_cast<std::uint8_t>(body[0]));
      return true;
    case ColumnMode::raw:
      if (bytes != out.size()) return false;
      if (bytes > 0) std::memcpy(out.data(), body.data(), bytes);
      return true;
    case ColumnMode::huffman:
      return decodeHuffman(body, out);
    case ColumnMode::lz4:
      return LZ4_decompress_safe(reinterpret_cast<const char*>(body.data()), reinterpret_cast<char*>(out.data()),
                                 static_cast<int>(bytes), static_cast<int>(out.size())) == static_cast<int>(out.size());
  }
  return false;
}

double entropyBits(std::span<const std::uint8_t> values) {
  if (values.empty()) return 0.0;
  const HuffmanCode::Histogram counts = histogramOf(values);
  const auto total = static_cast<double>(values.size());
  double bits = 0.0;
  for (const std::uint32_t count : counts)
    if (count > 0) bits += count * std::log2(total / count);
  return bits;
}

}  // namespace strata
