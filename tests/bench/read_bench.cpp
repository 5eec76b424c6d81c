// read_bench STORE [ROUNDS] compares ways of reading nodes. It reads the payload of every node once, in a random order,
// by pread from several threads and by io_uring with several reads under way; first with nothing of the file in the
// page cache, then with all of it. The ways take turns, and the medians of the rounds are printed.
#include <fcntl.h>
#include <linux/io_uring.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "io/store/store.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

struct Read {
  std::uint64_t offset;
  std::uint32_t bytes;
};
using Reads = std::vector<Read>;

void readWhole(int file, const Read& read, std::byte* into) {
  for (std::uint32_t done = 0; done < read.bytes;) {
    const ssize_t got = ::pread(file, into + done, read.bytes - done, static_cast<off_t>(read.offset + done));
    if (got <= 0) throw posixError("points.bin", "pread", errno);
    done += static_cast<std::uint32_t>(got);
  }
}

void byPread(int file, const Reads& reads, std::size_t largest, int threads) {
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> readers;
  for (int t = 0; t < threads; ++t)
    readers.emplace_back([&] {
      std::vector<std::byte> buffer(largest);
      for (std::size_t i; (i = next.fetch_add(1)) < reads.size();) readWhole(file, reads[i], buffer.data());
    });
}

/// The two rings of Linux's io_uring, by plain system calls (Axboe 2019, "Efficient IO with io_uring").
class Ring {
 public:
  explicit Ring(unsigned depth) {
    io_uring_params p{};
    descriptor_ = static_cast<int>(::syscall(SYS_io_uring_setup, depth, &p));
    if (descriptor_ < 0) throw posixError("io_uring", "setting up", errno);
    submission_ = map(p.sq_off.array + p.sq_entries * sizeof(unsigned), IORING_OFF_SQ_RING);
    completion_ = map(p.cq_off.cqes + p.cq_entries * sizeof(io_uring_cqe), IORING_OFF_CQ_RING);
    entries_ = static_cast<io_uring_sqe*>(map(p.sq_entries * sizeof(io_uring_sqe), IORING_OFF_SQES));
    const auto at = [](void* ring, unsigned offset) {
      return reinterpret_cast<unsigned*>(static_cast<char*>(ring) + offset);
    };
    tail_ = at(submission_, p.sq_off.tail);
    mask_ = *at(submission_, p.sq_off.ring_mask);
    order_ = at(submission_, p.sq_off.array);
    doneHead_ = at(completion_, p.cq_off.head);
    doneTail_ = at(completion_, p.cq_off.tail);
    doneMask_ = *at(completion_, p.cq_off.ring_mask);
    done_ = reinterpret_cast<io_uring_cqe*>(static_cast<char*>(completion_) + p.cq_off.cqes);
  }
  ~Ring() {
    for (const auto& [memory, size] : mapped_) ::munmap(memory, size);
    ::close(descriptor_);
  }
  Ring(const Ring&) = delete;
  Ring& operator=(const Ring&) = delete;

  void add(int file, const Read& read, std::byte* into, std::uint64_t slot) {
    const unsigned tail = *tail_;
    io_uring_sqe& entry = entries_[tail & mask_];
    std::memset(&entry, 0, sizeof entry);
    entry.opcode = IORING_OP_READ;
    entry.fd = file;
    entry.off = read.offset;
    entry.addr = reinterpret_cast<std::uint64_t>(into);
    entry.len = read.bytes;
    entry.user_data = slot;
    order_[tail & mask_] = tail & mask_;
    std::atomic_ref(*tail_).store(tail + 1, std::memory_order_release);
    ++added_;
  }
  /// Submits the reads that were added and waits for at least one to end.
  void wait() {
    if (::syscall(SYS_io_uring_enter, descriptor_, added_, 1, IORING_ENTER_GETEVENTS, nullptr, 0) < 0)
      throw posixError("io_uring", "waiting", errno);
    added_ = 0;
  }
  /// Gives slot and result of the next read that has ended; false when there is none.
  bool take(std::uint64_t& slot, int& result) {
    const unsigned head = *doneHead_;
    if (head == std::atomic_ref(*doneTail_).load(std::memory_order_acquire)) return false;
    slot = done_[head & doneMask_].user_data;
    result = done_[head & doneMask_].res;
    std::atomic_ref(*doneHead_).store(head + 1, std::memory_order_release);
    return true;
  }

