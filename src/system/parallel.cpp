#include "system/parallel.hpp"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <stdexcept>

#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail {

int available_threads(int quota) { return std::clamp(omp_get_max_threads(), 1, quota); }

int available_threads() {
  static const int quota = processor_quota();
  return available_threads(quota);
}

void require_threads(int chosen) {
  if (chosen < 0)
    throw std::invalid_argument(
        formatted("the number of threads must not be negative, and is {}", chosen));
  if (chosen > max_threads)
    throw std::invalid_argument(
        formatted("the number of threads must be at most {}, and is {}", max_threads, chosen));
}

int chosen_threads(int chosen) {
  require_threads(chosen);
  return chosen > 0 ? chosen : available_threads();
}

void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body,
                  Monitor* monitor) {
  // A region of one thread costs time. Threads that wait for the next region spin for a while, so a
  // thread without an index is worse than none. Regions within regions would have too many threads.
  const auto useful = static_cast<int>(std::clamp<std::int64_t>(count, 1, std::max(1, threads)));
  if (useful == 1 || omp_in_parallel() != 0) {
    for (std::int64_t index = 0; index < count; ++index) body(index, 0);
    return;
  }
  std::exception_ptr failure;
  std::mutex failure_mutex;
  std::atomic<bool> has_failed = false;
  std::atomic<std::int64_t> next = 0;
#pragma omp parallel num_threads(useful)
  while (!has_failed.load(std::memory_order_relaxed)) {
    const std::int64_t index = next++;
    if (index >= count) break;
    try {
      body(index, omp_get_thread_num());
    } catch (const Monitor::Stopped&) {  // another thread has failed
    } catch (...) {
      {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        has_failed = true;
      }
      if (monitor != nullptr) monitor->stop();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

void start_threads(int threads) {
  parallel_for(threads, threads, [](std::int64_t, int) {});
}

}  // namespace eses::detail
