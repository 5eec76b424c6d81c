#include "io/table/text_survey.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <span>
#include <thread>

#include "core/error.h"
#include "io/scan/point_source.h"
#include "io/table/text_lines.h"

namespace strata {
namespace {

constexpr std::uint64_t kPartBytes = std::uint64_t{32} << 20;
constexpr unsigned kMostThreads = 16;
constexpr std::uint64_t kStopLines = 4096;       ///< lines read between two looks at TextTable::stop
constexpr std::size_t kMostCountLines = 100000;  ///< of one part

/// A PTS line that counts the points behind it.
struct CountLine {
  std::uint64_t pointsBefore = 0;
  std::uint64_t promised = 0;
  std::uint64_t line = 0;  ///< within the part, from 0
};

/// The findings of one thread in one part.
struct PartSurvey {
  std::vector<ColumnSurvey> columns;
  std::vector<CountLine> countLines;
  Box bounds;
  std::uint64_t points = 0;
  std::uint64_t damaged = 0;
  std::uint64_t lines = 0;
  std::string fault;           ///< why the last line read cannot be read; empty when it can
  std::exception_ptr failure;  ///< reading failed
};

std::uint64_t lineStartAfter(const ByteSource& bytes, std::uint64_t offset, std::uint64_t end) {
  std::vector<char> buffer(4096);
  for (std::uint64_t at = offset - 1; at < end;) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), end - at));
    bytes.read(at, std::as_writable_bytes(std::span(buffer).first(wanted)));
    if (const void* found = std::memchr(buffer.data(), '\n', wanted))
      return at + static_cast<std::uint64_t>(static_cast<const char*>(found) - buffer.data()) + 1;
    at += wanted;
  }
  return end;
}

std::vector<TextPart> cutParts(const ByteSource& bytes, const TextTable& table) {
  std::vector<TextPart> parts;
  std::uint64_t begin = table.begin;
  for (std::uint64_t cut = table.begin + kPartBytes; begin < table.end; cut += kPartBytes) {
    if (cut <= begin) continue;
    const std::uint64_t end = cut >= table.end ? table.end : lineStartAfter(bytes, cut, table.end);
    parts.push_back({.begin = begin, .end = end});
    begin = end;
  }
  return parts;
}

/// Adds a number, written as `token`, to the survey of its column.
void describe(std::string_view token, double value, ColumnSurvey& column) {
  column.range.add(value);
  int digits = 0, zeros = 0, decimals = 0, trailing = 0, exponent = 0;
  bool point = false, plain = true;
  for (std::size_t i = 0; i < token.size(); ++i) {
    const char c = token[i];
    if (c == '.') {
      point = true;
    } else if (c == 'e' || c == 'E') {
      std::int64_t power = 0;
      if (parseInteger(token.substr(i + 1), power))
        exponent = static_cast<int>(std::clamp<std::int64_t>(power, -400, 400));
      plain = false;
      break;
    } else if (c >= '0' && c <= '9') {
      if (c == '0')
        ++zeros;
      else {
        digits += digits > 0 ? zeros + 1 : 1;
        zeros = 0;
      }
      if (point) {
        ++decimals;
        trailing = c == '0' ? trailing + 1 : 0;
      }
    } else if (c != '-' && c != '+') {
      plain = false;  // nan, inf
    }
  }
  column.integers = column.integers && plain && !point;
  column.digits = std::max(column.digits, digits);
  if (digits > 0 && std::isfinite(value)) column.decimals = std::max(column.decimals, decimals - trailing - exponent);
}

class PartPass {
 public:
  PartPass(const ByteSource& bytes, const TextTable& table)
      : bytes_(bytes), table_(table), axes_(findAxes(table.fields)), parser_(table) {}

  PartSurvey run(const TextPart& part) {
    PartSurvey found;
    found.columns.resize(table_.columns.size());
    LineReader lines(bytes_, part.begin, part.end);
    std::string_view line;
    while (lines.next(line) && found.fault.empty()) {
      found.lines = lines.count();
      if (found.lines % kStopLines == 0 && table_.stop != nullptr && *table_.stop) throw Stopped();
      const LineKind kind = lineKind(line, table_);
      if (kind == LineKind::point) point(line, found);
      if (kind == LineKind::countLine) countLine(line, found);
    }
    return found;
  }