 private:
  void* map(std::size_t size, off_t what) {
    void* const memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, descriptor_, what);
    if (memory == MAP_FAILED) throw posixError("io_uring", "mapping", errno);
    mapped_.emplace_back(memory, size);
    return memory;
  }

  int descriptor_;
  std::vector<std::pair<void*, std::size_t>> mapped_;
  void *submission_, *completion_;
  io_uring_sqe* entries_;
  unsigned *tail_, *order_, *doneHead_, *doneTail_;
  unsigned mask_, doneMask_, added_ = 0;
  io_uring_cqe* done_;
};

void byRing(int file, const Reads& reads, std::size_t largest, unsigned depth) {
  Ring ring(depth);
  std::vector<std::vector<std::byte>> buffers(depth, std::vector<std::byte>(largest));
  std::vector<std::size_t> inSlot(depth);
  std::size_t next = 0, ended = 0;
  const auto begin = [&](std::uint64_t slot) {
    inSlot[slot] = next;
    ring.add(file, reads[next++], buffers[slot].data(), slot);
  };
  for (unsigned slot = 0; slot < depth && next < reads.size(); ++slot) begin(slot);
  while (ended < reads.size()) {
    ring.wait();
    std::uint64_t slot = 0;
    for (int result = 0; ring.take(slot, result);) {
      if (result < 0) throw posixError("points.bin", "io_uring", -result);
      const Read& read = reads[inSlot[slot]];
      if (static_cast<std::uint32_t>(result) < read.bytes) readWhole(file, read, buffers[slot].data());  // cut short
      ++ended;
      if (next < reads.size()) begin(slot);
    }
  }
}

/// The processor time of all threads.
double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Way {
  std::string name;
  std::function<void()> run;
  std::vector<double> seconds[2], cpu[2];  ///< cold, warm
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure(const std::string& path, int rounds) {
  const Store store(path);
  Reads reads;
  std::size_t largest = 0;
  double megabytes = 0.0;
  for (const NodeRecord& record : store.hierarchy().nodes) {
    if (record.payloadBytes == 0) continue;
    reads.push_back({record.offset, record.payloadBytes});
    largest = std::max<std::size_t>(largest, record.payloadBytes);
    megabytes += 1e-6 * record.payloadBytes;
  }
  std::shuffle(reads.begin(), reads.end(), std::mt19937_64(1));
  const int file = ::open((path + "/" + kPointsFile).c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw posixError(path, "opening", errno);

  std::vector<Way> ways;
  for (const int threads : {1, 2, 4})
    ways.push_back({"pread, " + std::to_string(threads) + (threads > 1 ? " threads" : " thread"),
                    [&, threads] { byPread(file, reads, largest, threads); },
                    {},
                    {}});
  std::string refused;
  try {
    const Ring ring(1);
    for (const unsigned depth : {1u, 4u, 32u})
      ways.push_back({"io_uring, " + std::to_string(depth) + " under way",
                      [&, depth] { byRing(file, reads, largest, depth); },
                      {},
                      {}});
  } catch (const Error& error) {
    refused = error.what();
  }
  for (int round = 0; round < rounds; ++round)
    for (Way& way : ways)
      for (const int warm : {0, 1}) {
        if (warm == 0) ::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
        const double cpu = cpuSeconds();
        const auto start = std::chrono::steady_clock::now();
        way.run();
        way.seconds[warm].push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        way.cpu[warm].push_back(cpuSeconds() - cpu);
      }
  ::close(file);
  std::printf("%zu reads, %.0f kB each on average; medians of %d.\n\n", reads.size(),
              1e3 * megabytes / static_cast<double>(reads.size()), rounds);
  std::printf("| reads by | cold MB/s | CPU µs a read | warm MB/s | CPU µs a read |\n|---|---|---|---|---|\n");
  for (const Way& way : ways) {
    std::printf("| %s |", way.name.c_str());
    for (const int warm : {0, 1})
      std::printf(" %.0f | %.0f |", megabytes / median(way.seconds[warm]),
                  1e6 * median(way.cpu[warm]) / static_cast<double>(reads.size()));
    std::printf("\n");
  }
  if (!refused.empty()) std::printf("\nio_uring is not to be had here (%s).\n", refused.c_str());
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: read_bench STORE [ROUNDS]\n");
    return 2;
  }
  try {
    strata::measure(argv[1], argc > 2 ? std::stoi(argv[2]) : 5);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
