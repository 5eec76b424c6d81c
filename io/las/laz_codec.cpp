#include "io/las/laz_codec.h"

#include <laszip/laszip_api.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <istream>
#include <limits>
#include <ostream>
#include <streambuf>
#include <utility>

namespace strata {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{128} << 10;  // of compressed bytes

/// LASzip's reason, on one line.
std::string reason(laszip_POINTER handle) {
  laszip_CHAR* text = nullptr;
  std::string why = laszip_get_error(handle, &text) == 0 && text != nullptr ? text : "no reason given";
  std::replace(why.begin(), why.end(), '\n', ' ');
  return why;
}

class LaszipHandle {
 public:
  explicit LaszipHandle(const std::string& file) {
    if (laszip_create(&handle_) != 0) throw Error(file, "LASzip cannot be started");
  }
  ~LaszipHandle() { laszip_destroy(handle_); }
  LaszipHandle(const LaszipHandle&) = delete;
  LaszipHandle& operator=(const LaszipHandle&) = delete;
  operator laszip_POINTER() const { return handle_; }

 private:
  laszip_POINTER handle_ = nullptr;
};

/// A file that LASzip can open: `head`, then the bytes [begin, limit) of a real file. So LASzip sees only headers that
/// we have written.
class LazStream final : private std::streambuf, public std::istream {
 public:
  LazStream(const ByteSource& file, std::vector<std::byte> head, std::uint64_t begin, std::uint64_t limit)
      : std::istream(static_cast<std::streambuf*>(this)),
        file_(file),
        head_(std::move(head)),
        next_(begin),
        end_(limit) {
    show(head_);
  }

  /// The position in the real file; meaningful once the head has been read.
  std::uint64_t position() const { return next_ - static_cast<std::uint64_t>(egptr() - gptr()); }
  /// The reason why the file could not be read; empty when it could.
  const std::optional<Error>& failure() const { return failure_; }

 private:
  using Byte = std::streambuf::traits_type;

  /// Some versions of LASzip look for the end of the stream and some for a bad one, and go on with garbage otherwise.
  /// So whatever ends this stream looks like both.
  std::streambuf::int_type underflow() override {
    const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes, end_ - next_));
    try {
      if (bytes == 0)
        throw Error(file_.name(), "the points end early, found byte " + std::to_string(end_) + " (expected more)");
      passed_ += static_cast<std::uint64_t>(egptr() - eback());
      buffer_.resize(bytes);
      file_.read(next_, buffer_);
    } catch (const Error& error) {
      failure_ = error;
      setstate(std::ios_base::badbit);
      return Byte::eof();
    }
    next_ += bytes;
    show(buffer_);
    return Byte::to_int_type(*gptr());
  }

  /// Tells the position, and refuses to change it.
  Byte::pos_type seekoff(Byte::off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    if (offset != 0 || from != std::ios_base::cur) return Byte::pos_type(Byte::off_type(-1));
    return Byte::pos_type(static_cast<Byte::off_type>(passed_) + (gptr() - eback()));
  }

  void show(std::vector<std::byte>& bytes) {
    auto* start = reinterpret_cast<char*>(bytes.data());
    setg(start, start, start + bytes.size());
  }

  const ByteSource& file_;
  std::vector<std::byte> head_;
  std::vector<std::byte> buffer_;
  std::uint64_t next_;  ///< offset in the real file of the byte behind the buffer
  std::uint64_t end_;
  std::uint64_t passed_ = 0;  ///< bytes of this stream before the buffer
  std::optional<Error> failure_;
};

/// The end of a file that LASzip writes to. It goes forward only, except for 8 bytes that it fills in later.
class LazSink final : public std::streambuf {
 public:
  explicit LazSink(OutputFile& file) : file_(file), start_(file.size()) { buffer_.reserve(kBufferBytes); }

  /// Throws the Error that the stream could not pass on.
  void flush() {
    if (failure_) throw *failure_;
    empty();
  }
  void rethrow() const {
    if (failure_) throw *failure_;
  }

 protected:
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    const auto* from = reinterpret_cast<const std::byte*>(bytes);
    try {
      if (buffer_.size() + static_cast<std::size_t>(count) > kBufferBytes) empty();
    } catch (const Error& error) {
      failure_ = error;
      throw;
    }
    buffer_.insert(buffer_.end(), from, from + count);
    return count;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    if (from == std::ios_base::cur && offset == 0) return pos_type(static_cast<off_type>(start_ + buffer_.size()));
    empty();
    if (from == std::ios_base::end) offset += static_cast<off_type>(file_.size());
    if (from == std::ios_base::cur) offset += static_cast<off_type>(start_);
    start_ = static_cast<std::uint64_t>(offset);
    return pos_type(offset);
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(off_type(position), std::ios_base::beg, mode);
  }

 private:
  void empty() {
    if (start_ == file_.size())
      file_.append(buffer_);
    else
      file_.writeAt(start_, buffer_);
    start_ += buffer_.size();
    buffer_.clear();
  }

  OutputFile& file_;
  std::uint64_t start_;  ///< offset of the buffer in the file
  std::vector<std::byte> buffer_;
  std::optional<Error> failure_;
};

