#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "core/error.h"
#include "io/table/text_format.h"
#include "io/table/text_table_source.h"

namespace {

class Memory final : public strata::ByteSource {
 public:
  explicit Memory(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    if (offset > bytes_.size() || out.size() > bytes_.size() - offset) throw strata::Error(name_, "truncated read");
    std::memcpy(out.data(), bytes_.data() + offset, out.size());
  }

 private:
  std::string_view bytes_;
  std::string name_ = "fuzz.xyz";
};

}  // namespace

/// Finds the layout, surveys the table and reads it, as openText() does, but from memory.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const strata::TextFormat format = strata::detectTextFormat("fuzz.xyz", text, "");
    auto bytes = std::make_unique<Memory>(text);
    strata::TextTable table;
    for (const std::string& name : format.columns) {
      table.columns.push_back({.field = table.fields.size()});
      table.fields.push_back({.name = name, .type = strata::ScalarType::f64});
    }
    table.comments = true;
    table.countLines = format.countLines;
    table.skipDamaged = size % 2 == 0;
    table.begin = format.headerBytes;
    table.end = size;
    strata::packFields(table);
    strata::TextSurvey survey = strata::surveyText(*bytes, table);
    const auto source = strata::openTextTable(std::move(bytes), std::move(table), std::move(survey));
    strata::PointBlock block;
    for (std::size_t part = 0; part < source->partCount(); ++part) {
      const auto reader = source->openPart(part);
      while (reader->read(block, 16)) {
      }
    }
  } catch (const strata::Error&) {
  }
  return 0;
}
