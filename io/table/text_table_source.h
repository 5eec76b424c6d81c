#pragma once
#include <memory>

#include "io/file/byte_source.h"
#include "io/scan/point_source.h"
#include "io/table/text_survey.h"
#include "io/table/text_table.h"

namespace strata {

/// Opens a table, whose fields are set, as a source; `survey` is surveyText() of it. SourceInfo::pointCount counts the
/// damaged lines too, and is TextTable::claimedPoints when that is more.
std::unique_ptr<PointSource> openTextTable(std::unique_ptr<ByteSource> bytes, TextTable table, TextSurvey survey);

}  // namespace strata
