#pragma once
#include <condition_variable>
#include <mutex>

/// Locks whose discipline the compiler checks: `clang++ -Wthread-safety` refuses every use of a STRATA_GUARDED_BY
/// member without its lock (Hutchins, Ballman, Sutherland 2014, "C/C++ Thread Safety Analysis"). For other compilers
/// the annotations are empty.
#if defined(__clang__)
#define STRATA_THREAD_ATTRIBUTE(x) __attribute__((x))
#else
#define STRATA_THREAD_ATTRIBUTE(x)
#endif

/// Marks a member that may be read and written only while `mutex` is held.
#define STRATA_GUARDED_BY(mutex) STRATA_THREAD_ATTRIBUTE(guarded_by(mutex))
/// Marks a pointer member whose target may be used only while `mutex` is held.
#define STRATA_PT_GUARDED_BY(mutex) STRATA_THREAD_ATTRIBUTE(pt_guarded_by(mutex))
/// Marks a function or lambda whose caller holds the mutexes named.
#define STRATA_REQUIRES(...) STRATA_THREAD_ATTRIBUTE(requires_capability(__VA_ARGS__))
/// Marks a function that takes the mutexes named itself, so its caller must not hold them.
#define STRATA_EXCLUDES(...) STRATA_THREAD_ATTRIBUTE(locks_excluded(__VA_ARGS__))
/// Mark functions that take a lock, release it, or take it when they return the value given.
#define STRATA_ACQUIRE(...) STRATA_THREAD_ATTRIBUTE(acquire_capability(__VA_ARGS__))
#define STRATA_RELEASE(...) STRATA_THREAD_ATTRIBUTE(release_capability(__VA_ARGS__))
#define STRATA_TRY_ACQUIRE(...) STRATA_THREAD_ATTRIBUTE(try_acquire_capability(__VA_ARGS__))

namespace strata {

/// A std::mutex that the compiler's analysis knows.
class STRATA_THREAD_ATTRIBUTE(capability("mutex")) Mutex {
 public:
  void lock() STRATA_ACQUIRE() { mutex_.lock(); }
  void unlock() STRATA_RELEASE() { mutex_.unlock(); }
  bool try_lock() STRATA_TRY_ACQUIRE(true) { return mutex_.try_lock(); }

 private:
  std::mutex mutex_;
};

/// Holds a mutex to the end of its block. It can be released for a while with unlock() and lock().
class STRATA_THREAD_ATTRIBUTE(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) STRATA_ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
  ~MutexLock() STRATA_RELEASE() {
    if (held_) mutex_.unlock();
  }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

  void unlock() STRATA_RELEASE() {
    mutex_.unlock();
    held_ = false;
  }
  void lock() STRATA_ACQUIRE() {
    mutex_.lock();
    held_ = true;
  }

 private:
  Mutex& mutex_;
  bool held_ = true;
};

/// Waits on a Mutex that the caller holds: `changed_.wait(mutex_, stop, [this]() STRATA_REQUIRES(mutex_) { ... })`.
using Condition = std::condition_variable_any;

}  // namespace strata
