#include "io/store/huffman.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/instruction_sets.h"

namespace strata {
namespace {

constexpr int kMostBits = HuffmanCode::kMostBits;
constexpr std::size_t kTableSize = std::size_t{1} << kMostBits;
constexpr std::size_t kStreams = 4;
/// Look-ups of a stream between two refills; a refill leaves at least 56 bits.
constexpr int kLookUps = 5;

/// The lengths of an optimal code without a limit, found by joining the two rarest again and again. Symbols that do not
/// occur have 0.
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
  // Both queues are sorted, leaves and joined nodes alike, so the rarest is always at the head of one of them.
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
  code = (code & 0x5555u) << 1 | (code >> 1 & 0x5555u);
  code = (code & 0x3333u) << 2 | (code >> 2 & 0x3333u);
  code = (code & 0x0f0fu) << 4 | (code >> 4 & 0x0f0fu);
  code = (code & 0x00ffu) << 8 | (code >> 8 & 0x00ffu);
  return code >> (16 - bits);
}

/// Visits the canonical codes in the order of their symbols. Codes of one length ascend, and come after all shorter
/// ones.
template <class Visit>
void visitCodes(const std::array<std::uint8_t, 256>& lengths, Visit&& visit) {
  std::array<unsigned, kMostBits + 2> next{};
  for (const std::uint8_t bits : lengths) ++next[bits + 1u];
  next[0] = next[1] = 0;  // symbols without a code
  for (std::size_t bits = 1; bits < next.size(); ++bits) next[bits] = (next[bits] + next[bits - 1]) << 1;
  for (std::size_t s = 0; s < 256; ++s)
    if (lengths[s] > 0) visit(s, lengths[s], reversed(next[lengths[s]]++, lengths[s]));
}

/// The values that 11 bits of a stream begin with: one, or two when both codes lie within.
struct Lookup {
  std::uint16_t values;  ///< the first in the lower byte
  std::uint8_t bits;     ///< of all codes together
  std::uint8_t count;
};
static_assert(sizeof(Lookup) == 4);
struct Table {
  std::array<Lookup, kTableSize> entries;
  std::array<std::uint8_t, 256> lengths;
};

/// For columns of fewer values, looking for pairs takes more time than it saves.
constexpr std::size_t kLeastForPairs = 4096;

/// False unless the lengths make a complete code.
bool makeTable(bool withPairs, Table& table) {
  std::size_t room = kTableSize;
  for (const std::uint8_t bits : table.lengths) {
    if (bits > kMostBits) return false;
    if (bits == 0) continue;
    if (room < kTableSize >> bits) return false;
    room -= kTableSize >> bits;
  }
  if (room != 0) return false;
  const auto put = [&table](std::size_t at,
                            std::uint32_t entry) {  // as one word, since reading one soon after would wait for halves
    std::memcpy(&table.entries[at], &entry, sizeof entry);
  };
  visitCodes(table.lengths, [&](std::size_t symbol, int bits, unsigned code) {
    const auto entry = static_cast<std::uint32_t>(symbol) | static_cast<std::uint32_t>(bits) << 16 | 1u << 24;
    for (std::size_t at = code; at < kTableSize; at += std::size_t{1} << bits) put(at, entry);
  });
  if (!withPairs) return true;
  // From the top down, since the bits that are left are a smaller number, whose entry must still be that of one value.
  for (std::size_t at = kTableSize; at-- > 1;) {
    std::uint32_t first, second;
    std::memcpy(&first, &table.entries[at], sizeof first);
    std::memcpy(&second, &table.entries[at >> table.entries[at].bits], sizeof second);
    const std::uint32_t pair = first + (second & 0xffff0000u) + (second << 8 & 0xff00u);
    put(at, (pair >> 16 & 255u) <= kMostBits ? pair : first);
  }
  return true;
}

/// One bit stream, read from the least significant bit up. A 1 follows the last bit in `window_`, so the zeros above it
/// count the bits used of the word at `at_`.
class Stream {
 public:
  Stream(const std::byte* data, std::size_t bytes) : at_(data), end_(data + bytes) {}

  /// The next `values` values are written to `to`.
  void setTarget(std::uint8_t* to, std::size_t values) {
    to_ = to;
    toEnd_ = to + values;
  }
  /// How often the stream can be refilled and looked up kLookUps times before its ends must be checked.
  std::size_t rounds() const {
    constexpr std::ptrdiff_t kMostValues = 2 * kLookUps;
    const std::ptrdiff_t bytes = std::max<std::ptrdiff_t>(end_ - at_ - 8, 0);
    return static_cast<std::size_t>(std::min(bytes / 8, (toEnd_ - to_) / kMostValues));
  }
  void refill() {
    const int used = std::countl_zero(window_);
    at_ += used >> 3;
    std::uint64_t word;
    std::memcpy(&word, at_, sizeof word);
    window_ = (word | kTop) >> (used & 7);
  }
  void next(const Table& table) {
    const Lookup& entry = table.entries[window_ & (kTableSize - 1)];
    const std::uint8_t count = entry.count;
    window_ >>= entry.bits;
    std::memcpy(to_, &entry.values, sizeof entry.values);
    to_ += count;
  }
  /// Fills the rest of the target. False when the bits end too early.
  bool finish(const Table& table) {
    for (std::size_t i = rounds(); i > 0; i = i > 1 ? i - 1 : rounds()) {
      refill();
      for (int k = 0; k < kLookUps; ++k) next(table);
    }
    auto bit = static_cast<std::size_t>(std::countl_zero(window_));
    const auto bytes = static_cast<std::size_t>(end_ - at_);
    for (; to_ != toEnd_; ++to_) {
      unsigned word = 0;
      for (std::size_t k = 0; k < 3 && bit / 8 + k < bytes; ++k)
        word |= static_cast<unsigned>(at_[bit / 8 + k]) << (8 * k);
      *to_ = static_cast<std::uint8_t>(table.entries[word >> (bit & 7) & (kTableSize - 1)].values);
      bit += table.lengths[*to_];
      if (bit > 8 * bytes) return false;
    }
    at_ += bit / 8;
    window_ = kTop >> (bit & 7);
    return true;
  }

