#pragma once
/// Parallel loops. Only this folder uses OpenMP.

#include <cstdint>
#include <functional>

namespace eses::detail {

/// Returns the number of threads that this process may use: OMP_NUM_THREADS or else the number of
/// processors to which it is bound, limited by a quota of processors.
int available_threads(int quota);
/// Does the same for the quota of the control group, which is read at the first call.
int available_threads();

/// Starts the threads of OpenMP. OpenMP ends the process if it cannot start them, so this must be
/// called before any file is written.
void start_threads(int threads);

/// Calls `body(index, thread)` once for every index in [0, count), in roughly ascending order, from
/// `threads` threads; `thread` is 0-based. The first exception of `body` stops the loop and is
/// rethrown when all threads have stopped.
void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body);

}  // namespace eses::detail
