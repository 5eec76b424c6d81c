#include "io/huffman.h"

#include <algorithm>
#include <cstring>

namespace strata {
namespace {

constexpr int kMostBits = HuffmanCode::kMostBits;
constexpr std::size_t kTableSize = std::size_t{1} << kMostBits;
constexpr std::size_t kStreams = 4;
/// Values that a stream gives between two refills: a refill leaves at least 56 bits.
constexpr std::size_t kValuesARefill = 5;

/// Lengths of an optimal code without a limit, by joining the two rarest again and again; 0 for what does not occur.
int unlimitedLengths(const HuffmanCode::Histogram& counts, std::array<std::uint8_t, 256>& lengths) {
  struct Node {
    std::uint64_t count;
    int parent;
  };
  std::array<Node, 511> nodes;
  std::array<std::uint8_t, 256> symbols;
  int leaves = 0;
  for (int s = 0; s < 256; ++s)
    if (counts[static_cast<std::size_t>(s)] > 0)
      symbols[static_cast<std::size_t>(leaves++)] = static_cast<std::uint8_t>(s);
  std::sort(symbols.begin(), symbols.begin() + leaves,
            [&](std::uint8_t a, std::uint8_t b) { return counts[a] != counts[b] ? counts[a] < counts[b] : a < b; });
  for (int i = 0; i < leaves; ++i)
    nodes[static_cast<std::size_t>(i)] = {counts[symbols[static_cast<std::size_t>(i)]], 0};
  // Leaves ascend, and so do the joined nodes: the rarest is always at the head of one of the two queues.
  int leaf = 0, joined = leaves;
  const int root = 2 * leaves - 2;
  for (int next = leaves; next <= root; ++next) {
    const auto rarest = [&] {
      const bool takeLeaf = leaf < leaves && (joined >= next || nodes[static_cast<std::size_t>(leaf)].count <=
                                                                    nodes[static_cast<std::size_t>(joined)].count);
      return static_cast<std::size_t>(takeLeaf ? leaf++ : joined++);
    };
    const std::size_t a = rarest(), b = rarest();
    nodes[static_cast<std::size_t>(next)] = {nodes[a].count + nodes[b].count, 0};
    nodes[a].parent = nodes[b].parent = next;
  }
  std::array<std::uint8_t, 511> depth{};
  int longest = 0;
  for (int i = root - 1; i >= 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    depth[at] = static_cast<std::uint8_t>(depth[static_cast<std::size_t>(nodes[at].parent)] + 1);
    if (i < leaves) {
      lengths[symbols[at]] = depth[at];
      longest = std::max<int>(longest, depth[at]);
    }
  }
  return longest;
}

unsigned reversed(unsigned code, int bits) {
  unsigned out = 0;
  for (int i = 0; i < bits; ++i) out |= (code >> i & 1u) << (bits - 1 - i);
  return out;
}

/// Canonical codes in the order of length, then symbol.
template <class Visit>
void visitCodes(const std::array<std::uint8_t, 256>& lengths, Visit&& visit) {
  unsigned code = 0;
  for (int bits = 1; bits <= kMostBits; ++bits, code <<= 1)
    for (std::size_t s = 0; s < 256; ++s)
      if (lengths[s] == bits) visit(s, bits, reversed(code++, bits));
}

struct Entry {
  std::uint8_t symbol, bits;
};
using Table = std::array<Entry, kTableSize>;

/// False unless the lengths make a complete code.
bool makeTable(const std::array<std::uint8_t, 256>& lengths, Table& table) {
  std::size_t room = kTableSize;
  for (const std::uint8_t bits : lengths) {
    if (bits > kMostBits) return false;
    if (bits == 0) continue;
    if (room < kTableSize >> bits) return false;
    room -= kTableSize >> bits;
  }
  if (room != 0) return false;
  visitCodes(lengths, [&](std::size_t symbol, int bits, unsigned code) {
    for (std::size_t at = code; at < kTableSize; at += std::size_t{1} << bits)
      table[at] = {static_cast<std::uint8_t>(symbol), static_cast<std::uint8_t>(bits)};
  });
  return true;
}

/// One bit stream, read from the least significant bit up; zeros behind its end, which `overrun` tells.
class Stream {
 public:
  Stream(const std::byte* data, std::size_t bytes) : at_(data), end_(data + bytes) {}
  bool canRefillFast() const { return end_ - at_ >= 8; }
  void refillFast() {
    std::uint64_t word;
    std::memcpy(&word, at_, sizeof word);
    window_ |= word << bits_;
    const int bytes = (63 - bits_) >> 3;
    at_ += bytes;
    bits_ += 8 * bytes;
  }
  void refill() {
    while (bits_ <= 56 && at_ != end_) {
      window_ |= static_cast<std::uint64_t>(*at_++) << bits_;
      bits_ += 8;
    }
  }
  std::uint8_t next(const Table& table) {
    const Entry entry = table[window_ & (kTableSize - 1)];
    window_ >>= entry.bits;
    bits_ -= entry.bits;
    return entry.symbol;
  }
  bool overrun() const { return bits_ < 0; }

