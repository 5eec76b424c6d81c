#include "io/table/text_table_source.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/table/coordinate_step.h"
#include "io/table/record_mapping.h"
#include "io/table/text_lines.h"

namespace strata {
namespace {

constexpr int kMostDecimals = 9;  ///< of a grid

class TextReader final : public PointReader {
 public:
  TextReader(const ByteSource& bytes, const TextTable& table, const RecordMapping& mapping, const TextPart& part)
      : bytes_(bytes),
        table_(table),
        mapping_(mapping),
        part_(part),
        lines_(bytes, part.begin, part.end),
        parser_(table) {}

  bool read(PointBlock& block, std::size_t maxPoints) override {
    block.positions.clear();
    block.attributes.clear();
    std::string_view line;
    while (block.count() < maxPoints && lines_.next(line)) {
      if (lineKind(line, table_) != LineKind::point) continue;
      if (parser_.parse(line))
        mapping_.append(parser_.record().data(), table_.recordBytes, 1, block);
      else if (!table_.skipDamaged)
        throw Error(bytes_.name(),
                    "line " + std::to_string(part_.firstLine + lines_.count() - 1) + ": " + parser_.fault());
    }
    return block.count() > 0;
  }

 private:
  const ByteSource& bytes_;
  const TextTable& table_;
  const RecordMapping& mapping_;
  TextPart part_;
  LineReader lines_;
  LineParser parser_;
};

class TextTableSource final : public PointSource {
 public:
  TextTableSource(std::unique_ptr<ByteSource> bytes, TextTable table, TextSurvey survey)
      : bytes_(std::move(bytes)), table_(std::move(table)), parts_(std::move(survey.parts)) {
    std::erase_if(parts_, [](const TextPart& part) { return part.points == 0; });
    mapping_ = RecordMapping(bytes_->name(), table_.fields, fieldRanges(survey));
    info_.path = bytes_->name();
    info_.format = table_.format;
    info_.pointCount = std::max(survey.points + survey.damaged, table_.claimedPoints);
    info_.boundsExact = true;
    info_.bounds = survey.bounds;
    info_.layout = mapping_.layout();
    info_.fileBytes = bytes_->size();
    info_.uncompressedBytes = bytes_->size();
    info_.viewpoint = table_.viewpoint;
    setGrid(survey);
  }

  const SourceInfo& info() const override { return info_; }
  std::size_t partCount() const override { return parts_.size(); }
  std::unique_ptr<PointReader> openPart(std::size_t part) const override {
    return std::make_unique<TextReader>(*bytes_, table_, mapping_, parts_.at(part));
  }

 private:
  std::vector<FieldRange> fieldRanges(const TextSurvey& survey) const {
    std::vector<FieldRange> ranges(table_.fields.size());
    for (std::size_t c = 0; c < table_.columns.size(); ++c)
      if (table_.columns[c].kind == TextColumn::Kind::value && table_.columns[c].value == 0)
        ranges[table_.columns[c].field] = survey.columns[c].range;
    return ranges;
  }

  /// When no coordinate has more than kMostDecimals decimals, all are multiples of one power of ten.
  void setGrid(const TextSurvey& survey) {
    const AxisFields axes = findAxes(table_.fields);
    int decimals = 0;
    for (std::size_t c = 0; c < table_.columns.size(); ++c) {
      const TextColumn& column = table_.columns[c];
      if (column.kind != TextColumn::Kind::value || survey.columns[c].range.empty()) continue;
      if (std::find(std::begin(axes.index), std::end(axes.index), static_cast<int>(column.field)) ==
          std::end(axes.index))
        continue;
      decimals = std::max(decimals, survey.columns[c].decimals);
    }
    info_.gridExact = decimals <= kMostDecimals;
    info_.float64 = !info_.gridExact;
    info_.step = info_.gridExact ? glm::dvec3(1.0 / std::pow(10.0, decimals))
                                 : fillSteps(glm::dvec3(float64Step(survey.bounds)));
  }

  std::unique_ptr<ByteSource> bytes_;
  TextTable table_;
  std::vector<TextPart> parts_;
  RecordMapping mapping_;
  SourceInfo info_;
};

}  // namespace

std::unique_ptr<PointSource> openTextTable(std::unique_ptr<ByteSource> bytes, TextTable table, TextSurvey survey) {
  return std::make_unique<TextTableSource>(std::move(bytes), std::move(table), std::move(survey));
}

}  // namespace strata
