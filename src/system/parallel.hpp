#pragma once
/// The loops that run in parallel (the one OpenMP room).

#include <cstdint>
#include <functional>

namespace eses {

/// Threads that this process may use: OMP_NUM_THREADS, affinity and the control group's quota
/// respected.
int available_threads();

/// Starts the threads. OpenMP ends the process if it cannot: better before there are files.
void start_threads(int threads);

/// Calls `body(index, thread)` once for every index in [0, count), in about ascending order, from
/// `threads` threads. An exception ends the loop as soon as all threads notice, and is thrown on.
void parallel_for(std::int64_t count, int threads,
                  const std::function<void(std::int64_t index, int thread)>& body);

}  // namespace eses
