#pragma once
/// Parallel loops. Only this folder uses OpenMP.

#include <cstdint>
#include <functional>
#include <string>

namespace eses::detail {

/// Returns the number of threads that this process may use: OMP_NUM_THREADS or else the number of
/// processors to which it is bound, limited by the quota of the control group. See processor_quota
/// for `root`.
int available_threads(const std::string& root = "/");

/// Starts the threads of OpenMP. OpenMP ends the process if it cannot start them, so this must be
/// called before any file is written.
void start_threads(int threads);

/// Calls `body(index, thread)` once for every index in [0, count), in roughly ascending order, from
/// `threads` threads; `thread` is 0-based. The first exception of `body` stops the loop and is
/// rethrown when all threads have stopped.
void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body);

}  // namespace eses::detail
