#pragma once
#include <condition_variable>
#include <mutex>

/// Locks whose discipline the compiler checks: `clang++ -Wthread-safety` refuses every use of a STRATA_GUARDED_BY member
/// without its lock (Hutchins, Ballman, Sutherland 2014, "C/C++ Thread Safety Analysis"). Other compilers see nothing
/// of it.
#if defined(__clang__)
#define STRATA_THREAD_ATTRIBUTE(x) __attribute__((x))
#else
#define STRATA_THREAD_ATTRIBUTE(x)
#endif

/// On a member: it may be read and written only while `mutex` is held.
#define STRATA_GUARDED_BY(mutex) STRATA_THREAD_ATTRIBUTE(guarded_by(mutex))
/// On a pointer member: what it points to may be used only while `mutex` is held.
#define STRATA_PT_GUARDED_BY(mutex) STRATA_THREAD_ATTRIBUTE(pt_guarded_by(mutex))
/// On a function or lambda: its caller holds the mutexes named.
#define STRATA_REQUIRES(...) STRATA_THREAD_ATTRIBUTE(requires_capability(__VA_ARGS__))
/// On a function: its caller does not hold the mutexes named; the function takes them itself.
#define STRATA_EXCLUDES(...) STRATA_THREAD_ATTRIBUTE(locks_excluded(__VA_ARGS__))
#define STRATA_ACQUIRE(...) STRATA_THREAD_ATTRIBUTE(acquire_capability(__VA_ARGS__))
#define STRATA_RELEASE(...) STRATA_THREAD_ATTRIBUTE(release_capability(__VA_ARGS__))
#define STRATA_TRY_ACQUIRE(...) STRATA_THREAD_ATTRIBUTE(try_acquire_capability(__VA_ARGS__))

namespace strata {

/// A std::mutex that the analysis knows.
class STRATA_THREAD_ATTRIBUTE(capability("mutex")) Mutex {
 public:
  void lock() STRATA_ACQUIRE() { mutex_.lock(); }
  void unlock() STRATA_RELEASE() { mutex_.unlock(); }
  bool try_lock() STRATA_TRY_ACQUIRE(true) { return mutex_.try_lock(); }

 private:
  std::mutex mutex_;
};

/// Holds a mutex to the end of its block. unlock() and lock() let go of it for a while in between.
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
