// Measures how long LASzip itself takes to decode a file on one core without using the points, as a yardstick for
// conversions of LAZ. Prints one JSON object.
#include <laszip/laszip_api.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace {

double cpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

int fail(laszip_POINTER reader, const char* file) {
  laszip_CHAR* message = nullptr;
  if (reader != nullptr) laszip_get_error(reader, &message);
  std::fprintf(stderr, "error: %s: %s\n", file, message != nullptr ? message : "LASzip failed");
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "error: laszip_decode: expected one file\n");
    return 2;
  }
  const auto begin = std::chrono::steady_clock::now();
  laszip_POINTER reader = nullptr;
  laszip_header* header = nullptr;
  laszip_point* point = nullptr;
  laszip_BOOL compressed = 0;
  if (laszip_create(&reader) != 0 || laszip_open_reader(reader, argv[1], &compressed) != 0 ||
      laszip_get_header_pointer(reader, &header) != 0 || laszip_get_point_pointer(reader, &point) != 0)
    return fail(reader, argv[1]);
  const laszip_U64 count =
      header->number_of_point_records != 0 ? header->number_of_point_records : header->extended_number_of_point_records;
  long long sum = 0;
  for (laszip_U64 i = 0; i < count; ++i) {
    if (laszip_read_point(reader) != 0) return fail(reader, argv[1]);
    sum += point->X;
  }
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double cpu = cpuSeconds();
  std::printf("{\"points\":%llu,\"seconds\":%.3f,\"cpu_seconds\":%.3f,\"cpu_us_per_point\":%.4f,\"sum_x\":%lld}\n",
              static_cast<unsigned long long>(count), wall, cpu, 1e6 * cpu / static_cast<double>(count), sum);
  laszip_close_reader(reader);
  laszip_destroy(reader);
  return 0;
}