 private:
  const std::byte* at_;
  const std::byte* end_;
  std::uint64_t window_ = 0;
  int bits_ = 0;  ///< in the window; bits above them may be set too, and are the same that the next refill brings
};

}  // namespace

HuffmanCode::HuffmanCode(const Histogram& counts) {
  Histogram scaled = counts;
  while (unlimitedLengths(scaled, lengths_) > kMostBits)
    for (std::uint32_t& count : scaled) count = count > 0 ? (count >> 1 | 1u) : 0;  // flatter, until it fits
  assignCodes();
  for (std::size_t s = 0; s < 256; ++s) {
    payloadBits_ += std::size_t{counts[s]} * lengths_[s];
    if (lengths_[s] > 0) last_ = static_cast<std::uint8_t>(s);
  }
}

void HuffmanCode::assignCodes() {
  visitCodes(lengths_,
             [&](std::size_t symbol, int, unsigned code) { codes_[symbol] = static_cast<std::uint16_t>(code); });
}

void HuffmanCode::append(std::span<const std::uint8_t> values, std::vector<std::byte>& out) const {
  const std::size_t start = out.size();
  out.resize(start + headBytes() + (payloadBits_ + 7) / 8 + kStreams * 9);
  std::byte* to = out.data() + start;
  *to++ = static_cast<std::byte>(last_);
  for (std::size_t s = 0; s <= last_; s += 2)
    *to++ = static_cast<std::byte>(lengths_[s] | (s + 1 < 256 ? lengths_[s + 1] << 4 : 0));
  std::byte* sizes = to;
  to += 12;
  for (std::size_t stream = 0; stream < kStreams; ++stream) {
    std::byte* const begin = to;
    std::uint64_t window = 0;
    int bits = 0;
    const auto put = [&](std::uint8_t value) {
      window |= static_cast<std::uint64_t>(codes_[value]) << bits;
      bits += lengths_[value];
    };
    const auto spill = [&] {
      std::memcpy(to, &window, sizeof window);
      to += bits >> 3;
      window >>= bits & ~7;
      bits &= 7;
    };
    std::size_t i = stream;
    for (; i + 4 * kStreams < values.size(); i += 5 * kStreams) {
      for (std::size_t k = 0; k < 5; ++k) put(values[i + k * kStreams]);
      spill();
    }
    for (; i < values.size(); i += kStreams) {
      put(values[i]);
      spill();
    }
    if (bits > 0) *to++ = static_cast<std::byte>(window);
    const auto bytes = static_cast<std::uint32_t>(to - begin);
    if (stream + 1 < kStreams) std::memcpy(sizes + 4 * stream, &bytes, 4);
  }
  out.resize(static_cast<std::size_t>(to - out.data()));
}

bool decodeHuffman(std::span<const std::byte> stored, std::span<std::uint8_t> out) {
  if (stored.empty()) return false;
  const std::size_t symbols = static_cast<std::size_t>(stored[0]) + 1;
  const std::size_t lengthBytes = (symbols + 1) / 2;
  if (stored.size() < 1 + lengthBytes + 12) return false;
  std::array<std::uint8_t, 256> lengths{};
  for (std::size_t s = 0; s < symbols; ++s)
    lengths[s] = static_cast<std::uint8_t>(static_cast<unsigned>(stored[1 + s / 2]) >> (s % 2 * 4) & 15u);
  Table table;
  if (!makeTable(lengths, table)) return false;
  std::uint32_t sizes[3];
  std::memcpy(sizes, stored.data() + 1 + lengthBytes, sizeof sizes);
  std::span<const std::byte> rest = stored.subspan(1 + lengthBytes + 12);
  const auto take = [&](std::size_t bytes) {
    const std::byte* data = rest.data();
    rest = rest.subspan(bytes);
    return Stream(data, bytes);
  };
  if (std::uint64_t{sizes[0]} + sizes[1] + sizes[2] > rest.size()) return false;
  Stream a = take(sizes[0]), b = take(sizes[1]), c = take(sizes[2]), d = take(rest.size());

  std::size_t i = 0;
  std::uint8_t* const to = out.data();
  while (i + kStreams * kValuesARefill <= out.size() && a.canRefillFast() && b.canRefillFast() && c.canRefillFast() &&
         d.canRefillFast()) {
    a.refillFast();
    b.refillFast();
    c.refillFast();
    d.refillFast();
    for (std::size_t k = 0; k < kValuesARefill; ++k, i += kStreams) {
      to[i] = a.next(table);
      to[i + 1] = b.next(table);
      to[i + 2] = c.next(table);
      to[i + 3] = d.next(table);
    }
  }
  for (Stream* stream : {&a, &b, &c, &d}) stream->refill();
  Stream* const streams[kStreams] = {&a, &b, &c, &d};
  for (; i < out.size(); ++i) {
    Stream& stream = *streams[i % kStreams];
    stream.refill();
    to[i] = stream.next(table);
    if (stream.overrun()) return false;
  }
  return true;
}

}  // namespace strata