 private:
  static constexpr std::uint64_t kTop = std::uint64_t{1} << 63;

  const std::byte* at_;
  const std::byte* end_;
  std::uint8_t* to_ = nullptr;
  std::uint8_t* toEnd_ = nullptr;
  std::uint64_t window_ = kTop;
};
using Streams = std::array<Stream, kStreams>;

/// Decodes all streams side by side, four chains of look-ups at once, until one of them comes near its end.
inline __attribute__((always_inline)) void advanceTogether(const Table& table, Streams& streams) {
  Stream a = streams[0], b = streams[1], c = streams[2], d = streams[3];
  while (const std::size_t rounds = std::min({a.rounds(), b.rounds(), c.rounds(), d.rounds()}))
    for (std::size_t i = 0; i < rounds; ++i) {
      for (Stream* stream : {&a, &b, &c, &d}) stream->refill();
      for (int k = 0; k < kLookUps; ++k)
        for (Stream* stream : {&a, &b, &c, &d}) stream->next(table);
    }
  streams = {a, b, c, d};
}
void advancePlain(const Table& table, Streams& streams) { advanceTogether(table, streams); }
STRATA_TARGET_BMI2 void advanceBmi2(const Table& table, Streams& streams) { advanceTogether(table, streams); }

/// Interleaves the streams, which are `room` values apart in `from`: their values i go to 4 i to 4 i + 3.
void joinStreams(const std::uint8_t* from, std::size_t room, std::size_t values, std::uint8_t* to) {
  const std::uint8_t *const a = from, *const b = a + room, *const c = b + room, *const d = c + room;
  for (std::size_t i = 0; i < values / kStreams; ++i) {
    to[kStreams * i] = a[i];
    to[kStreams * i + 1] = b[i];
    to[kStreams * i + 2] = c[i];
    to[kStreams * i + 3] = d[i];
  }
  for (std::size_t i = values / kStreams * kStreams; i < values; ++i) to[i] = from[i % kStreams * room + i / kStreams];
}

}  // namespace

HuffmanCode::HuffmanCode(const Histogram& counts) {
  Histogram scaled = counts;
  while (unlimitedLengths(scaled, lengths_) > kMostBits)
    for (std::uint32_t& count : scaled)
      count = count > 0 ? (count >> 1 | 1u) : 0;  // flatten the counts until the code fits
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
  Table table;
  table.lengths.fill(0);
  for (std::size_t s = 0; s < symbols; ++s)
    table.lengths[s] = static_cast<std::uint8_t>(static_cast<unsigned>(stored[1 + s / 2]) >> (s % 2 * 4) & 15u);
  if (!makeTable(out.size() >= kLeastForPairs, table)) return false;
  std::uint32_t sizes[3];
  std::memcpy(sizes, stored.data() + 1 + lengthBytes, sizeof sizes);
  std::span<const std::byte> rest = stored.subspan(1 + lengthBytes + 12);
  if (std::uint64_t{sizes[0]} + sizes[1] + sizes[2] > rest.size()) return false;
  Streams streams{Stream(rest.data(), sizes[0]), Stream(rest.data() + sizes[0], sizes[1]),
                  Stream(rest.data() + sizes[0] + sizes[1], sizes[2]),
                  Stream(rest.data() + sizes[0] + sizes[1] + sizes[2], rest.size() - sizes[0] - sizes[1] - sizes[2])};
  // The streams are decoded apart first, since they advance by one or two values at a time.
  constexpr std::size_t kRoom = 4096;
  std::uint8_t apart[kStreams * kRoom];
  for (std::size_t first = 0; first < out.size(); first += kStreams * kRoom) {
    const std::size_t values = std::min(out.size() - first, kStreams * kRoom);
    for (std::size_t k = 0; k < kStreams; ++k)
      streams[k].setTarget(apart + k * kRoom, (values + kStreams - 1 - k) / kStreams);
    if (hasBmi2())
      advanceBmi2(table, streams);
    else
      advancePlain(table, streams);
    for (Stream& stream : streams)
      if (!stream.finish(table)) return false;
    joinStreams(apart, kRoom, values, out.data() + first);
  }
  return true;
}

}  // namespace strata