/// The head of a file that holds this run alone.
std::vector<std::byte> headOfRun(const std::string& file, const LasHeader& header, const LazFormat& format,
                                 const LazRun& run) {
  LasMeta meta;
  meta.versionMinor = header.pointFormat >= 6 ? 4 : header.pointFormat >= 4 ? 3 : 2;
  meta.pointFormat = header.pointFormat;
  meta.recordBytes = header.recordBytes;
  LasTotals totals;
  totals.points = run.points;
  if (meta.versionMinor < 4 && run.points > std::numeric_limits<std::uint32_t>::max()) meta.versionMinor = 4;
  const LasMeta::Vlr laszip{"laszip encoded", 22204, "",
                            withChunkSize(format, static_cast<std::uint32_t>(run.chunkPoints))};
  std::vector<std::byte> head = encodeLasHead(file, meta, {laszip}, true, totals);
  if (format.compressor != LazFormat::kPointwise) {
    // LASzip takes a chunk table at this offset for one that was never written, and reads from chunk to chunk.
    const std::uint64_t table = head.size();
    const auto* bytes = reinterpret_cast<const std::byte*>(&table);
    head.insert(head.end(), bytes, bytes + sizeof table);
  }
  return head;
}

bool hasTime(int id) { return id == 1 || id >= 3; }
bool hasWaves(int id) { return id == 4 || id == 5 || id == 9 || id == 10; }
/// Bytes of red, green, blue and near infrared.
std::size_t colourBytes(int id) { return id == 8 || id == 10 ? 8 : id == 2 || id == 3 || id == 5 || id == 7 ? 6 : 0; }
std::size_t extraBytes(const LasRecordFormat& format) {
  return format.recordBytes - std::size_t{lasFormatBytes(format.pointFormat)};
}

// A laszip_point begins like the records of formats 0 to 5.
static_assert(offsetof(laszip_point_struct, extended_scan_angle) == 20);

void writeRecord(const LasRecordFormat& format, const laszip_point_struct& point, std::byte* record) {
  const auto put = [&record](const void* bytes, std::size_t size) {
    std::memcpy(record, bytes, size);
    record += size;
  };
  if (format.extended()) {
    const unsigned returns = point.extended_return_number | point.extended_number_of_returns << 4u;
    const unsigned flags = point.extended_classification_flags | point.extended_scanner_channel << 4u |
                           point.scan_direction_flag << 6u | point.edge_of_flight_line << 7u;
    const std::uint8_t fields[4] = {static_cast<std::uint8_t>(returns), static_cast<std::uint8_t>(flags),
                                    point.extended_classification, point.user_data};
    put(&point, 14);
    put(fields, sizeof fields);
    put(&point.extended_scan_angle, 2);
    put(&point.point_source_ID, 2);
  } else {
    put(&point, 20);
  }
  if (hasTime(format.pointFormat)) put(&point.gps_time, 8);
  put(point.rgb, colourBytes(format.pointFormat));
  if (hasWaves(format.pointFormat)) put(point.wave_packet, sizeof point.wave_packet);
  if (extraBytes(format) != 0) put(point.extra_bytes, extraBytes(format));
}

void readRecord(const LasRecordFormat& format, const std::byte* record, laszip_point_struct& point) {
  const auto take = [&record](void* bytes, std::size_t size) {
    std::memcpy(bytes, record, size);
    record += size;
  };
  if (format.extended()) {
    take(&point, 14);
    const auto returns = static_cast<unsigned>(record[0]), flags = static_cast<unsigned>(record[1]);
    record += 2;
    take(&point.extended_classification, 1);
    take(&point.user_data, 1);
    take(&point.extended_scan_angle, 2);
    take(&point.point_source_ID, 2);
    point.extended_point_type = 1;
    point.extended_return_number = returns & 15u;
    point.extended_number_of_returns = returns >> 4u & 15u;
    point.extended_classification_flags = flags & 15u;
    // LASzip wants these flags in both places, and the old class to be 0 or equal to the new one.
    point.synthetic_flag = flags & 1u;
    point.keypoint_flag = flags >> 1u & 1u;
    point.withheld_flag = flags >> 2u & 1u;
    point.extended_scanner_channel = flags >> 4u & 3u;
    point.scan_direction_flag = flags >> 6u & 1u;
    point.edge_of_flight_line = flags >> 7u & 1u;
  } else {
    take(&point, 20);
  }
  if (hasTime(format.pointFormat)) take(&point.gps_time, 8);
  take(point.rgb, colourBytes(format.pointFormat));
  if (hasWaves(format.pointFormat)) take(point.wave_packet, sizeof point.wave_packet);
  if (extraBytes(format) != 0) take(point.extra_bytes, extraBytes(format));
}

}  // namespace