 private:
  void point(std::string_view line, PartSurvey& found) {
    if (!parser_.parse(line)) {
      if (table_.skipDamaged)
        ++found.damaged;
      else
        found.fault = parser_.fault();
      return;
    }
    glm::dvec3 p(std::nan(""));
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const TextColumn& column = table_.columns[c];
      if (column.kind != TextColumn::Kind::value || column.value > 0) continue;
      const Field& field = table_.fields[column.field];
      const double value = loadScalar(parser_.record().data() + field.offset, field.type);
      describe(parser_.columns()[c], value, found.columns[c]);
      for (int axis = 0; axis < 3; ++axis)
        if (axes_.index[axis] == static_cast<int>(column.field)) p[axis] = value;
    }
    ++found.points;
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) found.bounds.add(p);
  }

  void countLine(std::string_view line, PartSurvey& found) {
    splitColumns(line, tokens_);
    std::int64_t promised = 0;
    if (!parseInteger(tokens_.at(0), promised)) found.fault = "found a count of points that is too large";
    if (found.countLines.size() == kMostCountLines) found.fault = "found 1 column again and again (expected points)";
    found.countLines.push_back({found.points, static_cast<std::uint64_t>(promised), found.lines - 1});
  }

  const ByteSource& bytes_;
  const TextTable& table_;
  AxisFields axes_;
  LineParser parser_;
  std::vector<std::string_view> tokens_;
};

std::vector<PartSurvey> passInParallel(const ByteSource& bytes, const TextTable& table,
                                       const std::vector<TextPart>& parts) {
  std::vector<PartSurvey> found(parts.size());
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  const auto work = [&] {
    PartPass pass(bytes, table);
    // Parts are taken in order, and a part once taken is finished, so the first error of the file is always found.
    while (!failed) {
      const std::size_t part = next++;
      if (part >= parts.size()) return;
      try {
        found[part] = pass.run(parts[part]);
      } catch (...) {
        found[part].failure = std::current_exception();
      }
      if (found[part].failure || !found[part].fault.empty()) failed = true;
    }
  };
  const std::size_t threads =
      std::min<std::size_t>({std::max(1u, std::thread::hardware_concurrency()), kMostThreads, parts.size()});
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  return found;
}

void checkCounts(const std::string& file, const std::vector<CountLine>& counts, std::uint64_t points) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const bool last = i + 1 == counts.size();
    const std::uint64_t follow = (last ? points : counts[i + 1].pointsBefore) - counts[i].pointsBefore;
    if (follow == counts[i].promised) continue;
    const std::string figures =
        "found " + std::to_string(follow) + " points (expected " + std::to_string(counts[i].promised) + ")";
    if (last && follow < counts[i].promised) throw Error(file, "the file ends early, " + figures);
    throw Error(file, "line " + std::to_string(counts[i].line) + ": it counts the points that follow, " + figures);
  }
}

}  // namespace

TextSurvey surveyText(const ByteSource& bytes, const TextTable& table) {
  TextSurvey survey;
  survey.columns.resize(table.columns.size());
  survey.parts = cutParts(bytes, table);
  const std::vector<PartSurvey> found = passInParallel(bytes, table, survey.parts);
  std::vector<CountLine> counts;
  std::uint64_t line = table.firstLine;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const PartSurvey& part = found[i];
    if (part.failure) std::rethrow_exception(part.failure);
    if (!part.fault.empty())
      throw Error(bytes.name(), "line " + std::to_string(line + part.lines - 1) + ": " + part.fault);
    for (const CountLine& count : part.countLines)
      counts.push_back({survey.points + count.pointsBefore, count.promised, line + count.line});
    survey.parts[i].firstLine = line;
    survey.parts[i].points = part.points;
    survey.parts[i].damaged = part.damaged;
    survey.points += part.points;
    survey.damaged += part.damaged;
    survey.bounds.add(part.bounds);
    line += part.lines;
    for (std::size_t c = 0; c < survey.columns.size(); ++c) {
      ColumnSurvey& all = survey.columns[c];
      all.range.add(part.columns[c].range);
      all.integers = all.integers && part.columns[c].integers;
      all.digits = std::max(all.digits, part.columns[c].digits);
      all.decimals = std::max(all.decimals, part.columns[c].decimals);
    }
  }
  if (!table.skipDamaged) checkCounts(bytes.name(), counts, survey.points);
  return survey;
}

}  // namespace strata
