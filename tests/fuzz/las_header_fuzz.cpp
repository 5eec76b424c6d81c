// libFuzzer: no bytes may crash the decoders of the LAS header and of the VLRs behind it.
#include <cstring>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/las/las_header.h"
#include "io/las/las_record.h"
#include "io/las/las_vlr.h"
#include "io/las/laz_header.h"

namespace {

class Memory final : public strata::ByteSource {
 public:
  Memory(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint64_t size() const override { return size_; }
  const std::string& name() const override { return name_; }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    if (offset > size_ || out.size() > size_ - offset) throw strata::Error(name_, "truncated read");
    if (!out.empty()) std::memcpy(out.data(), data_ + offset, out.size());
  }

 private:
  std::string name_ = "memory.las";
  const std::uint8_t* data_;
  std::size_t size_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  const Memory file(data, size);
  try {
    const LasHead head = readLasHead(file);
    const LasRecordFormat format{head.header.pointFormat, head.header.recordBytes};
    if (lasLayout(format, head.vlrs).stride() != lasStride(format)) __builtin_trap();
    (void)lasCrs(head.vlrs);
    if (!head.header.compressed) return 0;
    const LazFormat compression = parseLazFormat(file.name(), head);
    if (compression.compressor == LazFormat::kPointwise) return 0;
    const std::uint64_t table = chunkTableOffset(file, head.header);
    if (table == 0) return 0;
    std::uint64_t end = head.header.pointsOffset + std::uint64_t{8};
    for (const LazChunk& chunk : readChunkTable(file, head.header, compression, table)) {
      if (chunk.offset != end || chunk.bytes > size - chunk.offset) __builtin_trap();
      end += chunk.bytes;
    }
  } catch (const Error&) {
  }
  return 0;
}