struct LazDecoder::Parts {
  Parts(const ByteSource& source, const LasHeader& header, const LazFormat& format, const LazRun& chunks)
      : file(source),
        run(chunks),
        record{header.pointFormat, header.recordBytes},
        stream(source, headOfRun(source.name(), header, format, chunks), chunks.begin, chunks.end),
        handle(source.name()) {
    laszip_BOOL compressed = 0;
    if (laszip_open_reader_stream(handle, stream, &compressed) != 0 || laszip_get_point_pointer(handle, &point) != 0)
      throw Error(file.name(), "LASzip cannot read the points, found " + reason(handle) + " (expected points)");
  }
  // Destroying the handle alone would leak memory that opening took.
  ~Parts() { laszip_close_reader(handle); }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  const ByteSource& file;
  const LazRun& run;
  LasRecordFormat record;
  LazStream stream;
  LaszipHandle handle;
  laszip_point_struct* point = nullptr;
  std::uint64_t done = 0;
};

LazDecoder::LazDecoder(const ByteSource& file, const LasHeader& header, const LazFormat& format, const LazRun& run)
    : parts_(std::make_unique<Parts>(file, header, format, run)) {}

LazDecoder::~LazDecoder() = default;

std::uint64_t LazDecoder::left() const { return parts_->run.points - parts_->done; }

std::optional<Error> LazDecoder::next(std::uint64_t firstPoint, std::byte* record) {
  Parts& p = *parts_;
  const bool decoded = laszip_read_point(p.handle) == 0;
  if (p.stream.failure()) return p.stream.failure();
  if (!decoded)
    return Error(p.file.name(), "compressed points are damaged at point " + std::to_string(firstPoint + p.done) +
                                    ", found " + reason(p.handle) + " (expected a point)");
  writeRecord(p.record, *p.point, record);
  ++p.done;
  if (p.run.chunkEnds.empty() || (p.done % p.run.chunkPoints != 0 && p.done != p.run.points)) return {};
  // LASzip decodes garbage without complaint, but only undamaged chunks end where the next one begins.
  const std::uint64_t expected = p.run.chunkEnds[static_cast<std::size_t>((p.done - 1) / p.run.chunkPoints)];
  if (p.stream.position() == expected) return {};
  return Error(p.file.name(), "compressed points are damaged before point " + std::to_string(firstPoint + p.done) +
                                  ", found their end at byte " + std::to_string(p.stream.position()) + " (expected " +
                                  std::to_string(expected) + ")");
}

struct LazEncoder::Parts {
  Parts(OutputFile& output, const LasRecordFormat& recordFormat)
      : file(output), format(recordFormat), handle(output.path()) {
    check(laszip_request_native_extension(handle, 1));
    check(laszip_set_point_type_and_size(handle, static_cast<laszip_U8>(format.pointFormat), format.recordBytes));
    laszip_U8* bytes = nullptr;
    laszip_U32 size = 0;
    check(laszip_create_laszip_vlr(handle, &bytes, &size));
    // LASzip returns a whole VLR, whose data follow its header.
    constexpr std::size_t kVlrHeader = 54;
    if (size > kVlrHeader) record.assign(bytes + kVlrHeader, bytes + size);
    check(laszip_get_point_pointer(handle, &point));
  }

  void check(laszip_I32 failed) const {
    if (failed == 0) return;
    if (sink) sink->rethrow();
    throw Error(file.path(), "compressing points, found " + reason(handle) + " (expected no error)");
  }

  OutputFile& file;
  LasRecordFormat format;
  std::optional<LazSink> sink;
  std::optional<std::ostream> stream;
  LaszipHandle handle;
  laszip_point_struct* point = nullptr;
  std::vector<std::uint8_t> record;
};

LazEncoder::LazEncoder(OutputFile& file, const LasRecordFormat& format)
    : parts_(std::make_unique<Parts>(file, format)) {}

LazEncoder::~LazEncoder() = default;

const std::vector<std::uint8_t>& LazEncoder::record() const { return parts_->record; }

void LazEncoder::start() {
  parts_->sink.emplace(parts_->file);
  parts_->stream.emplace(&*parts_->sink);
  parts_->check(laszip_open_writer_stream(parts_->handle, *parts_->stream, 1, 1));
}

void LazEncoder::write(std::span<const std::byte> records) {
  for (; !records.empty(); records = records.subspan(parts_->format.recordBytes)) {
    readRecord(parts_->format, records.data(), *parts_->point);
    parts_->check(laszip_write_point(parts_->handle));
  }
}

void LazEncoder::finish() {
  parts_->check(laszip_close_writer(parts_->handle));
  parts_->sink->flush();
}

}  // namespace strata
