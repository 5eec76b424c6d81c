#include "io/table/text_table.h"

namespace strata {

void packFields(TextTable& table) {
  table.recordBytes = 0;
  for (Field& field : table.fields) {
    field.offset = table.recordBytes;
    table.recordBytes += field.bytes();
  }
}

}  // namespace strata
