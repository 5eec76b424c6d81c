#include "io/table/text_lines.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

#include "core/error.h"
#include "core/text.h"

namespace strata {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }
bool isSeparator(char c) { return c == ',' || c == ';'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

template <typename T>
bool parse(std::string_view token, T& value) {
  if (token.starts_with('+')) token.remove_prefix(1);
  return parseWhole(token, value);
}

template <typename T>
bool storeInteger(std::string_view token, std::byte* out) {
  T value = 0;
  if (!parse(token, value)) {
    double number = 0.0;
    if (!parse(token, number) || number != std::floor(number)) return false;
    if (!(number >= static_cast<double>(std::numeric_limits<T>::min())) ||
        !(number < std::ldexp(1.0, std::numeric_limits<T>::digits)))
      return false;
    value = static_cast<T>(number);
  }
  std::memcpy(out, &value, sizeof value);
  return true;
}

template <typename T>
bool storeFloat(std::string_view token, std::byte* out) {
  T value = 0;
  if (!parse(token, value)) {
    double wide = 0.0;  // numbers beyond the range of float32 become 0 or infinite
    if (!parse(token, wide)) return false;
    value = static_cast<T>(wide);
  }
  std::memcpy(out, &value, sizeof value);
  return true;
}

}  // namespace

bool LineReader::fill() {
  const std::size_t kept = buffer_.size() - at_;
  if (kept > kLongestLine)
    throw Error(bytes_.name(), "a line of more than " + std::to_string(kLongestLine) + " bytes: this is no text scan");
  std::move(buffer_.begin() + static_cast<std::ptrdiff_t>(at_), buffer_.end(), buffer_.begin());
  at_ = 0;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(kBlockBytes, end_ - next_));
  buffer_.resize(kept + wanted);
  bytes_.read(next_, std::as_writable_bytes(std::span(buffer_).subspan(kept)));
  next_ += wanted;
  return wanted > 0;
}

bool LineReader::next(std::string_view& line) {
  std::size_t searched = 0;
  while (true) {
    const std::size_t left = buffer_.size() - at_;
    const char* start = buffer_.data() + at_;
    const void* found = left > searched ? std::memchr(start + searched, '\n', left - searched) : nullptr;
    if (found != nullptr) {
      const auto length = static_cast<std::size_t>(static_cast<const char*>(found) - start);
      line = {start, length};
      at_ += length + 1;
      break;
    }
    searched = left;
    if (next_ < end_ && fill()) continue;
    if (left == 0) return false;
    line = {start, left};
    at_ = buffer_.size();
    break;
  }
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++count_;
  return true;
}

void splitColumns(std::string_view line, std::vector<std::string_view>& tokens) {
  tokens.clear();
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto skipBlanks = [&] {
    while (at < end && isBlank(*at)) ++at;
  };
  skipBlanks();
  while (at < end) {
    const char* start = at;
    const char* quote = *at == '"' ? std::find(at + 1, end, '"') : end;
    if (quote != end) {
      tokens.emplace_back(start + 1, static_cast<std::size_t>(quote - start - 1));
      at = quote + 1;
    } else {
      while (at < end && !isBlank(*at) && !isSeparator(*at)) ++at;
      tokens.emplace_back(start, static_cast<std::size_t>(at - start));
    }
    skipBlanks();
    if (at < end && isSeparator(*at)) {
      ++at;
      skipBlanks();
    }
  }
}

std::string shownWord(std::string_view word) {
  constexpr std::size_t kShown = 32;
  std::string text;
  for (const char c : word.substr(0, kShown)) text += c >= ' ' && c < 127 ? c : '?';
  return text;
}

bool parseNumber(std::string_view token, double& value) { return parse(token, value); }
bool parseInteger(std::string_view token, std::int64_t& value) { return parse(token, value); }

bool storeNumber(std::string_view token, ScalarType type, std::byte* out) {
  return withScalarType(type, [&](auto zero) {
    using T = decltype(zero);
    if constexpr (std::is_floating_point_v<T>)
      return storeFloat<T>(token, out);
    else
      return storeInteger<T>(token, out);
  });
}

LineKind lineKind(std::string_view line, const TextTable& table) {
  std::size_t start = 0;
  while (start < line.size() && isBlank(line[start])) ++start;
  line.remove_prefix(start);
  if (line.empty()) return LineKind::blank;
  if (table.comments && (line.starts_with('#') || line.starts_with("//"))) return LineKind::blank;
  if (table.countLines) {
    const auto digits = static_cast<std::size_t>(std::find_if_not(line.begin(), line.end(), isDigit) - line.begin());
    if (digits > 0 && std::all_of(line.begin() + static_cast<std::ptrdiff_t>(digits), line.end(), isBlank))
      return LineKind::countLine;
  }
  return LineKind::point;
}

SkippedLines skipLines(const ByteSource& bytes, std::uint64_t begin, std::uint64_t points, std::uint64_t firstLine) {
  LineReader reader(bytes, begin, bytes.size());
  SkippedLines skipped{begin, 0, firstLine};
  std::string_view line;
  while (skipped.points < points && reader.next(line)) {
    skipped.end = reader.offset();
    ++skipped.nextLine;
    if (lineKind(line, TextTable{}) == LineKind::point) ++skipped.points;
  }
  return skipped;
}

bool pickColumns(const std::vector<std::string_view>& tokens, const TextTable& table,
                 std::vector<std::string_view>& picked) {
  picked.resize(table.columns.size());
  std::size_t at = 0;
  for (std::size_t c = 0; c < table.columns.size(); ++c, ++at) {
    if (at >= tokens.size()) return false;
    picked[c] = tokens[at];
    if (table.columns[c].kind != TextColumn::Kind::list) continue;
    std::int64_t items = 0;
    if (!parseInteger(tokens[at], items) || items < 0 || static_cast<std::uint64_t>(items) >= tokens.size() - at)
      return false;
    at += static_cast<std::size_t>(items);
    picked[c] = {};
  }
  return true;
}

bool LineParser::parse(std::string_view line) {
  splitColumns(line, tokens_);
  badColumn_ = -1;
  if (!pickColumns(tokens_, table_, picked_)) return false;
  for (std::size_t c = 0; c < picked_.size(); ++c) {
    const TextColumn& column = table_.columns[c];
    if (column.kind == TextColumn::Kind::skip || column.kind == TextColumn::Kind::list) continue;
    const Field& field = table_.fields[column.field];
    std::byte* out = record_.data() + field.offset + column.value * scalarBytes(field.type);
    const bool stored = column.kind == TextColumn::Kind::packed ? storeNumber(picked_[c], ScalarType::u32, out) ||
                                                                      storeNumber(picked_[c], ScalarType::i32, out) ||
                                                                      storeNumber(picked_[c], ScalarType::f32, out)
                                                                : storeNumber(picked_[c], field.type, out);
    if (stored) continue;
    badColumn_ = static_cast<int>(c);
    return false;
  }
  return true;
}

std::string LineParser::fault() const {
  if (badColumn_ < 0)
    return "found " + std::to_string(tokens_.size()) + " columns (expected " + std::to_string(table_.columns.size()) +
           ")";
  const auto c = static_cast<std::size_t>(badColumn_);
  const ScalarType type = table_.fields[table_.columns[c].field].type;
  const bool real = type == ScalarType::f32 || type == ScalarType::f64;
  return "column " + std::to_string(c + 1) + ": found '" + shownWord(picked_[c]) + "' (expected " +
         (real ? "a number" : "a value of type " + std::string(scalarName(type))) + ")";
}

}  // namespace strata
