#include "system/parallel.hpp"

#include <omp.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

#include "system/resources.hpp"

namespace eses::detail {
namespace {

using LoopBody = std::function<void(std::int64_t index, int thread)>;

// Whether this thread is in the body of a loop.
thread_local bool is_in_loop = false;

// A loop whose indices several threads take, one after the other.
class SharedLoop {
 public:
  SharedLoop(std::int64_t count, const LoopBody& body) : count_(count), body_(body) {}

  // Takes indices until none is left. Never throws.
  void work(int thread) {
    is_in_loop = true;
    try {
      for (std::int64_t index = next_++; index < count_ && !has_failed_; index = next_++)
        body_(index, thread);
    } catch (...) {
      if (!has_failed_.exchange(true)) failure_ = std::current_exception();
    }
    is_in_loop = false;
  }

  // Throws the first exception of the body on. No thread works on the loop any more.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  friend class Helpers;

  std::int64_t count_;
  const LoopBody& body_;
  std::atomic<std::int64_t> next_ = 0;
  std::atomic<bool> has_failed_ = false;
  std::exception_ptr failure_;
  // The mutex of Helpers guards these.
  int joined_ = 0, working_ = 0;  // helpers that have ever worked on it, and that work on it now
  std::condition_variable is_left_;
};

// Threads that help with loops. They sleep while there is none: a thread that spins, as those of
// OpenMP do, takes processor time for nothing. They are never ended, as other threads may be in a
// loop when the process ends.
class Helpers {
 public:
  // Works on a loop with up to `wanted` helpers. All loops share the helpers, so loops that other
  // threads run at the same time do not add helpers. The loop does not wait for helpers that join
  // too late.
  void run(SharedLoop& loop, int wanted) {
    {
      const std::lock_guard lock(mutex_);
      start(wanted);
      wanted = std::min(wanted, count_);
      if (wanted > 0) waiting_.push_back({&loop, wanted});
    }
    for (int k = 0; k < wanted; ++k) has_work_.notify_one();
    loop.work(0);
    std::unique_lock lock(mutex_);
    std::erase_if(waiting_, [&](const Request& request) { return request.loop == &loop; });
    loop.is_left_.wait(lock, [&] { return loop.working_ == 0; });
  }

 private:
  struct Request {
    SharedLoop* loop;
    int wanted;  // number of helpers that may still join
  };

  // Fewer threads do the same work, so a limit of the system is no error.
  void start(int wanted) {
    try {
      for (; count_ < wanted; ++count_) std::thread([this] { serve(); }).detach();
    } catch (const std::system_error&) {
    }
  }

  void serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
      has_work_.wait(lock, [&] { return !waiting_.empty(); });
      Request& request = waiting_.front();
      SharedLoop& loop = *request.loop;
      if (--request.wanted == 0) waiting_.pop_front();
      const int thread = ++loop.joined_;
      ++loop.working_;
      lock.unlock();
      loop.work(thread);
      lock.lock();
      if (--loop.working_ == 0) loop.is_left_.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable has_work_;
  std::deque<Request> waiting_;  // loops that helpers may join
  int count_ = 0;                // helpers that have been started
};

// Returns the helpers of this process. Those of its parent do not survive a fork.
Helpers& helpers() {
  static std::atomic<Helpers*> current = nullptr;
  static const int registered = pthread_atfork(nullptr, nullptr, [] { current = nullptr; });
  (void)registered;
  Helpers* found = current;
  if (found != nullptr) return *found;
  auto* const made = new Helpers;  // NOLINT(cppcoreguidelines-owning-memory): never destroyed
  if (current.compare_exchange_strong(found, made)) return *made;
  delete made;  // NOLINT(cppcoreguidelines-owning-memory)
  return *found;
}

}  // namespace

int available_threads(int quota) { return std::clamp(omp_get_max_threads(), 1, quota); }

int available_threads() {
  static const int quota = processor_quota();
  return available_threads(quota);
}

void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body) {
  const auto useful = static_cast<int>(std::min<std::int64_t>(threads, count));
  if (useful <= 1 || is_in_loop || omp_in_parallel() != 0) {
    for (std::int64_t index = 0; index < count; ++index) body(index, 0);
    return;
  }
  SharedLoop loop(count, body);
  helpers().run(loop, useful - 1);
  loop.rethrow();
}

}  // namespace eses::detail
