#pragma once
/// Parallel loops. Only this folder uses OpenMP, or threads in its place.

#include <cstdint>
#include <functional>

#include "system/monitor.hpp"

namespace eses::detail {

/// Returns the number of threads that this process may use: OMP_NUM_THREADS or else the number of
/// processors to which it is bound, limited by a quota of processors.
int available_threads(int quota);
/// Does the same for the quota of the control group, which is read at the first call.
int available_threads();

/// Maximum number of threads that a user may choose. OpenMP ends the process if it cannot start all
/// threads.
inline constexpr int max_threads = 4096;

/// Throws std::invalid_argument if a chosen number of threads is not between 0 and `max_threads`.
void require_threads(int chosen);

/// Returns the number of threads that a user has chosen, or that of available ones for 0. Throws
/// std::invalid_argument as `require_threads`.
int chosen_threads(int chosen);

/// Starts the threads of OpenMP, if the build has it. OpenMP ends the process if it cannot start
/// them, so this must be called before any file is written.
void start_threads(int threads);

/// Calls `body(index, thread)` once for every index in [0, count) from `threads` threads; `thread`
/// is 0-based. Threads take the indices in ascending order, so a body may wait for the work of
/// smaller indices. The first exception of `body` stops the loop and is rethrown when all threads
/// have stopped. It also stops `monitor`, if there is one, so that all waits end.
void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body,
                  Monitor* monitor = nullptr);

}  // namespace eses::detail
