#include "system/parallel.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "system/formatted.hpp"
#include "system/read_number.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

#ifdef _OPENMP

int unlimited_threads() { return omp_get_max_threads(); }

bool is_in_region() { return omp_in_parallel() != 0; }

template <class Work>
void run_region(int threads, const Work& work) {
#pragma omp parallel num_threads(threads)
  work(omp_get_thread_num());
}

#else

thread_local bool runs_region = false;

int unlimited_threads() {
  int threads = 0;
  if (const char* const wish = std::getenv("OMP_NUM_THREADS")) read_number(wish, threads);
  return threads > 0 ? threads : static_cast<int>(allowed_processors().count());
}

bool is_in_region() { return runs_region; }

template <class Work>
void run_region(int threads, const Work& work) {
  const auto run = [&work](int thread) {
    runs_region = true;
    work(thread);
    runs_region = false;
  };
  std::vector<std::thread> others;
  try {
    for (int thread = 1; thread < threads; ++thread) others.emplace_back(run, thread);
  } catch (const std::exception&) {
    // The threads that could be started do all of the work.
  }
  run(0);
  for (std::thread& other : others) other.join();
}

#endif

}  // namespace

int available_threads(int quota) { return std::clamp(unlimited_threads(), 1, quota); }

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
  if (useful == 1 || is_in_region()) {
    for (std::int64_t index = 0; index < count; ++index) body(index, 0);
    return;
  }
  std::exception_ptr failure;
  std::mutex failure_mutex;
  std::atomic<bool> has_failed = false;
  std::atomic<std::int64_t> next = 0;
  run_region(useful, [&](int thread) {
    while (!has_failed.load(std::memory_order_relaxed)) {
      const std::int64_t index = next++;
      if (index >= count) break;
      try {
        body(index, thread);
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
  });
  if (failure) std::rethrow_exception(failure);
}

void start_threads(int threads) {
  parallel_for(threads, threads, [](std::int64_t, int) {});
}

}  // namespace eses::detail
