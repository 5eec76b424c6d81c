#include "tests/support/las_decoder.h"

#include <laszip/laszip_api.h>

#include "tests/support/programs.h"

namespace strata::test {
namespace {

/// A reader or writer of LASzip's C interface that throws.
class Laszip {
 public:
  Laszip() {
    if (laszip_create(&pointer_) != 0) throw std::runtime_error("laszip_create failed");
  }
  ~Laszip() { laszip_destroy(pointer_); }
  Laszip(const Laszip&) = delete;
  Laszip& operator=(const Laszip&) = delete;

  laszip_POINTER get() const { return pointer_; }
  void check(laszip_I32 result) const {
    if (result == 0) return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(pointer_, &message);
    throw std::runtime_error(message != nullptr ? message : "LASzip failed");
  }

 private:
  laszip_POINTER pointer_ = nullptr;
};

void decompress(const std::filesystem::path& from, const std::filesystem::path& to) {
  const Laszip reader, writer;
  laszip_BOOL compressed = 0;
  reader.check(laszip_open_reader(reader.get(), from.c_str(), &compressed));
  laszip_header* header = nullptr;
  laszip_point* point = nullptr;
  reader.check(laszip_get_header_pointer(reader.get(), &header));
  reader.check(laszip_get_point_pointer(reader.get(), &point));
  writer.check(laszip_set_header(writer.get(), header));
  writer.check(laszip_open_writer(writer.get(), to.c_str(), 0));
  const laszip_U64 count =
      header->number_of_point_records != 0 ? header->number_of_point_records : header->extended_number_of_point_records;
  for (laszip_U64 i = 0; i < count; ++i) {
    reader.check(laszip_read_point(reader.get()));
    writer.check(laszip_set_point(writer.get(), point));
    writer.check(laszip_write_point(writer.get()));
  }
  writer.check(laszip_close_writer(writer.get()));
  reader.check(laszip_close_reader(reader.get()));
}

}  // namespace

LasFile decodeLas(const std::filesystem::path& path, const std::filesystem::path& scratch) {
  if (path.extension() == ".las") return readLas(path);
  decompress(path, scratch / "decoded.las");
  return readLas(scratch / "decoded.las");
}

void expectRecordsComeBack(const RealScan& scan) {
  const TempFolder folder;
  const LasFile before = decodeLas(scan.path(), folder.path());
  ASSERT_EQ(before.count, scan.points);
  writeBytes(folder / "records", before.records);
  const Finished sum = runProgram("/usr/bin/sha256sum", {(folder / "records").string()});
  ASSERT_EQ(sum.out.substr(0, 64), scan.recordsSha256) << "the oracle itself is wrong";

  const Json result = mustConvert({scan.path().string()}, folder / "scan.strata");
  EXPECT_EQ(result.at("points"), scan.points);
  const LasFile after = mustExport(folder / "scan.strata", folder / "back.las");
  EXPECT_EQ(after.format, before.format);
  EXPECT_EQ(after.recordBytes, before.recordBytes);
  EXPECT_EQ(after.scale, before.scale);
  EXPECT_EQ(after.offset, before.offset);
  ASSERT_EQ(after.count, before.count);
  const auto sortedBefore = before.sortedRecords();
  const auto sortedAfter = after.sortedRecords();
  std::uint64_t different = 0;
  for (std::size_t i = 0; i < sortedBefore.size(); ++i) different += sortedBefore[i] != sortedAfter[i];
  EXPECT_EQ(different, 0u) << "of " << before.count << " sorted records";
}

}  // namespace strata::test
