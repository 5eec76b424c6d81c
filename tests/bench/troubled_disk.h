#pragma once
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "core/error.h"
#include "core/random.h"
#include "io/store/store.h"
#include "io/store/store_files.h"

namespace strata {

/// A file on a disk that has faults from begin() on.
class TroubledDisk final : public ByteSource {
 public:
  struct Trouble {
    std::chrono::microseconds latency{0};  ///< added to every read
    double bytesPerSecond = 0.0;           ///< 0: no limit
    double failing = 0.0, garbage = 0.0;   ///< shares of the reads that fail, and that bring a wrong byte
  };

  TroubledDisk(const std::string& path, const Trouble& trouble) : file_(openFile(path)), trouble_(trouble) {}

  void begin() const { begun_ = true; }
  std::uint64_t size() const override { return file_->size(); }
  const std::string& name() const override { return file_->name(); }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    if (!begun_) {
      file_->read(offset, out);
      return;
    }
    const std::uint64_t call = calls_.fetch_add(1);
    auto wait = std::chrono::duration<double>(trouble_.latency);
    if (trouble_.bytesPerSecond > 0.0)
      wait += std::chrono::duration<double>(static_cast<double>(out.size()) / trouble_.bytesPerSecond);
    if (wait.count() > 0.0) std::this_thread::sleep_for(wait);
    const double dice = static_cast<double>((call * kSplitMixStep) >> 40) / static_cast<double>(1 << 24);
    if (dice < trouble_.failing) throw Error(name(), "the disk failed");
    file_->read(offset, out);
    if (dice > 1.0 - trouble_.garbage) out[out.size() / 2] ^= std::byte{0x55};
  }

 private:
  const std::unique_ptr<ByteSource> file_;
  const Trouble trouble_;
  mutable std::atomic<bool> begun_{false};
  mutable std::atomic<std::uint64_t> calls_{1};
};

/// A store on a TroubledDisk.
struct TroubledStore {
  const TroubledDisk* disk;  ///< which the store owns
  std::shared_ptr<const Store> store;
};
inline TroubledStore openWith(const std::string& store, const TroubledDisk::Trouble& trouble) {
  auto disk = std::make_unique<TroubledDisk>(store + "/" + kPointsFile, trouble);
  const TroubledDisk* const itself = disk.get();
  return {itself, std::make_shared<const Store>(store, std::move(disk))};
}

}  // namespace strata
